//! The lag of a real servo.

/// A servo that moves once per control step and holds the rudder in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Fraction of the difference between command and rudder by which the rudder moves in a step.
    fraction: f64,
    /// Largest change of the rudder in a step.
    largest_change: f64,
}

impl Servo {
    /// A servo with the time constant `lag_s` and the fastest change `rate_per_s` (`None`: no limit), for control steps
    /// of `step_s`.
    pub fn new(lag_s: f64, rate_per_s: Option<f64>, step_s: f64) -> Self {
        Self {
            fraction: if lag_s > 0.0 {
                1.0 - libm::exp(-step_s / lag_s)
            } else {
                1.0
            },
            largest_change: rate_per_s.map_or(f64::INFINITY, |rate| rate * step_s),
        }
    }

    /// The rudder at which a step towards `command` ends, if it starts at `rudder`.
    pub fn moved(&self, rudder: f64, command: f64) -> f64 {
        // From -1 to 1 is a change of 2. The early return spares an instant servo the rounding of the sum below.
        let is_instant = self.fraction == 1.0 && self.largest_change >= 2.0;
        if is_instant {
            return command;
        }
        let change = self.fraction * (command - rudder);
        let limited = change.clamp(-self.largest_change, self.largest_change);
        (rudder + limited).clamp(-1.0, 1.0)
    }
}
