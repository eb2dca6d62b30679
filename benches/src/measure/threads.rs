//! The time of a step of other engines on two threads, relative to flockenv's on one.
//!
//! Engines take turns, so that other work of the machine slows them alike. Ratios are taken turn by turn.

use super::speed::{Entry, take_turns};
use super::{Effort, push_row, table};
use crate::configuration::STEP_S;
use crate::table::{Table, number, quartiles, text};
use crate::{Configuration, Scene};
use flockenv::parameters::Scheme;

/// Threads of the other engines.
pub const THREADS: usize = 2;

const COLUMNS: [&str; 9] = [
    "scene",
    "n",
    "threads",
    "us_per_step",
    "us_q1",
    "us_q3",
    "times_as_long",
    "times_q1",
    "times_q3",
];

/// Times flockenv with the default tolerance and the engines that have threads.
pub fn measure(effort: Effort) -> Table {
    let mut table = table(&COLUMNS);
    let timed_s = effort.choose(6.0, 60.0);
    add_rows(&mut table, Scene::Jam, 27, timed_s);
    add_rows(&mut table, Scene::Cycle, 27, timed_s);
    add_rows(&mut table, Scene::Jam, 1000, effort.choose(6.0, 24.0));
    table
}

fn add_rows(table: &mut Table, scene: Scene, boats: usize, timed_s: f64) {
    let rows = [
        (Configuration::exact(Scheme::Leapfrog, 1e-4, STEP_S), 1),
        (Configuration::rapier(STEP_S), THREADS),
        (Configuration::box2d_with_two_workers(STEP_S), THREADS),
    ];
    let entries = rows.map(|(configuration, _)| Entry {
        configuration,
        parameters: scene.parameters(boats),
    });
    let times = take_turns(&entries, 1, timed_s);
    let ours = &times[0].whole;
    for ((configuration, threads), times) in rows.iter().zip(&times) {
        let ratios = times
            .whole
            .iter()
            .zip(ours)
            .map(|(theirs, ours)| theirs / ours);
        let [us_q1, us, us_q3] = quartiles(&times.whole);
        let [times_q1, longer, times_q3] = quartiles(&ratios.collect::<Vec<f64>>());
        let mut cells = vec![text(scene.name()), text(boats), text(threads)];
        cells.extend([us, us_q1, us_q3, longer, times_q1, times_q3].map(number));
        push_row(table, &configuration.cells(), cells);
    }
}
