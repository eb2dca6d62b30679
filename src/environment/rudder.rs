//! From actions to rudders: clipping, discrete choices, and what a real servo does to a command.

use crate::error::{FlockError, Result};

/// How actions become rudders.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct RudderSettings {
    /// Number of choices of the discrete action: 0, 1, … stand for rudders evenly spaced from −1 to 1;
    /// `None`: actions are rudders.
    pub levels: Option<usize>,
    /// Time constant of the servo in s; 0: none.
    pub lag_s: f64,
    /// Fastest change of the rudder in 1/s (−1 to 1 is a change of 2); `None`: any.
    pub rate_per_s: Option<f64>,
}

impl RudderSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self) -> Result<()> {
        if let Some(levels) = self.levels
            && !(2..=1001).contains(&levels)
        {
            let accepted = "2 to 1001 choices, or none for continuous rudders";
            return Err(FlockError::parameter("rudder_levels", levels, accepted));
        }
        if !(0.0..=1e3).contains(&self.lag_s) {
            let accepted = "0 (no lag) to 1000 s";
            return Err(FlockError::parameter("rudder_lag_s", self.lag_s, accepted));
        }
        match self.rate_per_s {
            Some(rate) if !(rate > 0.0 && rate <= 1e6) => Err(FlockError::parameter(
                "rudder_rate_per_s",
                rate,
                "a positive rate, or none for any",
            )),
            _ => Ok(()),
        }
    }

    /// Checks one action.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for NaN and for choices that do not exist. Rudders beyond ±1 are
    /// accepted: they are clipped.
    pub fn check_action(&self, action: f64) -> Result<()> {
        if let Some(levels) = self.levels {
            if action >= 0.0 && action < levels as f64 && action.fract() == 0.0 {
                return Ok(());
            }
            let accepted = format!("whole numbers from 0 to {}", levels - 1);
            return Err(FlockError::parameter("action", action, accepted));
        }
        if action.is_nan() {
            let accepted = "numbers; those beyond [-1, 1] are clipped";
            return Err(FlockError::parameter("action", action, accepted));
        }
        Ok(())
    }

    /// The rudder of a checked action, in [−1, 1].
    pub fn command(&self, action: f64) -> f64 {
        match self.levels {
            // Levels i and n - 1 - i are opposite to the bit: mirrored tasks stay the same task.
            Some(levels) => {
                let highest = (levels - 1) as f64;
                (2.0 * action - highest) / highest
            }
            None => action.clamp(-1.0, 1.0),
        }
    }

    /// The action whose command is nearest to a rudder in [−1, 1].
    pub fn action(&self, rudder: f64) -> f64 {
        match self.levels {
            Some(levels) => (0.5 * (rudder + 1.0) * (levels - 1) as f64).round(),
            None => rudder,
        }
    }

    /// The servo, prepared for control steps of this length.
    pub fn servo(&self, period_s: f64) -> Servo {
        Servo {
            follow: if self.lag_s > 0.0 {
                1.0 - libm::exp(-period_s / self.lag_s)
            } else {
                1.0
            },
            most: self
                .rate_per_s
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
