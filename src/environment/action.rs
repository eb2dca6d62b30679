//! Meaning of actions: a rudder, one of some levels, or the heading that a law steers to.

use crate::boat::DampedLaw;
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, named_choice};
use std::f64::consts::PI;

/// Angle in rad of a lean of 1.
pub const LARGEST_LEAN: f64 = 1.2;

named_choice! {
    /// Meaning of an action.
    pub enum ActionMode ("action_mode") {
        /// The rudder itself.
        Rudder = "rudder",
        /// Any heading, as its angle outward of the target's tangent over π. The damped law steers to it.
        Heading = "heading",
        /// A heading about the target's tangent, as its angle outward over [`LARGEST_LEAN`]. The pool's tuned law steers
        /// to it, so the action 0 is that law itself.
        Lean = "lean",
    }
}

impl ActionMode {
    /// The law that steers to an action's heading; `None` if actions are rudders.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for leans in a pool in which the law has not been tuned.
    pub fn steering_law(self, parameters: &FlockParameters) -> Result<Option<DampedLaw>> {
        match self {
            Self::Rudder => Ok(None),
            Self::Heading => Ok(Some(DampedLaw::default())),
            Self::Lean => {
                DampedLaw::tuned("action_mode", "\"lean\"", parameters.pool.name()).map(Some)
            }
        }
    }

    /// Angle in rad, outward of the target's tangent, of the heading that an action in [−1, 1] asks for; 0 for a rudder.
    pub fn angle(self, action: f64) -> f64 {
        match self {
            Self::Rudder => 0.0,
            Self::Heading => PI * action,
            Self::Lean => LARGEST_LEAN * action,
        }
    }
}

/// Checks an action: a number, or the number of a level if actions are discrete.
///
/// # Errors
/// [`FlockError::Parameter`] for NaN and for levels that do not exist. Numbers beyond ±1 are accepted and clipped.
pub(super) fn check(action: f64, levels: Option<usize>) -> Result<()> {
    if let Some(levels) = levels {
        let is_level = action >= 0.0 && action < levels as f64 && action.fract() == 0.0;
        let accepted = format!("whole numbers from 0 to {}", levels - 1);
        return FlockError::unless(is_level, "action", action, accepted);
    }
    let accepted = "numbers; those beyond [-1, 1] are clipped";
    FlockError::unless(!action.is_nan(), "action", action, accepted)
}

/// The value in [−1, 1] of a checked action: the action clipped, or the value of its level.
pub(super) fn command(action: f64, levels: Option<usize>) -> f64 {
    match levels {
        // Levels i and n - 1 - i have exactly opposite values, so that a mirrored task is the same task.
        Some(levels) => {
            let highest = (levels - 1) as f64;
            (2.0 * action - highest) / highest
        }
        None => action.clamp(-1.0, 1.0),
    }
}
