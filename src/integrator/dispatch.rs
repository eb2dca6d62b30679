//! Takes a substep with the scheme of the parameters.

use super::state::Integrator;
use super::substep::Substep;
use super::{leapfrog, moreau, paper};
use crate::clock::{TICKS_PER_SECOND, Ticks};
use crate::contact::NotTaken;
use crate::parameters::Scheme;

/// Speeds below this, in cm/s or rad/s, count as rest. Drag alone never stops a boat: its speed would become so small
/// that processors take ten times as long for arithmetic with it or its square.
const REST: f64 = 1e-150;
/// Time between two calls of [`Integrator::bring_to_rest`].
const SECOND: Ticks = TICKS_PER_SECOND as Ticks;

impl Integrator {
    /// Takes one substep with the scheme of the parameters.
    ///
    /// # Errors
    /// [`NotTaken`].
    pub(crate) fn step(&mut self, substep: &Substep) -> Result<(), NotTaken> {
        let next_second = substep.start.next_multiple_of(SECOND);
        if next_second < substep.start + substep.length {
            self.bring_to_rest();
        }
        match self.parameters.scheme {
            Scheme::Leapfrog => leapfrog::step(self, substep),
            Scheme::Moreau => moreau::step(self, substep),
            Scheme::Paper => paper::step(self, substep),
        }?;
        self.statistics.substeps += 1;
        Ok(())
    }

    /// Stops boats that are slower than [`REST`]. One call per simulated second takes hardly any time. Calls come at whole
    /// seconds, so that the lengths of a run's advances do not matter.
    #[inline(never)]
    fn bring_to_rest(&mut self) {
        let stop = |speed: f64| if speed.abs() < REST { 0.0 } else { speed };
        self.water_cm_s = stop(self.water_cm_s);
        for velocity in &mut self.velocities {
            velocity.linear = velocity.linear.map(stop);
            velocity.angular = stop(velocity.angular);
        }
    }
}
