//! The obstacles nearest to leaders.

use super::entry::OBSTACLE;
use crate::geometry::{Hull, HullPose, LapFrame, Obstacle};
use crate::parameters::FlockParameters;

/// Finds the nearest obstacles, with its memory.
#[derive(Debug, Clone)]
pub(super) struct NearestObstacles {
    hull: Hull,
    obstacles: Vec<Obstacle>,
    /// Obstacles and their distances from a leader's center.
    found: Vec<(f64, usize)>,
}

impl NearestObstacles {
    /// For checked parameters.
    pub(super) fn new(parameters: &FlockParameters) -> Self {
        Self {
            hull: Hull::new(parameters),
            obstacles: Obstacle::all(parameters),
            found: Vec::new(),
        }
    }

    /// Adds the `wanted` obstacles nearest to a leader's center in the order of [`OBSTACLE`]: nearest first, equally
    /// near ones in the order of obstacles; zeros where there are fewer.
    pub(super) fn fill(
        &mut self,
        leader: &HullPose,
        frame: &LapFrame,
        wanted: usize,
        physical: &mut Vec<f64>,
    ) {
        let filled = physical.len() + wanted * OBSTACLE.len();
        let obstacles = self.obstacles.iter().enumerate();
        let distances = obstacles.map(|(number, each)| (each.distance(leader.center), number));
        self.found.clear();
        self.found.extend(distances);
        self.found
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, number) in self.found.iter().take(wanted) {
            let obstacle = &self.obstacles[number];
            let nearest = obstacle.nearest(leader.center) - leader.center;
            let distance = frame.components(nearest);
            let mut gap = f64::INFINITY;
            obstacle.gaps(leader, self.hull, f64::INFINITY, &mut |_, found| {
                gap = gap.min(found.gap);
            });
            physical.extend([1.0, distance.x, distance.y, gap]);
        }
        physical.resize(filled, 0.0);
    }
}
