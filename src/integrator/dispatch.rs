//! Takes a substep with the scheme of the parameters.

use super::state::Integrator;
use super::substep::{StepOutcome, Substep};
use super::{leapfrog, moreau, paper};
use crate::parameters::Scheme;

impl Integrator {
    /// Takes one substep with the scheme of the parameters.
    pub(crate) fn step(&mut self, substep: &Substep) -> StepOutcome {
        let outcome = match self.parameters.scheme {
            Scheme::Leapfrog => leapfrog::step(self, substep),
            Scheme::Moreau => moreau::step(self, substep),
            Scheme::Paper => paper::step(self, substep),
        };
        if self.contacts.is_exhausted {
            return StepOutcome::Exhausted;
        }
        self.statistics.substeps += u64::from(outcome == StepOutcome::Taken);
        outcome
    }
}
