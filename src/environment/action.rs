//! What an action stands for: a rudder, or a heading that a steering law steers to; and how long it is held.

use super::{ActionMode, EnvSettings};
use crate::boat::DampedLaw;
use crate::error::Result;
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
}
