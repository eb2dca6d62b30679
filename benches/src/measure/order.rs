//! Errors of the results that users care about: mean Ψ_o and C_v of 20 boats without leaders in pool `wide` at
//! bw = 0.3 s, white noise, over the 10 Hz frames in the analysis window after the first tenth.
//!
//! All engines have the same seeds and are compared with leapfrog at 0.005 s, seed by seed. Runs still differ by
//! chance, since the path of the noise differs between steps and motion is chaotic. The intervals show this scatter.

use super::{Effort, on_all_cores, push_row, table};
use crate::configuration::STEP_S;
use crate::table::{Table, number, text};
use crate::{Configuration, Start};
use flockenv::clock::ticks;
use flockenv::geometry::{Pose, Velocity};
use flockenv::integrator::PhaseSchedule;
use flockenv::parameters::{Preset, Scheme};
use flockenv::{FlockParameters, OrderParameters};

/// Number of runs for each seed whose mean is the reference.
const REPLICAS: u64 = 4;
/// First seed of the runs that show the scatter by chance.
const OTHER_SEEDS: u64 = 9001;
/// Time between frames in s.
pub const FRAME_S: f64 = 0.1;

/// Simulated time of a run in s.
pub fn run_s(effort: Effort) -> f64 {
    effort.choose(120.0, 1200.0)
}

/// Seeds of the engines in this binary.
fn seeds(effort: Effort) -> u64 {
    effort.choose(2, 40)
}

/// The scene.
pub fn scene() -> FlockParameters {
    FlockParameters::preset(Preset::Simulation)
}

/// Sums over the frames of a run.
pub struct Frames {
    schedule: PhaseSchedule,
    first_s: f64,
    count: f64,
    psi_o: f64,
    c_v: f64,
}

impl Frames {
    /// For a run of this length.
    pub fn new(run_s: f64) -> Self {
        Self {
            schedule: PhaseSchedule::new(&scene()),
            first_s: 0.1 * run_s,
            count: 0.0,
            psi_o: 0.0,
            c_v: 0.0,
        }
    }

    /// Adds a frame, if it is in the analysis window.
    pub fn add(&mut self, time_s: f64, poses: &[Pose], velocities: &[Velocity]) {
        if time_s < self.first_s || !self.schedule.in_analysis_window(ticks(time_s)) {
            return;
        }
        let order = OrderParameters::from_poses(poses, velocities).expect("there are boats");
        self.count += 1.0;
        self.psi_o += order.psi_o;
        self.c_v += order.c_v;
    }

    /// Mean Ψ_o and mean C_v in cm²/s².
    pub fn means(&self) -> [f64; 2] {
        [self.psi_o / self.count, self.c_v / self.count]
    }
}

fn run(configuration: &Configuration, seed: u64, run_s: f64) -> [f64; 2] {
    let scene = scene();
    let start = Start::placed(&scene, seed);
    let mut engine = configuration.build(&scene, seed, &start);
    let mut frames = Frames::new(run_s);
    for frame in 1..=(run_s / FRAME_S).round() as u64 {
        engine.advance(configuration.steps(FRAME_S));
        frames.add(
            frame as f64 * FRAME_S,
            &engine.poses(),
            &engine.velocities(),
        );
    }
    frames.means()
}

/// Means for every configuration and seed.
fn run_all(all: &[(Configuration, u64)], seeds: u64, run_s: f64) -> Vec<Vec<[f64; 2]>> {
    let runs: Vec<(Configuration, u64)> = all
        .iter()
        .flat_map(|&(configuration, first)| (0..seeds).map(move |k| (configuration, first + k)))
        .collect();
    let means = on_all_cores(&runs, |(configuration, seed)| {
        run(configuration, *seed, run_s)
    });
    means.chunks(seeds as usize).map(<[_]>::to_vec).collect()
}

/// The reference's means for the seeds from 1 on: each the mean of [`REPLICAS`] runs with noise and
/// placements of their own, so that its own scatter hardly widens the intervals of the others.
pub fn reference(effort: Effort, seeds: u64) -> Vec<[f64; 2]> {
    let finest = Configuration::exact(Scheme::Leapfrog, f64::INFINITY, 0.005);
    let replicas: Vec<_> = (0..REPLICAS).map(|k| (finest, 1 + 1000 * k)).collect();
    let means = run_all(&replicas, seeds, run_s(effort));
    let mean = |seed: usize, which: usize| -> f64 {
        let sum: f64 = means.iter().map(|replica| replica[seed][which]).sum();
        sum / REPLICAS as f64
    };
    (0..seeds as usize)
        .map(|seed| [mean(seed, 0), mean(seed, 1)])
        .collect()
}

/// Names of the columns.
pub const COLUMNS: [&str; 9] = [
    "seeds",
    "first_seed",
    "run_s",
    "psi_o",
    "psi_o_error",
    "psi_o_half_width",
    "c_v_cm2_s2",
    "c_v_error_cm2_s2",
    "c_v_half_width_cm2_s2",
];

/// The cells of one engine: means, mean paired differences from the reference, and half-widths of
/// their 95 % intervals.
pub fn row(first: u64, run_s: f64, means: &[[f64; 2]], reference: &[[f64; 2]]) -> Vec<String> {
    let mut cells = vec![text(means.len()), text(first), number(run_s)];
    for which in 0..2 {
        let values = means.iter().map(|mean| mean[which]);
        let differences = means
            .iter()
            .zip(reference)
            .map(|(a, b)| a[which] - b[which]);
        let (error, half_width) = interval(&differences.collect::<Vec<_>>());
        cells.push(number(values.sum::<f64>() / means.len() as f64));
        cells.extend([number(error), number(half_width)]);
    }
    cells
}

/// Mean and half-width of its 95 % interval, by Student's t.
fn interval(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // Two terms of the expansion of Student's quantile: within 1 % from 10 degrees of freedom on.
    let quantile = 1.960 + 2.372 / (n - 1.0) + 2.8 / (n - 1.0).powi(2);
    (mean, quantile * (variance / n).sqrt())
}

/// Measures the configurations that may change the results. The first row is the reference, the second the same
/// with other seeds, which shows how far apart equally exact runs are by chance.
pub fn measure(effort: Effort) -> Table {
    let (seeds, run_s) = (seeds(effort), run_s(effort));
    let exact = |scheme, tolerance_cm, steps: &[f64]| -> Vec<(Configuration, u64)> {
        let configuration = |&dt_s: &f64| Configuration::exact(scheme, tolerance_cm, dt_s);
        steps.iter().map(|dt_s| (configuration(dt_s), 1)).collect()
    };
    let finest = Configuration::exact(Scheme::Leapfrog, f64::INFINITY, 0.005);
    let mut all = vec![(finest, OTHER_SEEDS)];
    all.extend(exact(
        Scheme::Leapfrog,
        f64::INFINITY,
        &[0.01, 0.02, 0.05, 0.1],
    ));
    all.extend(exact(Scheme::Leapfrog, 1e-4, &[0.02, 0.05, 0.1]));
    all.extend(exact(
        Scheme::Moreau,
        f64::INFINITY,
        &[0.01, 0.02, 0.05, 0.1],
    ));
    all.extend(exact(Scheme::Paper, f64::INFINITY, &[0.01, 0.02, 0.05]));
    all.extend([Configuration::rapier(STEP_S), Configuration::box2d(STEP_S)].map(|c| (c, 1)));
    let reference = reference(effort, seeds);
    let means = run_all(&all, seeds, run_s);
    let mut table = table(&COLUMNS);
    let cells = row(1, run_s, &reference, &reference);
    push_row(&mut table, &finest.cells(), cells);
    for ((configuration, first), run_means) in all.iter().zip(&means) {
        let cells = row(*first, run_s, run_means, &reference);
        push_row(&mut table, &configuration.cells(), cells);
    }
    table
}
