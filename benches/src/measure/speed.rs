//! How long a step takes.
//!
//! All engines are warmed up, then take turns, a cycle of phases each: whatever else the machine does
//! meets them alike. Ratios are taken turn by turn.

use super::{Effort, push_row, table};
use crate::configuration::{STEP_S, TOLERANCES_CM};
use crate::table::{Table, number, quartiles, text};
use crate::{Configuration, Engine, Scene, Start};
use flockenv::FlockParameters;
use flockenv::parameters::Scheme;
use std::time::{Duration, Instant};

/// Simulated time before anything is timed, in s.
pub const WARM_UP_S: f64 = 20.0;
/// Simulated time that is timed, in s.
pub const TIMED_S: f64 = 60.0;

/// Something to be timed.
pub struct Entry {
    /// Engine and settings.
    pub configuration: Configuration,
    /// The scene.
    pub parameters: FlockParameters,
}

/// Times in µs per step, turn by turn.
#[derive(Debug, Clone, Default)]
pub struct Times {
    /// Of everything that moves the scene on by a step: noise, forces, contacts, motion.
    pub whole: Vec<f64>,
    /// Of the engine's own step call; empty where the engine does everything itself.
    pub call: Vec<f64>,
    /// Seeds on which the motion left the range of sensible numbers.
    pub lost: usize,
}

impl Times {
    fn push(&mut self, steps: usize, whole: Duration, call: Option<Duration>) {
        let per_step = |time: Duration| time.as_secs_f64() * 1e6 / steps as f64;
        self.whole.push(per_step(whole));
        self.call.extend(call.map(per_step));
    }

    /// Of the engine's own step call, or of all where there is none.
    pub fn call_or_whole(&self) -> &[f64] {
        if self.call.is_empty() {
            &self.whole
        } else {
            &self.call
        }
    }
}

/// Lets all entries take turns, for every seed.
pub fn take_turns(entries: &[Entry], seeds: u64, timed_s: f64) -> Vec<Times> {
    let mut times = vec![Times::default(); entries.len()];
    for seed in 1..=seeds {
        let mut engines: Vec<Box<dyn Engine>> =
            entries.iter().map(|e| warmed_up(e, seed)).collect();
        for _ in 0..(timed_s / Scene::BLOCK_S) as usize {
            for ((entry, engine), times) in entries.iter().zip(&mut engines).zip(&mut times) {
                let steps = entry.configuration.steps(Scene::BLOCK_S);
                let before = engine.step_call();
                let start = Instant::now();
                engine.advance(steps);
                let whole = start.elapsed();
                let call = engine.step_call().zip(before).map(|(now, then)| now - then);
                times.push(steps, whole, call);
            }
        }
        for (engine, times) in engines.iter().zip(&mut times) {
            times.lost += usize::from(engine.is_lost());
        }
    }
    times
}

fn warmed_up(entry: &Entry, seed: u64) -> Box<dyn Engine> {
    let start = Start::placed(&entry.parameters, seed);
    let mut engine = entry.configuration.build(&entry.parameters, seed, &start);
    engine.advance(entry.configuration.steps(WARM_UP_S));
    engine
}

/// µs per step of rapier2d-f64 in a scene of 27 boats: what other processes compare themselves with.
pub fn yardstick(scene: Scene) -> [f64; 2] {
    let entry = Entry {
        configuration: Configuration::rapier(STEP_S),
        parameters: scene.parameters(27),
    };
    let times = &take_turns(&[entry], 1, 12.0)[0];
    [&times.whole, &times.call].map(|times| quartiles(times)[1])
}

const COLUMNS: [&str; 12] = [
    "scene",
    "n",
    "us_per_step",
    "us_q1",
    "us_q3",
    "call_us",
    "faster",
    "faster_q1",
    "faster_q3",
    "call_faster",
    "times_real_time",
    "lost",
];

/// Writes nothing but the names of the columns.
pub fn empty_table() -> Table {
    table(&COLUMNS)
}

/// Times every configuration in every scene.
pub fn measure(effort: Effort) -> Table {
    let mut table = empty_table();
    let (seeds, timed_s) = (effort.choose(1, 3), effort.choose(12.0, TIMED_S));
    let exact = [Configuration::all_exact(), Configuration::all_peers()].concat();
    let inexact = [
        vec![Configuration::rapier(STEP_S)],
        Configuration::all_inexact(),
    ]
    .concat();
    for scene in Scene::ALL {
        add_rows(&mut table, scene, 27, &exact, seeds, timed_s);
        // Their steps take so much longer that one seed is as long as three of the others.
        add_rows(&mut table, scene, 27, &inexact, 1, effort.choose(6.0, 24.0));
    }
    for boats in [50, 200, 1000] {
        let timed_s = if boats < 1000 {
            timed_s
        } else {
            effort.choose(6.0, 24.0)
        };
        add_rows(&mut table, Scene::Jam, boats, &larger_flocks(), 1, timed_s);
    }
    table
}

/// What is timed in flocks of more than 27 boats.
pub fn larger_flocks() -> Vec<Configuration> {
    let peers = Configuration::all_peers();
    let single = peers
        .iter()
        .filter(|c| c.dt_s == STEP_S && c.cells()[0] == "rapier2d (f32)");
    let ours = TOLERANCES_CM.map(|cm| Configuration::exact(Scheme::Leapfrog, cm, STEP_S));
    let mut all = ours.to_vec();
    all.push(Configuration::exact(Scheme::Moreau, f64::INFINITY, STEP_S));
    // The default.
    all.push(Configuration::exact(Scheme::Leapfrog, 1e-4, 0.02));
    all.extend([
        Configuration::rapier(STEP_S),
        Configuration::box2d(STEP_S),
        Configuration::box2d_with_two_workers(STEP_S),
    ]);
    all.extend(single);
    all
}

fn add_rows(
    table: &mut Table,
    scene: Scene,
    boats: usize,
    configurations: &[Configuration],
    seeds: u64,
    timed_s: f64,
) {
    let parameters = scene.parameters(boats);
    let entry = |&configuration: &Configuration| Entry {
        configuration,
        parameters: parameters.clone(),
    };
    let entries: Vec<Entry> = configurations.iter().map(entry).collect();
    let times = take_turns(&entries, seeds, timed_s);
    let reference = configurations
        .iter()
        .position(|&c| c == Configuration::rapier(STEP_S));
    let reference = &times[reference.expect("rapier is among them")];
    let is_repeated = !configurations.contains(&Configuration::box2d(STEP_S));
    for (configuration, times) in configurations.iter().zip(&times) {
        if !(is_repeated && *configuration == Configuration::rapier(STEP_S)) {
            let cells = row(scene, boats, configuration.dt_s, times, reference);
            push_row(table, &configuration.cells(), cells);
        }
    }
}

/// The cells of one engine; `reference` are the times of rapier2d-f64 at [`STEP_S`], turn by turn.
pub fn row(scene: Scene, boats: usize, dt_s: f64, times: &Times, reference: &Times) -> Vec<String> {
    let ratio = |theirs: &[f64], ours: &[f64]| -> Vec<f64> {
        let per_second = dt_s / STEP_S;
        theirs
            .iter()
            .zip(ours)
            .map(|(theirs, ours)| theirs / ours * per_second)
            .collect()
    };
    if times.lost > 0 {
        let mut cells = vec![String::new(); COLUMNS.len()];
        cells[0] = text(scene.name());
        cells[1] = text(boats);
        cells[COLUMNS.len() - 1] = text(times.lost);
        return cells;
    }
    let [us_q1, us, us_q3] = quartiles(&times.whole);
    let [faster_q1, faster, faster_q3] = quartiles(&ratio(&reference.whole, &times.whole));
    let call_faster = quartiles(&ratio(&reference.call, times.call_or_whole()))[1];
    let call = (!times.call.is_empty()).then(|| quartiles(&times.call)[1]);
    vec![
        text(scene.name()),
        text(boats),
        number(us),
        number(us_q1),
        number(us_q3),
        number(call),
        number(faster),
        number(faster_q1),
        number(faster_q3),
        number(call_faster),
        number(dt_s * 1e6 / us),
        text(0),
    ]
}
