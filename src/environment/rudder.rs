//! From actions to rudders: what an action stands for, clipping, discrete choices, and what a real servo does to a
//! command.

use super::{ActionMode, EnvSettings};
use crate::boat::DampedLaw;
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;
use std::f64::consts::PI;

/// The angle in rad that a lean of 1 stands for.
pub const LARGEST_LEAN: f64 = 1.2;

impl EnvSettings {
    /// The law that steers to the heading that an action stands for; `None` where actions are rudders.
    ///
    /// # Errors
    /// [`FlockError::Parameter`](crate::FlockError::Parameter) for leans in a pool in which the law has not been tuned.
    pub fn steering_law(&self, parameters: &FlockParameters) -> Result<Option<DampedLaw>> {
        match self.action_mode {
            ActionMode::Rudder => Ok(None),
            ActionMode::Heading => Ok(Some(DampedLaw::default())),
            ActionMode::Lean => {
                DampedLaw::tuned("action_mode", "\"lean\"", parameters.pool.name()).map(Some)
            }
        }
    }

    /// The angle in rad outward of the target's tangent that an action in [−1, 1] stands for.
    pub fn angle(&self, action: f64) -> f64 {
        match self.action_mode {
            ActionMode::Rudder => 0.0,
            ActionMode::Heading => PI * action,
            ActionMode::Lean => LARGEST_LEAN * action,
        }
    }

    /// Checks one action.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for NaN and for choices that do not exist. Rudders beyond ±1 are
    /// accepted: they are clipped.
    pub fn check_action(&self, action: f64) -> Result<()> {
        if let Some(levels) = self.rudder_levels {
            let is_level = action >= 0.0 && action < levels as f64 && action.fract() == 0.0;
            let accepted = format!("whole numbers from 0 to {}", levels - 1);
            return FlockError::unless(is_level, "action", action, accepted);
        }
        let accepted = "numbers; those beyond [-1, 1] are clipped";
        FlockError::unless(!action.is_nan(), "action", action, accepted)
    }

    /// The rudder of a checked action, in [−1, 1].
    pub fn command(&self, action: f64) -> f64 {
        match self.rudder_levels {
            // Levels i and n - 1 - i are opposite to the bit: mirrored tasks stay the same task.
            Some(levels) => {
                let highest = (levels - 1) as f64;
                (2.0 * action - highest) / highest
            }
            None => action.clamp(-1.0, 1.0),
        }
    }

    /// The servo, prepared for control steps.
    pub fn servo(&self) -> Servo {
        let period_s = 1.0 / self.control_hz;
        Servo {
            follow: if self.rudder_lag_s > 0.0 {
                1.0 - libm::exp(-period_s / self.rudder_lag_s)
            } else {
                1.0
            },
            most: self
                .rudder_rate_per_s
                .map_or(f64::INFINITY, |rate| rate * period_s),
        }
    }
}

/// A servo that takes one move a control step and holds the rudder in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Part of the difference to the command that is made up in a step.
    follow: f64,
    /// Largest change in a step.
    most: f64,
}

impl Servo {
    /// Where the rudder is after the step's move.
    pub fn moved(&self, rudder: f64, command: f64) -> f64 {
        if self.follow == 1.0 && self.most >= 2.0 {
            return command;
        }
        let change = self.follow * (command - rudder);
        (rudder + change.clamp(-self.most, self.most)).clamp(-1.0, 1.0)
    }
}
