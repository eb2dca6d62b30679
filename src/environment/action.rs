//! What an action stands for: a rudder, or a heading that a steering law steers to; and how long it is held.

use crate::boat::DampedLaw;
use crate::clock::{seconds, whole_steps};
use crate::error::{FlockError, Result};
use crate::integrator::PhaseSchedule;
use crate::parameters::{FlockParameters, named_choice};
use std::f64::consts::PI;

named_choice! {
    /// What an action stands for.
    pub enum ActionMode ("action_mode") {
        /// The rudder itself.
        Rudder = "rudder",
        /// Any heading: its angle outward of the target's tangent over π. The damped law steers to it.
        Heading = "heading",
        /// A heading about the tangent: its angle outward over [`LARGEST_LEAN`]. The pool's tuned law steers to it,
        /// and 0 is that law itself.
        Lean = "lean",
    }
}

/// The angle in rad that a lean of 1 stands for.
pub const LARGEST_LEAN: f64 = 1.2;

/// How actions are read, and how long they are held.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ActionSettings {
    /// What an action stands for.
    pub mode: ActionMode,
    /// Time in s between decisions, a whole number of control steps; `None`: one control step.
    pub decision_period_s: Option<f64>,
}

impl Default for ActionSettings {
    fn default() -> Self {
        Self {
            mode: ActionMode::Rudder,
            decision_period_s: None,
        }
    }
}

impl ActionSettings {
    /// Checks the settings for episodes with so many control steps per second.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self, parameters: &FlockParameters, control_hz: f64) -> Result<()> {
        self.steering_law(parameters)?;
        match self.decision_period_s {
            Some(period) => {
                whole_steps("decision_period_s", period, control_hz, "control steps").map(drop)
            }
            None => Ok(()),
        }
    }

    /// The decision period in s that is nearest to a number of motor cycles: a whole number of control steps, at
    /// least one.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for numbers that are not positive, and periods of more than 1e9 control steps.
    pub fn period_of_cycles(
        cycles: f64,
        parameters: &FlockParameters,
        control_hz: f64,
    ) -> Result<f64> {
        let steps = cycles * seconds(PhaseSchedule::new(parameters).cycle()) * control_hz;
        if !(cycles > 0.0 && steps <= 1e9) {
            let accepted = "a positive number of motor cycles, at most 1e9 control steps long";
            return Err(FlockError::parameter(
                "decision_period_cycles",
                cycles,
                accepted,
            ));
        }
        Ok(steps.round().max(1.0) / control_hz)
    }

    /// Control steps from one decision to the next.
    pub fn control_steps(&self, control_hz: f64) -> u32 {
        self.decision_period_s
            .map_or(1, |period| (period * control_hz).round() as u32)
    }

    /// The law that steers to the heading that an action stands for; `None` where actions are rudders.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for leans in a pool in which the law has not been tuned.
    pub fn steering_law(&self, parameters: &FlockParameters) -> Result<Option<DampedLaw>> {
        match self.mode {
            ActionMode::Rudder => Ok(None),
            ActionMode::Heading => Ok(Some(DampedLaw::default())),
            ActionMode::Lean => {
                DampedLaw::tuned("action_mode", "\"lean\"", parameters.pool.name()).map(Some)
            }
        }
    }

    /// The angle in rad outward of the target's tangent that an action in [−1, 1] stands for.
    pub fn angle(&self, action: f64) -> f64 {
        match self.mode {
            ActionMode::Rudder => 0.0,
            ActionMode::Heading => PI * action,
            ActionMode::Lean => LARGEST_LEAN * action,
        }
    }
}
