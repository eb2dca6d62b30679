//! The lag of a real servo.

/// A servo that moves once per control step and holds the rudder in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Fraction of the difference to the command that a step closes.
    follow: f64,
    /// Largest change in a step.
    most: f64,
}

impl Servo {
    /// A servo with a time constant in s, and a fastest change in 1/s, for control steps of a length in s.
    pub fn new(lag_s: f64, rate_per_s: Option<f64>, step_s: f64) -> Self {
        Self {
            follow: if lag_s > 0.0 {
                1.0 - libm::exp(-step_s / lag_s)
            } else {
                1.0
            },
            most: rate_per_s.map_or(f64::INFINITY, |rate| rate * step_s),
        }
    }

    /// The rudder after the step's move.
    pub fn moved(&self, rudder: f64, command: f64) -> f64 {
        if self.follow == 1.0 && self.most >= 2.0 {
            return command;
        }
        let change = self.follow * (command - rudder);
        (rudder + change.clamp(-self.most, self.most)).clamp(-1.0, 1.0)
    }
}
