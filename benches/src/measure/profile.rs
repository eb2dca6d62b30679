//! The time of each part of a step: the parts of leapfrog steps of a jam, one by one, on the states of consecutive steps.
//! The remaining time of a whole step is bookkeeping, drift, and effects of the parts on each other's caches.

use super::Effort;
use super::solvers::{Problem, jam, without_contacts};
use crate::configuration::STEP_S;
use crate::table::{Table, median, number, text};
use flockenv::Flock;
use flockenv::clock::{Ticks, ticks};
use flockenv::contact::solver::ContactSolver;
use flockenv::contact::{Contact, ContactDetector};
use flockenv::geometry::{HullPose, Velocity};
use flockenv::parameters::Solver;
use flockenv::random::BrownianPaths;
use std::hint::black_box;
use std::time::Instant;

/// Parts in the order of the columns.
const PARTS: [&str; 6] = [
    "whole_us",
    "noise_us",
    "free_us",
    "find_us",
    "solve_us",
    "solve_known_us",
];

/// Consecutive states of a jam.
struct States {
    /// The flock before the first of these states.
    before: Flock,
    boats: Vec<Vec<HullPose>>,
    velocities: Vec<Vec<Velocity>>,
    problems: Vec<Problem>,
    /// The same problems, with their solutions as initial guesses.
    known: Vec<Problem>,
}

impl States {
    fn new(boats: usize, count: usize) -> Self {
        let before = jam(boats);
        let mut states = Self {
            boats: Vec::new(),
            velocities: Vec::new(),
            problems: Vec::new(),
            known: Vec::new(),
            before,
        };
        let mut flock = states.before.clone();
        let mut solver = ContactSolver::new(Solver::BlockPivoting);
        for _ in 0..count {
            let (problem, mut known) =
                (Problem::of_next_step(&flock), Problem::of_next_step(&flock));
            problem.solve(&mut solver);
            known.guess.clone_from(&solver.impulses);
            states
                .boats
                .push(flock.poses().iter().map(HullPose::new).collect());
            states.velocities.push(flock.velocities().to_vec());
            states.problems.push(problem);
            states.known.push(known);
            flock
                .advance(STEP_S, None)
                .expect("the motion stays finite");
        }
        states
    }

    fn whole(&self) -> f64 {
        let mut flock = self.before.clone();
        let duration = STEP_S * self.boats.len() as f64;
        self.per_step(|| {
            flock
                .advance(duration, None)
                .expect("the motion stays finite");
        })
    }

    fn noise(&self) -> f64 {
        let (n, dt) = (self.before.parameters().n_boats, ticks(STEP_S));
        let mut paths = BrownianPaths::new(1, n, 2 * dt, dt);
        let mut increments = vec![0.0; n];
        self.per_step(|| {
            for k in 1..=self.boats.len() as Ticks {
                paths.increments(2 * k * dt - dt, 2 * k * dt + dt, black_box(&mut increments));
            }
        })
    }

    fn free_motion(&self) -> f64 {
        self.per_step(|| {
            for (boats, velocities) in self.boats.iter().zip(&self.velocities) {
                black_box(without_contacts(
                    self.before.parameters(),
                    boats,
                    velocities,
                ));
            }
        })
    }

    fn find(&self) -> f64 {
        let mut detector = ContactDetector::new(self.before.parameters());
        let mut contacts: Vec<Contact> = Vec::new();
        self.per_step(|| {
            for (boats, velocities) in self.boats.iter().zip(&self.velocities) {
                detector.detect_moving(boats, velocities, STEP_S, black_box(&mut contacts));
            }
        })
    }

    fn solve(&self, problems: &[Problem]) -> f64 {
        let mut solver = ContactSolver::new(Solver::BlockPivoting);
        self.per_step(|| {
            for problem in problems {
                black_box(problem.solve(&mut solver));
            }
        })
    }

    /// Time of some work in µs, divided by the number of states.
    fn per_step(&self, work: impl FnOnce()) -> f64 {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e6 / self.boats.len() as f64
    }

    fn parts(&self) -> [f64; 6] {
        [
            self.whole(),
            self.noise(),
            self.free_motion(),
            self.find(),
            self.solve(&self.problems),
            self.solve(&self.known),
        ]
    }
}

/// Measures jams of every size; parts take turns.
pub fn measure(effort: Effort) -> Table {
    let mut table = Table::new(&[["n", "steps"].as_slice(), &PARTS].concat());
    for boats in [27, 50, 200, 1000, 10_000] {
        let count = effort.choose(10, (24_000 / boats).clamp(6, 400));
        let states = States::new(boats, count);
        let turns: Vec<[f64; 6]> = (0..effort.choose(2, if boats > 1000 { 5 } else { 15 }))
            .map(|_| states.parts())
            .collect();
        let mut cells = vec![text(boats), text(count)];
        for part in 0..PARTS.len() {
            let times: Vec<f64> = turns.iter().map(|turn| turn[part]).collect();
            cells.push(number(median(&times)));
        }
        table.row(cells);
    }
    table
}
