//! η of eq. (9): the change of each boat's angular velocity by noise over a substep.

use super::state::Integrator;
use super::substep::Substep;
use crate::clock::{Ticks, seconds};
use crate::parameters::Noise;

impl Integrator {
    /// Fills `noise_increments` with the noise of the interval from `from` to `to`, in half ticks. Noise that is drawn once
    /// per step is keyed by the substep's `start`, in ticks.
    pub(super) fn draw_noise(&mut self, start: Ticks, from: u64, to: u64) {
        let Some(noise) = &mut self.noise else { return };
        let scale = match self.parameters.noise_scheme {
            Noise::White => {
                noise.increments(from, to, &mut self.noise_increments);
                self.parameters.c4
            }
            Noise::PerStep => {
                noise.step_draws(start, &mut self.noise_increments);
                self.parameters.c4 * seconds(to - from) / 2.0
            }
        };
        self.noise_increments
            .iter_mut()
            .for_each(|increment| *increment *= scale);
    }

    /// Fills `noise_increments` with the noise of a whole substep.
    pub(super) fn draw_substep_noise(&mut self, substep: &Substep) {
        let end = substep.start + substep.length;
        self.draw_noise(substep.start, 2 * substep.start, 2 * end);
    }
}
