//! The cost of an error: the time of the runs of [`slide`] and [`horizon`] whose errors are measured, with fixed steps and
//! with steps that follow their error.
//!
//! Engines take turns, a run each, so that other work of the machine slows them alike.

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
/// Accepted differences between a step and its two halves, in cm.
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
        let flock_runs = |scene: Scene| Self {
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
        all.extend(Scene::ALL.map(flock_runs));
        all
    }

    /// Runs a configuration from a start, from which the shortest steps reach the poses `exact`.
    fn run(&self, configuration: &Configuration, start: &Start, exact: &[Pose]) -> Run {
        let mut engine = configuration.build(&self.parameters, 1, start);
        let start_time = Instant::now();
        engine.advance(configuration.steps(self.seconds));
        let elapsed = start_time.elapsed();
        assert!(!engine.is_lost(), "{configuration:?} is lost");
        let us_per_s = |time: Duration| time.as_secs_f64() * 1e6 / self.seconds;
        Run {
            error_cm: distance(&self.parameters, &engine.poses(), exact),
            us_per_s: us_per_s(elapsed),
            call_us_per_s: engine.step_call().map(us_per_s),
        }
    }

    /// Poses that steps of 1e-4 s reach.
    fn exact_ends(&self) -> Vec<Vec<Pose>> {
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
        let mut medians: Vec<Vec<Run>> = all.iter().map(|_| Vec::new()).collect();
        for (start, exact) in self.starts.iter().zip(self.exact_ends()) {
            let mut repeated: Vec<Vec<Run>> = all.iter().map(|_| Vec::new()).collect();
            for _ in 0..repeats {
                for (configuration, runs) in all.iter().zip(&mut repeated) {
                    // The first run only warms the caches, which another engine has used.
                    let [_, warm] = [(), ()].map(|()| self.run(configuration, start, &exact));
                    runs.push(warm);
                }
            }
            for (runs, repeats) in medians.iter_mut().zip(&repeated) {
                runs.push(Run::median(repeats));
            }
        }
        medians.iter().map(|runs| self.row(runs)).collect()
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

/// The error and the time of a run.
#[derive(Debug, Clone, Copy)]
struct Run {
    error_cm: f64,
    /// Time for a second of the scene in µs.
    us_per_s: f64,
    /// Time of the engine's own step calls, or of a controlled step without copies and checks.
    call_us_per_s: Option<f64>,
}

impl Run {
    /// The run with the median times of its repetitions.
    fn median(repeats: &[Self]) -> Self {
        let median_of = |times: Vec<f64>| median(&times);
        let call: Option<Vec<f64>> = repeats.iter().map(|run| run.call_us_per_s).collect();
        Self {
            us_per_s: median_of(repeats.iter().map(|run| run.us_per_s).collect()),
            call_us_per_s: call.map(median_of),
            ..repeats[0]
        }
    }
}

/// The compared configurations, for each engine from its longest step to its shortest.
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
