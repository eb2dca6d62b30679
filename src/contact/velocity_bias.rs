//! The velocity bias of a contact: the largest speed at which its gap may close.

use crate::geometry::Gap;
use std::hint::select_unpredictable;

/// Computes velocity biases, in cm/s. A positive bias is the largest speed at which a gap may close, so that an open gap
/// closes just to zero in one substep. A negative bias makes an overlap open at a certain speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct VelocityBias {
    /// Length of the substep in s.
    pub dt: f64,
    /// Time in s within which an overlap has to open. A substep that a phase or control step cuts to 1 ns
    /// would otherwise open it at an enormous speed.
    pub closing_s: f64,
    /// Overlaps beyond this (cm) are undone by moving poses, so their bias is zero.
    pub penetration_slop: f64,
}

impl VelocityBias {
    /// The bias from the present gap.
    pub(super) fn for_gap(&self, gap: &Gap) -> f64 {
        // Without branches, since the signs of gaps are unpredictable.
        let time = select_unpredictable(gap.gap < 0.0, self.closing_s, self.dt);
        let is_deep = gap.gap < -self.penetration_slop;
        select_unpredictable(is_deep, 0.0, gap.gap / time)
    }

    /// The part of the bias that accounts for a gap's curving within the substep, from its second derivative in cm/s².
    pub(super) fn for_curve(&self, gap: &Gap, second_derivative: f64) -> f64 {
        if gap.gap < -self.penetration_slop {
            0.0
        } else {
            0.5 * self.dt * second_derivative
        }
    }

    /// The part of the bias that accounts for a flank's turning into a convex wall with this spin, in rad/s.
    pub(super) fn for_flank(&self, gap: &Gap, spin: f64) -> f64 {
        self.for_curve(gap, gap.bend * spin * spin)
    }
}
