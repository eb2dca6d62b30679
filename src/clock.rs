//! The exact clock of a flock, and the number of steps in a duration.
//!
//! Time is counted in integer ticks of 1 ns, so that a substep can end exactly on a phase switch or a control step, and
//! rounding leaves no tiny step if the two coincide.

use crate::error::{FlockError, Result};

/// Ticks in a second.
pub(crate) const TICKS_PER_SECOND: f64 = 1e9;

/// A time or duration in ticks of 1 ns.
pub type Ticks = u64;

/// The nearest whole number of ticks to a duration in seconds (finite, non-negative).
pub fn ticks(seconds: f64) -> Ticks {
    (seconds * TICKS_PER_SECOND).round() as Ticks
}

/// Ticks as seconds.
pub fn seconds(ticks: Ticks) -> f64 {
    ticks as f64 / TICKS_PER_SECOND
}

/// Number of steps in a duration (s). The duration must be a whole number of steps.
///
/// `rate_hz` is the number of steps per second. `field` and `steps` name the duration and the steps in the message.
///
/// # Errors
/// [`FlockError::Parameter`] if `duration_s` is not a whole number of steps. It names the nearest durations that are.
pub fn whole_steps(field: &'static str, duration_s: f64, rate_hz: f64, steps: &str) -> Result<u32> {
    let refuse = |hint: String| {
        let accepted = format!("a whole number of {steps} of {} s{hint}", 1.0 / rate_hz);
        Err(FlockError::parameter(field, duration_s, accepted))
    };
    let count = duration_s * rate_hz;
    if !(count > 0.0 && count <= 1e9) {
        return refuse(", at most 1e9 of them".to_owned());
    }
    // A duration far below one step rounds to 0 steps, but is not a whole number of them.
    let rounded = count.round().max(1.0);
    if (count - rounded).abs() > 1e-9 * rounded {
        let [below_s, above_s] = [count.floor().max(1.0), count.ceil()].map(|n| n / rate_hz);
        return refuse(if below_s == above_s {
            format!(": {above_s} s is nearest")
        } else {
            format!(": {below_s} and {above_s} s are nearest")
        });
    }
    Ok(rounded as u32)
}
