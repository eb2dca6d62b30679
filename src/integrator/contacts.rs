//! The contacts of a substep: from velocities without contacts to velocities that respect them.

use super::state::Integrator;
use super::substep::Substep;
use crate::clock::seconds;
use crate::contact::{Divisibility, Motion, NotTaken};

/// A substep is cut if its contacts would add energy to boats or take too much work, but not below this fraction of
/// `dt_s`.
const SHORTEST_SHARE: f64 = 1.0 / 16.0;
/// A substep that leaves overlaps is cut, but not below this fraction of `dt_s`.
const SHORTEST_OVERLAPPING_SHARE: f64 = 1.0 / 256.0;

impl Integrator {
    /// The reasons for which a substep of this length may still be cut.
    pub(super) fn divisibility(&self, dt: f64) -> Divisibility {
        Divisibility {
            if_driven: dt > SHORTEST_SHARE * self.parameters.dt_s,
            if_overlapping: dt > SHORTEST_OVERLAPPING_SHARE * self.parameters.dt_s,
        }
    }

    /// Changes velocities from free ones to those that respect the contacts of a substep. Returns whether there are
    /// contacts.
    ///
    /// # Errors
    /// [`NotTaken`].
    pub(super) fn solve_contacts(&mut self, substep: &Substep) -> Result<bool, NotTaken> {
        let dt = seconds(substep.length);
        let divisibility = self.divisibility(dt);
        let (contacts, free, statistics) = (&mut self.contacts, &self.free, &mut self.statistics);
        if !contacts.find(&mut self.poses, &mut self.boats, free, dt, statistics) {
            if contacts.detector.moves_too_far(free, dt) {
                return Err(NotTaken::TooLong);
            }
            contacts.clear_warm_start();
            self.velocities.copy_from_slice(free);
            return Ok(false);
        }
        let motion = Motion {
            poses: &self.poses,
            hulls: &self.boats,
            before: Some(&self.velocities),
            free,
            inertia: &self.inertia,
            dt,
        };
        contacts.resolve(&motion, divisibility, statistics)?;
        // A swap costs less than a copy, and nothing reads the solver's velocities before it solves again.
        std::mem::swap(&mut self.velocities, &mut contacts.solver.velocities);
        Ok(true)
    }
}
