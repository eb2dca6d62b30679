//! Poses, hulls, walls, obstacles and the distances between them.

mod annulus;
mod capsule;
mod curving;
mod gap;
pub mod lap_frame;
mod neighbors;
mod obstacle;
mod pose;

pub use annulus::{inner_wall_gap, outer_wall_gap};
pub use capsule::{Hull, HullPose, resized_gyration_radius_cm};
pub use curving::Moving;
pub(crate) use gap::{EndTouch, end_touches, smallest_gap};
pub use gap::{Feature, Gap, Placed, pair_gap, pair_gaps};
pub(crate) use lap_frame::LapFrame;
pub(crate) use neighbors::NeighborList;
pub use obstacle::Obstacle;
pub use pose::{Pose, Velocity, rms_distance};

/// A vector in the plane, in cm or cm/s.
pub type Vec2 = nalgebra::Vector2<f64>;

/// The out-of-plane component of a × b.
#[inline]
pub fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The vector rotated counter-clockwise by a quarter turn.
#[inline]
pub fn turned_left(a: Vec2) -> Vec2 {
    Vec2::new(-a.y, a.x)
}

/// An angle brought into (−π, π].
pub fn wrap_angle(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if angle > -PI && angle <= PI {
        return angle;
    }
    let wrapped = angle - TAU * ((angle - PI) / TAU).ceil();
    // Rounding may leave the result one ulp outside.
    if wrapped <= -PI {
        wrapped + TAU
    } else {
        wrapped.min(PI)
    }
}

/// The smaller of two numbers. `f64::min` also checks for NaN, which takes twice as long.
#[inline]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}
