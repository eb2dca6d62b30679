//! The structure of a flock: clusters, jams, boats at the outer wall, and headings in world axes.

use crate::contact::{join, root};
use crate::geometry::lap_frame::orientation;
use crate::geometry::{Hull, HullPose, Pose, Vec2, outer_wall_gap, pair_gaps};
use crate::parameters::FlockParameters;
use std::f64::consts::PI;

/// Hulls touch if their gap is below this, in cm.
pub const IN_TOUCH_CM: f64 = 0.5;

/// The least number of boats in a jam.
pub const JAM_BOATS: usize = 3;

/// Largest angle in rad between a jammed boat's heading and the outward direction.
pub const JAM_ANGLE: f64 = PI / 3.0;

/// Fraction of the boats in the largest cluster; NaN without boats. Boats with a gap below [`IN_TOUCH_CM`] are in
/// the same cluster.
pub fn largest_cluster(poses: &[Pose], parameters: &FlockParameters) -> f64 {
    let largest = cluster_sizes(poses, parameters).into_iter().max();
    largest.unwrap_or(0) as f64 / poses.len() as f64
}

/// Sizes of the jams, in no particular order. A jam has at least [`JAM_BOATS`] boats that face outward within
/// [`JAM_ANGLE`] and are joined by gaps below [`IN_TOUCH_CM`].
pub fn jam_sizes(poses: &[Pose], parameters: &FlockParameters) -> Vec<usize> {
    let faces_outward = |pose: &&Pose| orientation(pose).abs() <= JAM_ANGLE;
    let outward_poses: Vec<Pose> = poses.iter().filter(faces_outward).copied().collect();
    let mut sizes = cluster_sizes(&outward_poses, parameters);
    sizes.retain(|&size| size >= JAM_BOATS);
    sizes
}

/// Sizes of the clusters of boats joined by gaps below [`IN_TOUCH_CM`], single boats included.
fn cluster_sizes(poses: &[Pose], parameters: &FlockParameters) -> Vec<usize> {
    let hull = Hull::new(parameters);
    let hulls: Vec<HullPose> = poses.iter().map(HullPose::new).collect();
    let mut parent: Vec<u32> = (0..hulls.len() as u32).collect();
    for (i, a) in (0..).zip(&hulls) {
        for (j, b) in (0..i).zip(&hulls) {
            let touch = |_, _| join(&mut parent, i, j);
            pair_gaps((a, hull), (b, hull), IN_TOUCH_CM, touch);
        }
    }
    let mut sizes = vec![0; hulls.len()];
    for boat in 0..hulls.len() as u32 {
        sizes[root(&mut parent, boat) as usize] += 1;
    }
    sizes.retain(|&size| size > 0);
    sizes
}

/// Fraction of the boats within [`IN_TOUCH_CM`] of the outer wall; NaN without boats.
pub fn on_outer_wall(poses: &[Pose], parameters: &FlockParameters) -> f64 {
    let hull = Hull::new(parameters);
    let radius = parameters.pool.outer_radius_cm;
    let at_wall = poses.iter().map(HullPose::new).filter(|boat| {
        [-1.0, 1.0]
            .iter()
            .any(|&side| outer_wall_gap(boat, side, hull, radius).gap < IN_TOUCH_CM)
    });
    at_wall.count() as f64 / poses.len() as f64
}

/// Length of the mean heading in world axes (Vicsek et al. 1995): 1 if all boats point the same way, about 0.886/√N for N
/// independent headings; NaN without boats.
pub fn polarization(poses: &[Pose]) -> f64 {
    let sum = poses
        .iter()
        .fold(Vec2::zeros(), |sum, pose| sum + HullPose::new(pose).axis);
    sum.norm() / poses.len() as f64
}
