//! Depths of overlaps at the end of steps, by flockenv's gaps on the poses of every engine, and statistics of flockenv's
//! solver.

use super::{Effort, on_all_cores, push_row, speed, table};
use crate::table::{Table, number, text};
use crate::{Configuration, Scene, Start};
use flockenv::FlockParameters;
use flockenv::contact::{Contact, ContactDetector, Statistics};
use flockenv::geometry::{HullPose, Pose};

/// Follows the deepest overlap of a run.
pub struct Overlap {
    detector: ContactDetector,
    boats: Vec<HullPose>,
    contacts: Vec<Contact>,
    steps: f64,
    sum: f64,
    most: f64,
}

impl Overlap {
    /// For a scene.
    pub fn new(parameters: &FlockParameters) -> Self {
        Self {
            detector: ContactDetector::new(parameters),
            boats: Vec::new(),
            contacts: Vec::new(),
            steps: 0.0,
            sum: 0.0,
            most: 0.0,
        }
    }

    /// Measures the poses at a step's end.
    pub fn add(&mut self, poses: &[Pose]) {
        self.boats.clear();
        self.boats.extend(poses.iter().map(HullPose::new));
        self.detector.detect(&self.boats, 0.0, &mut self.contacts);
        let deepest = self.contacts.iter().map(|c| -c.gap.gap).fold(0.0, f64::max);
        self.steps += 1.0;
        self.sum += deepest;
        self.most = self.most.max(deepest);
    }

    /// Makes all results NaN.
    fn invalidate(&mut self) {
        (self.sum, self.most) = (f64::NAN, f64::NAN);
    }

    /// The mean over steps of the deepest overlap of a step, and the deepest overlap of all, in cm.
    pub fn mean_and_most(&self) -> [f64; 2] {
        [self.sum / self.steps, self.most]
    }
}

/// Names of the columns.
pub const COLUMNS: [&str; 10] = [
    "scene",
    "n",
    "seed",
    "overlap_mean_cm",
    "overlap_max_cm",
    "residual_cm_s",
    "unsolved",
    "solves",
    "contacts_per_step",
    "iterations_per_solve",
];

struct Run {
    configuration: Configuration,
    scene: Scene,
    boats: usize,
    seed: u64,
    timed_s: f64,
}

/// Number of runs of every setting with 27 boats: deep overlaps are so rare that one run says little about them.
const SEEDS: u64 = 20;

/// Measures every configuration in every scene.
pub fn measure(effort: Effort) -> Table {
    let mut runs = Vec::new();
    let mut add = |configurations: &[Configuration], scene, boats, seeds, timed_s| {
        for seed in 1..=seeds {
            runs.extend(configurations.iter().map(|&configuration| Run {
                configuration,
                scene,
                boats,
                seed,
                timed_s,
            }));
        }
    };
    let timed_s = effort.choose(12.0, speed::TIMED_S);
    // The longest first, so that no core waits for them at the end.
    add(
        &speed::larger_flocks(),
        Scene::Jam,
        1000,
        1,
        effort.choose(6.0, 24.0),
    );
    for scene in Scene::ALL {
        add(
            &Configuration::all_inexact(),
            scene,
            27,
            1,
            effort.choose(6.0, 24.0),
        );
    }
    for boats in [200, 50] {
        add(&speed::larger_flocks(), Scene::Jam, boats, 1, timed_s);
    }
    for scene in Scene::ALL {
        let all = [Configuration::all_exact(), Configuration::all_peers()].concat();
        add(&all, scene, 27, effort.choose(2, SEEDS), timed_s);
    }
    let rows = on_all_cores(&runs, measured);
    let mut table = table(&COLUMNS);
    for (run, row) in runs.iter().zip(rows) {
        push_row(&mut table, &run.configuration.cells(), row);
    }
    table
}

fn measured(run: &Run) -> Vec<String> {
    let scene = run.scene.parameters(run.boats);
    let start = Start::placed(&scene, run.seed);
    let mut engine = run.configuration.build(&scene, run.seed, &start);
    engine.advance(run.configuration.steps(speed::WARM_UP_S));
    let before = engine.statistics();
    let mut overlap = Overlap::new(&scene);
    for _ in 0..run.configuration.steps(run.timed_s) {
        engine.advance(1);
        overlap.add(&engine.poses());
    }
    if engine.is_lost() {
        overlap.invalidate();
        return row(run.scene, run.boats, run.seed, &overlap, None);
    }
    let work = engine.statistics().zip(before);
    row(run.scene, run.boats, run.seed, &overlap, work)
}

/// The cells of one engine; `work`: its statistics after and before.
pub fn row(
    scene: Scene,
    boats: usize,
    seed: u64,
    overlap: &Overlap,
    work: Option<(Statistics, Statistics)>,
) -> Vec<String> {
    let [mean, most] = overlap.mean_and_most();
    let mut cells = vec![
        text(scene.name()),
        text(boats),
        text(seed),
        number(mean),
        number(most),
    ];
    cells.extend(work.map_or_else(
        || vec![String::new(); 5],
        |(after, before)| {
            let solves = (after.solves - before.solves) as f64;
            let substeps = (after.substeps - before.substeps) as f64;
            vec![
                number(after.worst_residual_cm_s),
                text(after.unsolved),
                text(after.solves),
                number((after.contacts - before.contacts) as f64 / substeps),
                number((after.solver_iterations - before.solver_iterations) as f64 / solves),
            ]
        },
    ));
    cells
}
