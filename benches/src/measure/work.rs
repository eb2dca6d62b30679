//! What an error costs: the time that engines take for the very runs of [`slide`] and [`horizon`]
//! whose errors are measured, with fixed steps and with steps that follow their error.
//!
//! Engines take turns, a run each, so that whatever else the machine does meets them alike.

use super::{Effort, distance, horizon, on_all_cores, push_row, slide, table};
use crate::configuration::{CONTROLLED_CM, LONGEST_S};
use crate::table::{Table, median, number, text};
use crate::{Configuration, Scene, Start};
use flockenv::FlockParameters;
use flockenv::geometry::Pose;
use flockenv::parameters::Scheme;
use std::time::{Duration, Instant};

const COLUMNS: [&str; 6] = [
    "scene",
    "simulated_s",
    "starts",
    "error_median_cm",
    "us_per_s",
    "call_us_per_s",
];
/// What a step and its two halves may differ by, in cm.
const ACCEPTED_CM: [f64; 7] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5];

/// Runs whose errors are known.
struct Runs {
    scene: &'static str,
    parameters: FlockParameters,
    seconds: f64,
    starts: Vec<Start>,
}

impl Runs {
    fn all(effort: Effort) -> Vec<Self> {
        let whole = |scene: Scene| Self {
            scene: scene.name(),
            parameters: horizon::parameters(scene),
            seconds: horizon::HORIZONS_S[0],
            starts: horizon::starts(scene, effort),
        };
        let slide = Self {
            scene: "slide",
            parameters: slide::scene(),
            seconds: slide::SLIDE_S,
            starts: slide::starts(),
        };
        let mut all = vec![slide];
        all.extend(Scene::ALL.map(whole));
        all
    }

    /// What a configuration makes of a start, as it comes to `right` by the shortest steps.
    fn run(&self, configuration: &Configuration, start: &Start, right: &[Pose]) -> Run {
        let mut engine = configuration.build(&self.parameters, 1, start);
        let began = Instant::now();
        engine.advance(configuration.steps(self.seconds));
        let took = began.elapsed();
        assert!(!engine.is_lost(), "{configuration:?} is lost");
        let us_per_s = |time: Duration| time.as_secs_f64() * 1e6 / self.seconds;
        Run {
            error_cm: distance(&self.parameters, &engine.poses(), right),
            us_per_s: us_per_s(took),
            call_us_per_s: engine.step_call().map(us_per_s),
        }
    }

    /// Where steps of 1e-4 s lead.
    fn right(&self) -> Vec<Vec<Pose>> {
        let reference = Configuration::exact(Scheme::Leapfrog, 1e-9, 1e-4);
        on_all_cores(&self.starts, |start| {
            let mut engine = reference.build(&self.parameters, 1, start);
            engine.advance(reference.steps(self.seconds));
            engine.poses()
        })
    }

    /// The cells of every configuration.
    fn rows(&self, all: &[Configuration], repeats: usize) -> Vec<Vec<String>> {
        // By configuration, and then by start.
        let mut found: Vec<Vec<Run>> = all.iter().map(|_| Vec::new()).collect();
        for (start, right) in self.starts.iter().zip(self.right()) {
            let mut tries: Vec<Vec<Run>> = all.iter().map(|_| Vec::new()).collect();
            for _ in 0..repeats {
                for (configuration, own) in all.iter().zip(&mut tries) {
                    // The first run finds the caches as another engine left them.
                    let warm = [(), ()].map(|()| self.run(configuration, start, &right));
                    own.push(warm[1]);
                }
            }
            for (runs, own) in found.iter_mut().zip(&tries) {
                runs.push(Run::middle(own));
            }
        }
        found.iter().map(|runs| self.row(runs)).collect()
    }

    fn row(&self, runs: &[Run]) -> Vec<String> {
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / runs.len() as f64;
        let call: Option<Vec<f64>> = runs.iter().map(|run| run.call_us_per_s).collect();
        vec![
            text(self.scene),
            number(self.seconds),
            text(runs.len()),
            number(median(
                &runs.iter().map(|run| run.error_cm).collect::<Vec<_>>(),
            )),
            number(mean(runs.iter().map(|run| run.us_per_s).collect())),
            number(call.map(mean)),
        ]
    }
}

/// What a configuration makes of a start.
#[derive(Debug, Clone, Copy)]
struct Run {
    error_cm: f64,
    /// Time for a second of the scene in µs.
    us_per_s: f64,
    /// The engine's own step calls alone; of a controlled step all but copies and checks.
    call_us_per_s: Option<f64>,
}

impl Run {
    /// The median times of the same run, again and again.
    fn middle(tries: &[Self]) -> Self {
        let middle = |times: Vec<f64>| median(&times);
        let call: Option<Vec<f64>> = tries.iter().map(|run| run.call_us_per_s).collect();
        Self {
            us_per_s: middle(tries.iter().map(|run| run.us_per_s).collect()),
            call_us_per_s: call.map(middle),
            ..tries[0]
        }
    }
}

/// What is compared: each engine from its longest step to its shortest.
fn configurations() -> Vec<Configuration> {
    let halved = |longest_s: f64, times: i32| (0..times).map(move |k| longest_s / 2f64.powi(k));
    let fixed = |dt_s| Configuration::exact(Scheme::Leapfrog, CONTROLLED_CM, dt_s);
    let mut all: Vec<_> = halved(LONGEST_S, 8).map(fixed).collect();
    all.extend(ACCEPTED_CM.map(Configuration::controlled));
    all.extend(halved(0.02, 5).map(Configuration::rapier));
    all.extend(halved(0.02, 5).map(Configuration::box2d));
    all
}

/// Measures every configuration.
pub fn measure(effort: Effort) -> Table {
    let all = configurations();
    let mut table = table(&COLUMNS);
    for runs in Runs::all(effort) {
        let rows = runs.rows(&all, effort.choose(1, 11));
        for (configuration, row) in all.iter().zip(rows) {
            push_row(&mut table, &configuration.cells(), row);
        }
    }
    table
}
