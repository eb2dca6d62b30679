//! Tasks of engines in other languages.

use crate::configuration::STEP_S;
use crate::measure::{Effort, horizon, momentum, order, slide, speed, wall_push};
use crate::{Scene, Start};
use flockenv::FlockParameters;
use flockenv::geometry::{Hull, Pose, Velocity};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// Number of seeds for order parameters: fewer than in this binary, since a step from Python takes longer.
pub(super) const ORDER_SEEDS: u64 = 12;

/// A simulation for an engine in another language.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Task {
    /// Name of the measurement, which is that of its table.
    pub(super) measure: String,
    pub(super) scene: String,
    /// Radii of the walls in cm; `None` without an outer wall, 0 without an inner one.
    pub(super) outer_cm: Option<f64>,
    pub(super) inner_cm: f64,
    /// Radius and half-length of the core in cm.
    pub(super) hull_cm: [f64; 2],
    pub(super) gyration_cm: f64,
    /// Durations of fw, nop, bw and nop in s.
    pub(super) phases_s: [f64; 4],
    /// Preferred speed forward and backward in cm/s.
    pub(super) speeds_cm_s: [f64; 2],
    /// c0, c1, c3 and c4.
    pub(super) constants: [f64; 4],
    pub(super) dt_s: f64,
    pub(super) seed: u64,
    /// Each start is a run of its own.
    pub(super) starts: Vec<TaskStart>,
    /// Steps before anything is recorded or timed.
    pub(super) warm_up_steps: usize,
    pub(super) steps: usize,
    /// Number of steps between two records of poses and velocities.
    pub(super) record_every: usize,
    /// Number of steps that are timed together; 0 for a run that is not timed.
    pub(super) block_steps: usize,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct TaskStart {
    pub(super) time_s: f64,
    /// [x cm, y cm, heading rad] of each boat.
    pub(super) poses: Vec<[f64; 3]>,
    /// [cm/s, cm/s, rad/s] of each boat.
    pub(super) velocities: Vec<[f64; 3]>,
}

impl Task {
    fn new(
        measure: &str,
        scene: &str,
        parameters: &FlockParameters,
        seed: u64,
        starts: &[Start],
    ) -> Self {
        let (p, hull) = (parameters, Hull::new(parameters));
        Self {
            measure: measure.to_owned(),
            scene: scene.to_owned(),
            outer_cm: p.pool.has_outer_wall().then_some(p.pool.outer_radius_cm),
            inner_cm: p.pool.inner_radius_cm,
            hull_cm: [hull.radius, hull.half_length],
            gyration_cm: p.gyration_radius_cm,
            phases_s: [p.fw_s, p.nop1_s, p.bw_s, p.nop2_s],
            speeds_cm_s: [p.speed_cm_s, p.reverse_speed_cm_s],
            constants: [p.c0, p.c1, p.c3, p.c4],
            dt_s: p.dt_s,
            seed,
            starts: starts.iter().map(TaskStart::from_start).collect(),
            warm_up_steps: 0,
            steps: 0,
            record_every: 0,
            block_steps: 0,
        }
    }

    /// Sets the durations in s of the warm-up and of the run, and the time between records.
    fn lasting(mut self, warm_up_s: f64, duration_s: f64, record_s: f64) -> Self {
        let steps = |seconds: f64| (seconds / self.dt_s).round() as usize;
        self.warm_up_steps = steps(warm_up_s);
        self.steps = steps(duration_s);
        self.record_every = steps(record_s);
        self
    }

    pub(super) fn scene(&self) -> Scene {
        let named = Scene::ALL
            .into_iter()
            .find(|scene| scene.name() == self.scene);
        named.expect("tasks of scenes carry their names")
    }
}

impl TaskStart {
    fn from_start(start: &Start) -> Self {
        let pose = |p: &Pose| [p.position.x, p.position.y, p.heading];
        let velocity = |v: &Velocity| [v.linear.x, v.linear.y, v.angular];
        Self {
            time_s: start.time_s,
            poses: start.poses.iter().map(pose).collect(),
            velocities: start.velocities.iter().map(velocity).collect(),
        }
    }
}

/// Writes the tasks.
///
/// # Panics
/// If they cannot be written.
pub fn write_tasks(files: &Path, effort: Effort) {
    let mut tasks = Vec::new();
    for dt_s in [0.005, STEP_S, 0.02] {
        let at = |parameters: FlockParameters| FlockParameters { dt_s, ..parameters };
        let seeds = if dt_s == STEP_S {
            effort.choose(1, 3)
        } else {
            1
        };
        for scene in Scene::ALL {
            for seed in 1..=seeds {
                tasks.push(timed_run(scene, at(scene.parameters(27)), seed, effort));
            }
            let parameters = at(horizon::parameters(scene));
            let starts = horizon::starts(scene, effort);
            let [first, second] = horizon::HORIZONS_S;
            tasks.push(
                Task::new("horizon", scene.name(), &parameters, 1, &starts)
                    .lasting(0.0, second, first),
            );
        }
        let sliding = Task::new("slide", "", &at(slide::scene()), 1, &slide::starts());
        tasks.push(sliding.lasting(0.0, slide::SLIDE_S, slide::SLIDE_S));
        let pushing = Task::new(
            "wall_push",
            "",
            &at(wall_push::scene()),
            1,
            &[wall_push::start(1e-9)],
        );
        tasks.push(pushing.lasting(
            wall_push::TRANSIENT_S,
            wall_push::AVERAGED_S,
            wall_push::AVERAGED_S,
        ));
        let flying = Task::new(
            "momentum",
            "",
            &at(momentum::scene()),
            1,
            &[momentum::start()],
        );
        tasks.push(flying.lasting(0.0, momentum::FLIGHT_S, momentum::FLIGHT_S));
    }
    let parameters = FlockParameters {
        dt_s: STEP_S,
        ..order::scene()
    };
    for seed in 1..=effort.choose(2, ORDER_SEEDS) {
        let start = Start::placed(&parameters, seed);
        let task = Task::new("order", "", &parameters, seed, &[start]);
        tasks.push(task.lasting(0.0, order::run_s(effort), order::FRAME_S));
    }
    fs::create_dir_all(files).expect("the folder can be made");
    let text = serde_json::to_string(&tasks).expect("tasks are plain data");
    fs::write(files.join("tasks.json"), text).expect("the tasks can be written");
}

fn timed_run(scene: Scene, parameters: FlockParameters, seed: u64, effort: Effort) -> Task {
    let start = Start::placed(&parameters, seed);
    let timed_s = effort.choose(12.0, speed::TIMED_S);
    let task = Task::new("overlap", scene.name(), &parameters, seed, &[start]);
    let block_steps = (Scene::BLOCK_S / parameters.dt_s).round() as usize;
    Task {
        block_steps,
        ..task.lasting(speed::WARM_UP_S, timed_s, parameters.dt_s)
    }
}
