//! Gaps between a hull and the walls of the pool. Walls are exact circles.

use super::{Gap, Hull, HullPose, cross, turned_left};

/// Gap between one end disc of a hull (`side` +1 bow, −1 stern) and the outer wall; the normal points
/// inward. A boat that lies flat on the wall touches with both ends.
pub fn outer_wall_gap(boat: &HullPose, side: f64, hull: Hull, outer_radius: f64) -> Gap {
    let end = boat.end(side, hull.half_length);
    let distance = end.norm_squared().sqrt();
    // At the pool's center every direction leads to the wall equally; the normal is along the axis.
    let normal = if distance > 0.0 {
        end * (-1.0 / distance)
    } else {
        -boat.axis
    };
    Gap {
        gap: outer_radius - hull.radius - distance,
        normal,
        along: side * hull.half_length,
        along_j: 0.0,
        arm_i: side * hull.half_length * cross(boat.axis, normal),
        arm_j: 0.0,
        bend: 0.0,
    }
}

/// Gap between a hull and the inner wall: distance from the pool's center to the core − r − R_in; the normal points
/// outward. If the hull's flank lies on the convex wall, turning it either way brings it into the wall.
pub fn inner_wall_gap(boat: &HullPose, hull: Hull, inner_radius: f64) -> Gap {
    let h = hull.half_length;
    let along = (-boat.center.dot(&boat.axis)).clamp(-h, h);
    let nearest = boat.center + boat.axis * along;
    let distance = nearest.norm_squared().sqrt();
    // If the core passes through the pool's center, the normal points to the side.
    let normal = if distance > 0.0 {
        nearest * (1.0 / distance)
    } else {
        turned_left(boat.axis)
    };
    Gap {
        gap: distance - hull.radius - inner_radius,
        normal,
        along,
        along_j: 0.0,
        arm_i: along * cross(boat.axis, normal),
        arm_j: 0.0,
        bend: if along.abs() < h { -distance } else { 0.0 },
    }
}
