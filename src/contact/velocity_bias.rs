//! The velocity bias of a contact: how fast its gap may close.

use crate::geometry::Gap;
use std::hint::select_unpredictable;

/// The largest closing rate of a gap in one substep: an open gap may close just to zero, and an overlap has
/// to open at a certain speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct VelocityBias {
    /// Length of the substep in s.
    pub dt: f64,
    /// Time in s within which an overlap has to open. A substep that a phase or control step cuts to 1 ns
    /// would otherwise open it at an enormous speed.
    pub closing_s: f64,
    /// Overlaps beyond this (cm) are undone by moving poses; the rest must not push.
    pub penetration_slop: f64,
}

impl VelocityBias {
    /// The bias from the present gap, in cm/s.
    pub(super) fn of_gap(&self, gap: &Gap) -> f64 {
        // Without branches, since the signs of gaps are unpredictable.
        let time = select_unpredictable(gap.gap < 0.0, self.closing_s, self.dt);
        let is_deep = gap.gap < -self.penetration_slop;
        select_unpredictable(is_deep, 0.0, gap.gap / time)
    }

    /// Part of the bias by which a gap curves within the substep, from its second derivative in cm/s².
    pub(super) fn of_curve(&self, gap: &Gap, second_derivative: f64) -> f64 {
        if gap.gap < -self.penetration_slop {
            0.0
        } else {
            0.5 * self.dt * second_derivative
        }
    }

    /// Part of the bias that a flank loses by turning into the inner wall with this spin.
    pub(super) fn of_flank(&self, gap: &Gap, spin: f64) -> f64 {
        self.of_curve(gap, gap.bend * spin * spin)
    }
}
