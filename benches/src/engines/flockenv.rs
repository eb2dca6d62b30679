//! flockenv itself.

use crate::{Engine, Start};
use flockenv::clock::{Ticks, ticks};
use flockenv::contact::{Partner, Statistics};
use flockenv::geometry::{Pose, Velocity};
use flockenv::integrator::Steering;
use flockenv::{Flock, FlockParameters};

/// A flock.
pub struct Ours {
    pub(super) flock: Flock,
    dt: Ticks,
    is_lost: bool,
}

impl Ours {
    /// A flock at a start.
    ///
    /// # Panics
    /// If parameters or start are refused.
    pub fn new(parameters: &FlockParameters, seed: u64, start: &Start) -> Self {
        let mut flock = Flock::new(parameters.clone(), seed).expect("the parameters hold");
        flock
            .set_state(&start.poses, &start.velocities, start.time_s, true)
            .expect("the start holds");
        Self {
            flock,
            dt: ticks(parameters.dt_s),
            is_lost: false,
        }
    }

    /// The flock.
    pub fn flock(&self) -> &Flock {
        &self.flock
    }
}

impl Engine for Ours {
    fn advance(&mut self, steps: usize) {
        let end = self.flock.time() + self.dt * steps as Ticks;
        if !self.is_lost {
            self.is_lost = self.flock.advance_to(&|| true, end, Steering::Law).is_err();
        }
    }

    fn poses(&self) -> Vec<Pose> {
        self.flock.poses().to_vec()
    }

    fn velocities(&self) -> Vec<Velocity> {
        self.flock.velocities().to_vec()
    }

    fn wall_force(&self) -> f64 {
        let contacts = self.flock.contacts();
        let on_wall = contacts
            .iter()
            .filter(|c| c.contact.partner == Partner::OuterWall);
        on_wall.map(|c| c.force).sum()
    }

    fn is_lost(&self) -> bool {
        self.is_lost
    }

    fn statistics(&self) -> Option<Statistics> {
        Some(*self.flock.statistics())
    }
}
