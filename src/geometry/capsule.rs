//! The hull of a boat: a segment swept by a disc (Section 5.1, figure 13).

use super::{Pose, Vec2};
use crate::parameters::FlockParameters;
use wide::f64x4;

/// The shape that all boats of a flock share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hull {
    /// Radius of the swept disc in cm.
    pub radius: f64,
    /// Half-length of the core segment in cm; 0 makes the hull a disc.
    pub half_length: f64,
}

impl Hull {
    /// The hull of checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        Self {
            radius: parameters.boat_radius_cm,
            half_length: parameters.half_length_cm(),
        }
    }

    /// Distance from the center to the farthest point of the hull.
    pub fn reach(&self) -> f64 {
        self.radius + self.half_length
    }

    /// Area in cm².
    pub fn area(&self) -> f64 {
        (std::f64::consts::PI * self.radius + 4.0 * self.half_length) * self.radius
    }
}

/// A pose with its direction vector worked out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HullPose {
    /// Center of the hull.
    pub center: Vec2,
    /// Unit vector along the heading.
    pub axis: Vec2,
}

impl HullPose {
    /// From a pose.
    #[inline]
    pub fn new(pose: &Pose) -> Self {
        let (sin, cos) = f64x4::splat(pose.heading).sin_cos();
        Self {
            center: pose.position,
            axis: Vec2::new(cos.as_array()[0], sin.as_array()[0]),
        }
    }

    /// Replaces `into` by the hulls at some poses, bit for bit those of [`Self::new`].
    ///
    /// Four headings at a time, which is faster; and the result does not depend on the machine's
    /// mathematical library.
    pub fn replace_all(into: &mut Vec<Self>, poses: &[Pose]) {
        into.clear();
        for four in poses.chunks(4) {
            let heading = |k: usize| four.get(k).map_or(0.0, |pose| pose.heading);
            let (sin, cos) = f64x4::new(std::array::from_fn(heading)).sin_cos();
            let axes = cos.as_array().iter().zip(sin.as_array());
            into.extend(four.iter().zip(axes).map(|(pose, (&cos, &sin))| Self {
                center: pose.position,
                axis: Vec2::new(cos, sin),
            }));
        }
    }

    /// The end of the core segment at the bow (`side` +1) or stern (−1).
    #[inline]
    pub fn end(&self, side: f64, half_length: f64) -> Vec2 {
        self.center + self.axis * (side * half_length)
    }
}
