//! η of eq. (9): the change of each boat's angular velocity by noise over a substep.

use super::state::Integrator;
use super::substep::Substep;
use crate::clock::{Ticks, seconds};
use crate::parameters::Noise;

impl Integrator {
    /// Fills `kicks` with the noise of the interval [from, to] (half ticks), which the scheme takes
    /// at `start`.
    pub(super) fn draw_kicks(&mut self, start: Ticks, from: u64, to: u64) {
        let Some(noise) = &mut self.noise else { return };
        let scale = match self.parameters.noise {
            Noise::White => {
                noise.increments(from, to, &mut self.kicks);
                self.parameters.c4
            }
            Noise::PerStep => {
                noise.step_draws(start, &mut self.kicks);
                self.parameters.c4 * seconds(to - from) / 2.0
            }
        };
        self.kicks.iter_mut().for_each(|kick| *kick *= scale);
    }

    /// Fills `kicks` with the noise of a whole substep.
    pub(super) fn draw_step_kicks(&mut self, substep: &Substep) {
        let end = substep.start + substep.length;
        self.draw_kicks(substep.start, 2 * substep.start, 2 * end);
    }
}
