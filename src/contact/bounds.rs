//! How fast gaps may close: what turns the geometry of a contact into a bound on velocities.

use crate::geometry::Gap;

/// How fast gaps may close in one substep.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Length of the substep in s.
    pub dt: f64,
    /// What an overlap has to close in, in s: a substep that a phase or control step cuts to 1 ns would
    /// close it at any speed.
    pub closing_s: f64,
    /// Gaps below this (cm, negative) are recovered by displacement; what that could not undo must not push.
    pub deep: f64,
}

impl Pace {
    /// The bound that follows from the gap at hand, in cm/s.
    pub fn bound(&self, gap: &Gap) -> f64 {
        match gap.gap {
            gap if gap < self.deep => 0.0,
            gap if gap < 0.0 => gap / self.closing_s,
            gap => gap / self.dt,
        }
    }

    /// What turning a flank into the inner wall, with this spin, takes off the bound.
    pub fn flank(&self, gap: &Gap, spin: f64) -> f64 {
        if gap.gap < self.deep {
            0.0
        } else {
            0.5 * gap.bend * self.dt * spin * spin
        }
    }
}
