//! The obstacles nearest to leaders.

use super::super::entry::{Entry, FLAG, Scale};
use super::{MadeFor, Seen, WriteBlock};
use crate::error::Result;
use crate::geometry::{Hull, Obstacle};
use crate::parameters::FlockParameters;

/// One obstacle; zeros for obstacles that the pool lacks.
#[rustfmt::skip]
pub(super) const OBSTACLE: [Entry; 4] = [
    Entry::new("present", "", Scale::Plain, FLAG, "1 if there is such an obstacle"),
    Entry::new("outward_distance", "cm", Scale::Length, (-4.0, 4.0), "its nearest point, seen from the leader's center along the leader's outward axis"),
    Entry::new("clockwise_distance", "cm", Scale::Length, (-4.0, 4.0), "the same along the leader's clockwise axis").odd(),
    Entry::new("gap", "cm", Scale::Length, (-1.0, 4.0), "distance between the leader's hull and the obstacle, negative for overlap"),
];

/// Finds the nearest obstacles.
#[derive(Debug, Clone)]
pub(super) struct NearestObstacles {
    hull: Hull,
    obstacles: Vec<Obstacle>,
}

impl MadeFor for NearestObstacles {
    fn made_for(parameters: &FlockParameters) -> Result<Self> {
        Ok(Self {
            hull: Hull::new(parameters),
            obstacles: Obstacle::all(parameters),
        })
    }
}

impl WriteBlock for NearestObstacles {
    /// Nearest to the leader's center first, equally near ones in the order of obstacles; zeros for missing ones.
    fn write(&mut self, seen: &Seen, repeats: usize, physical: &mut Vec<f64>) {
        let leader = &seen.view.hulls[seen.leader];
        let filled = physical.len() + repeats * OBSTACLE.len();
        let distances = self
            .obstacles
            .iter()
            .map(|obstacle| obstacle.distance(leader.center));
        let mut found: Vec<_> = distances.zip(&self.obstacles).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, obstacle) in found.into_iter().take(repeats) {
            let nearest = obstacle.nearest(leader.center) - leader.center;
            let distance = seen.frame.components(nearest);
            let mut gap = f64::INFINITY;
            obstacle.gaps(leader, self.hull, f64::INFINITY, &mut |_, found| {
                gap = gap.min(found.gap);
            });
            physical.extend([1.0, distance.x, distance.y, gap]);
        }
        physical.resize(filled, 0.0);
    }
}
