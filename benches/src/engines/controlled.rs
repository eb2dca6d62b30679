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
/// The next step is twice as long if the error is less than this fraction of the accepted error.
const GROWS_BELOW: f64 = 0.1;

/// A flock whose step is compared with its two halves. If they differ by more than is accepted, the first half is tried
/// as a step, and so on. Accepted halves are kept.
pub struct Controlled {
    ours: Ours,
    accepted_cm: f64,
    clock: Clock,
    /// Length of the next step, in parts.
    length: u64,
    /// Number of parts of the steps so far.
    done: u64,
    is_lost: bool,
}

/// Advances copies of a flock, and measures the time of advancing. Copying and checking parameters do not count, since a
/// built-in controlled step would need neither.
struct Clock {
    part: Ticks,
    moving: Duration,
}

impl Clock {
    /// A copy of a flock after one step of this many parts.
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
    /// A flock at a start; the parameters' step is its longest.
    ///
    /// # Panics
    /// If parameters or start are refused.
    pub fn new(parameters: &FlockParameters, seed: u64, start: &Start, accepted_cm: f64) -> Self {
        Self {
            ours: Ours::new(parameters, seed, start),
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

    /// Takes the longest accepted step of at most `length` parts.
    fn step(&mut self) -> Result<()> {
        let gyration_cm = self.ours.flock.parameters().gyration_radius_cm;
        let mut whole = self.clock.moved(&self.ours.flock, self.length)?;
        loop {
            let half = self.length / 2;
            let middle = self.clock.moved(&self.ours.flock, half)?;
            let halves = self.clock.moved(&middle, half)?;
            let error_cm = rms_distance(halves.poses(), whole.poses(), gyration_cm);
            if error_cm <= self.accepted_cm || half == 1 {
                self.ours.flock = halves;
                self.done += self.length;
                self.grow(error_cm);
                return Ok(());
            }
            (self.length, whole) = (half, middle);
        }
    }

    /// Doubles the next step if the error allows it and the time is a multiple of the doubled step.
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
        self.ours.poses()
    }

    fn velocities(&self) -> Vec<Velocity> {
        self.ours.velocities()
    }

    fn wall_force(&self) -> f64 {
        self.ours.wall_force()
    }

    fn step_call(&self) -> Option<Duration> {
        Some(self.clock.moving)
    }

    fn is_lost(&self) -> bool {
        self.is_lost
    }
}
