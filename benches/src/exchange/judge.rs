//! What engines in other languages made of their tasks, judged like everyone else's.

use super::task::{ORDER_SEEDS, Task, TaskStart};
use crate::Scene;
use crate::measure::{
    Effort, horizon, momentum, order, overlap, push_row, slide, speed, table, wall_push,
};
use crate::table::{Table, number};
use flockenv::geometry::{Pose, Velocity};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The result of a task in an engine.
#[derive(Debug, Clone, Deserialize)]
struct Outcome {
    engine: String,
    setting: String,
    /// Index of the task.
    task: usize,
    /// File of little-endian doubles [start][record][boat][x y heading vx vy ω].
    file: String,
    /// Times of the engine's step call in µs per step, block by block.
    block_us: Vec<f64>,
    /// µs per step of rapier2d-f64's step call, measured right after.
    yardstick_us: Option<f64>,
    /// Mean force on the outer wall after the warm-up, in cm/s².
    wall_force: f64,
}

/// States of all boats.
struct Record {
    poses: Vec<Pose>,
    velocities: Vec<Velocity>,
}

/// An outcome with its task and its records, start by start.
struct Judged {
    cells: Vec<String>,
    outcome: Outcome,
    task: Task,
    records: Vec<Vec<Record>>,
}

impl Judged {
    fn new(files: &Path, tasks: &[Task], outcome: Outcome) -> Self {
        let task = tasks[outcome.task].clone();
        let bytes = fs::read(files.join(&outcome.file)).expect("the file of a result can be read");
        let numbers: Vec<f64> = bytes
            .chunks_exact(8)
            .map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")))
            .collect();
        let boats = task.starts[0].poses.len();
        let records: Vec<Record> = numbers
            .chunks(6 * boats)
            .map(Record::from_numbers)
            .collect();
        let mut records = records.into_iter();
        let records_per_run = task.steps / task.record_every;
        let of_start = |_: &TaskStart| records.by_ref().take(records_per_run).collect();
        Self {
            cells: vec![
                outcome.engine.clone(),
                outcome.setting.clone(),
                String::new(),
                String::new(),
                String::new(),
                number(task.dt_s),
            ],
            records: task.starts.iter().map(of_start).collect(),
            outcome,
            task,
        }
    }

    /// Engine, setting, measurement and scene: everything but the seed.
    fn key(&self) -> String {
        format!("{:?} {} {}", self.cells, self.task.measure, self.task.scene)
    }
}

impl Record {
    fn from_numbers(numbers: &[f64]) -> Self {
        let states = || numbers.chunks_exact(6);
        Self {
            poses: states().map(|s| Pose::new(s[0], s[1], s[2])).collect(),
            velocities: states().map(|s| Velocity::new(s[3], s[4], s[5])).collect(),
        }
    }
}

/// Judges all results: one CSV a measurement, named after it, with `_peers`.
///
/// # Panics
/// If tasks or results cannot be read.
pub fn judge(files: &Path, folder: &Path, effort: Effort) {
    let read = |name: &str| fs::read(files.join(name)).expect("tasks and results can be read");
    let tasks: Vec<Task> =
        serde_json::from_slice(&read("tasks.json")).expect("tasks are well-formed");
    let outcomes: Vec<Outcome> =
        serde_json::from_slice(&read("results.json")).expect("results are well-formed");
    let mut groups: BTreeMap<String, Vec<Judged>> = BTreeMap::new();
    for outcome in outcomes {
        let judged = Judged::new(files, &tasks, outcome);
        groups.entry(judged.key()).or_default().push(judged);
    }
    let mut tables = Tables::new(effort);
    groups.values().for_each(|group| tables.add(group));
    for (name, table) in tables.all {
        table.write(folder, &format!("{name}_peers.csv"));
    }
}

/// The tables, and what the rows in them are compared with.
struct Tables {
    all: BTreeMap<&'static str, Table>,
    slides: Vec<Vec<Pose>>,
    horizons: [horizon::Ends; 2],
    orders: Vec<[f64; 2]>,
}

impl Tables {
    fn new(effort: Effort) -> Self {
        let columns: [(&str, &[&str]); 6] = [
            ("overlap", &overlap::COLUMNS),
            ("slide", &slide::COLUMNS),
            ("wall_push", &wall_push::COLUMNS),
            ("momentum", &momentum::COLUMNS),
            ("horizon", &horizon::COLUMNS),
            ("order", &order::COLUMNS),
        ];
        let mut all: BTreeMap<_, _> = columns.map(|(name, columns)| (name, table(columns))).into();
        all.insert("speed", speed::empty_table());
        Self {
            all,
            slides: slide::reference(),
            horizons: Scene::ALL
                .map(|scene| horizon::reference(scene, &horizon::starts(scene, effort))),
            orders: order::reference(effort, effort.choose(2, ORDER_SEEDS)),
        }
    }

    fn push(&mut self, name: &str, group: &[Judged], cells: Vec<String>) {
        let table = self
            .all
            .get_mut(name)
            .expect("every measurement has a table");
        push_row(table, &group[0].cells, cells);
    }

    /// Adds the rows of a group of runs that differ only in their seeds.
    fn add(&mut self, group: &[Judged]) {
        let first = &group[0];
        let ends = |index: usize| move |run: &Vec<Record>| run[index].poses.clone();
        match first.task.measure.as_str() {
            "overlap" => self.add_timed_run(group),
            "slide" => {
                let ends: Vec<_> = first.records.iter().map(ends(0)).collect();
                self.push("slide", group, slide::row(&ends, &self.slides));
            }
            "wall_push" => self.push("wall_push", group, wall_push::row(first.outcome.wall_force)),
            "momentum" => {
                let end = &first.records[0][0];
                self.push(
                    "momentum",
                    group,
                    momentum::row(&end.poses, &end.velocities),
                );
            }
            "horizon" => {
                let runs = first.records.iter();
                let ends: horizon::Ends = runs
                    .map(|run| [0, 1].map(|index| ends(index)(run)))
                    .collect();
                let scene = first.task.scene();
                let scene_index = usize::from(scene != Scene::ALL[0]);
                for row in horizon::rows(scene, &ends, &self.horizons[scene_index]) {
                    self.push("horizon", group, row);
                }
            }
            "order" => self.add_order(group),
            unknown => panic!("no measurement is called {unknown}"),
        }
    }

    fn add_timed_run(&mut self, group: &[Judged]) {
        let (task, scene) = (&group[0].task, group[0].task.scene());
        let boats = task.starts[0].poses.len();
        let (mut own, mut reference) = (speed::Times::default(), speed::Times::default());
        for run in group {
            let mut overlap = overlap::Overlap::new(&scene.parameters(boats));
            run.records[0]
                .iter()
                .for_each(|record| overlap.add(&record.poses));
            let cells = overlap::row(scene, boats, run.task.seed, &overlap, None);
            self.push("overlap", group, cells);
            let yardstick = run
                .outcome
                .yardstick_us
                .expect("runs that are timed come with a yardstick");
            for &time in &run.outcome.block_us {
                // Step calls are compared with step calls, since Python computes the forces here.
                own.whole.push(time);
                reference.whole.push(yardstick);
            }
        }
        own.call.clone_from(&own.whole);
        reference.call.clone_from(&reference.whole);
        self.push(
            "speed",
            group,
            speed::row(scene, boats, task.dt_s, &own, &reference),
        );
    }

    fn add_order(&mut self, group: &[Judged]) {
        let run_s = group[0].task.steps as f64 * group[0].task.dt_s;
        let mut runs: Vec<&Judged> = group.iter().collect();
        runs.sort_by_key(|run| run.task.seed);
        let means: Vec<[f64; 2]> = runs.iter().map(|run| order_of(run, run_s)).collect();
        self.push("order", group, order::row(1, run_s, &means, &self.orders));
    }
}

fn order_of(run: &Judged, run_s: f64) -> [f64; 2] {
    let mut frames = order::Frames::new(run_s);
    for (index, record) in run.records[0].iter().enumerate() {
        frames.add(
            (index + 1) as f64 * order::FRAME_S,
            &record.poses,
            &record.velocities,
        );
    }
    frames.means()
}
