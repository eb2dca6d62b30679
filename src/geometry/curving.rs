//! The second derivative of a gap in time, while its bodies keep their velocities.

use super::{Gap, Hull, HullPose, Velocity, turned_left};

/// A hull with its velocity.
pub type Moving<'a> = (&'a HullPose, &'a Velocity);

impl Gap {
    /// Second derivative of the gap in cm/s² while two hulls of one shape, or a hull at a round wall, keep their
    /// velocities. `distance` is that of the two cores in cm, or of the core from the wall's center, negative if the wall
    /// curves around the hull. The cores do not cross.
    ///
    /// Let r_i and r_j point from the centers to the touch on the cores, let d be the distance, u the speed of the first
    /// core's point relative to the second's along the tangent, and Ω the rate at which the normal n turns:
    /// gap″ = ω_j²·r_j·n − ω_i²·r_i·n + Ω·(2u − Ω·d). If a hull is touched at its flank, the normal turns with it;
    /// otherwise Ω = u/d.
    #[inline]
    pub fn second_derivative(
        &self,
        hull: Hull,
        distance: f64,
        first: Moving,
        second: Option<Moving>,
    ) -> f64 {
        let tangent = turned_left(self.normal);
        // One body's part of the speed along the tangent, and of the acceleration along the normal.
        let contribution = |(pose, velocity): Moving, along: f64| {
            let spin = velocity.angular;
            let offset = along * pose.axis.dot(&self.normal);
            let slide = tangent.dot(&velocity.linear) + spin * offset;
            (slide, -spin * spin * offset)
        };
        let (_, first_velocity) = first;
        let (mut slide, mut acceleration) = contribution(first, self.along);
        let is_flank = |along: f64| along.abs() < hull.half_length;
        let mut flank_spin = is_flank(self.along).then_some(first_velocity.angular);
        if let Some(second) = second {
            let (_, second_velocity) = second;
            let (second_slide, second_acceleration) = contribution(second, self.along_j);
            slide -= second_slide;
            acceleration -= second_acceleration;
            if is_flank(self.along_j) {
                flank_spin = Some(second_velocity.angular);
            }
        }
        let normal_spin = flank_spin.unwrap_or(slide / distance);
        acceleration + normal_spin * (2.0 * slide - normal_spin * distance)
    }
}
