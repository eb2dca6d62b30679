//! flockenv with a step that follows its error.

use super::Ours;
use crate::{Engine, Start};
use flockenv::clock::{Ticks, seconds, ticks};
use flockenv::geometry::{Pose, Velocity, rms_distance};
use flockenv::integrator::Steering;
use flockenv::{Flock, FlockParameters, Result};
use std::time::{Duration, Instant};

/// Number of shortest half steps in the longest step.
const PARTS: u64 = 256;
/// The next step is twice as long if the error is less than this share of what is accepted.
const GROWS_BELOW: f64 = 0.1;

/// A flock whose step is compared with its two halves. If they differ by more than is accepted, the
/// halves are tried apart, and so on; halves that are accepted stand.
pub struct Controlled {
    now: Ours,
    accepted_cm: f64,
    clock: Clock,
    /// Length of the next step, in parts.
    length: u64,
    /// Parts that were taken.
    done: u64,
    is_lost: bool,
}

/// Moves copies of a flock, and counts the time that they take. Copies, and checks of parameters with
/// another step, do not count: a controlled step that is built in needs neither.
struct Clock {
    part: Ticks,
    moving: Duration,
}

impl Clock {
    /// A copy of a flock after one step of so many parts.
    fn moved(&mut self, flock: &Flock, parts: u64) -> Result<Flock> {
        let mut copy = flock.clone();
        copy.set_step(seconds(parts * self.part))?;
        let end = copy.time() + parts * self.part;
        let start = Instant::now();
        copy.advance_to(&|| true, end, Steering::Law)?;
        self.moving += start.elapsed();
        Ok(copy)
    }
}

impl Controlled {
    /// A flock that starts at the start given; the parameters' step is its longest.
    ///
    /// # Panics
    /// If parameters or start are refused.
    pub fn new(parameters: &FlockParameters, seed: u64, start: &Start, accepted_cm: f64) -> Self {
        Self {
            now: Ours::new(parameters, seed, start),
            accepted_cm,
            clock: Clock {
                part: ticks(parameters.dt_s) / PARTS,
                moving: Duration::ZERO,
            },
            length: PARTS,
            done: 0,
            is_lost: false,
        }
    }

    /// Takes the longest step that is accepted.
    fn step(&mut self) -> Result<()> {
        let gyration_cm = self.now.flock.parameters().gyration_radius_cm;
        let mut whole = self.clock.moved(&self.now.flock, self.length)?;
        loop {
            let half = self.length / 2;
            let middle = self.clock.moved(&self.now.flock, half)?;
            let halves = self.clock.moved(&middle, half)?;
            let error_cm = rms_distance(halves.poses(), whole.poses(), gyration_cm);
            if error_cm <= self.accepted_cm || half == 1 {
                self.now.flock = halves;
                self.done += self.length;
                self.grow(error_cm);
                return Ok(());
            }
            (self.length, whole) = (half, middle);
        }
    }

    /// Makes the next step twice as long if the error allows it, and only where longer steps start.
    fn grow(&mut self, error_cm: f64) {
        let is_small = error_cm < GROWS_BELOW * self.accepted_cm;
        if is_small && self.length < PARTS && self.done.is_multiple_of(2 * self.length) {
            self.length *= 2;
        }
    }
}

impl Engine for Controlled {
    fn advance(&mut self, steps: usize) {
        let end = self.done + steps as u64 * PARTS;
        while self.done < end && !self.is_lost {
            self.is_lost = self.step().is_err();
        }
    }

    fn poses(&self) -> Vec<Pose> {
        self.now.poses()
    }

    fn velocities(&self) -> Vec<Velocity> {
        self.now.velocities()
    }

    fn wall_force(&self) -> f64 {
        self.now.wall_force()
    }

    fn step_call(&self) -> Option<Duration> {
        Some(self.clock.moving)
    }

    fn is_lost(&self) -> bool {
        self.is_lost
    }
}
