//! The contacts of a substep: from velocities without contacts to velocities that respect them.

use super::state::Integrator;
use super::substep::Substep;
use crate::clock::seconds;
use crate::contact::ContactOutcome;

/// Part of `dt_s` below which no substep is cut for the sake of its contacts.
const SHORTEST_SHARE: f64 = 1.0 / 16.0;

impl Integrator {
    /// Turns free velocities into velocities that respect the contacts of a substep.
    pub(super) fn solve_contacts(&mut self, substep: &Substep) -> ContactOutcome {
        let dt = seconds(substep.length);
        let shorter_possible = dt > SHORTEST_SHARE * self.parameters.dt_s;
        let (contacts, free, statistics) = (&mut self.contacts, &self.free, &mut self.statistics);
        if !contacts.find(&mut self.poses, &mut self.boats, free, dt, statistics) {
            if contacts.detector.moves_too_far(free, dt) {
                return ContactOutcome::TooLong;
            }
            contacts.clear_warm_start();
            self.velocities.copy_from_slice(free);
            return ContactOutcome::Untouched;
        }
        let (poses, inertia) = (&self.poses, &self.inertia);
        let outcome = contacts.resolve(poses, free, inertia, dt, shorter_possible, statistics);
        if outcome == ContactOutcome::Solved {
            self.velocities.copy_from_slice(&contacts.solver.velocities);
        }
        outcome
    }
}
