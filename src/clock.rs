//! The exact clock of a flock.
//!
//! Time is counted in integer ticks of 1 ns, so that a substep can end exactly on a phase switch or
//! a control step, and no sliver of a step is left by rounding where the two meet.

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
