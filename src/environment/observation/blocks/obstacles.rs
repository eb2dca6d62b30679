//! The obstacles nearest to leaders.

use super::super::entry::{Entry, FLAG, Scale};
use super::{FromParameters, LeaderView, WriteBlock};
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

/// Writes [`OBSTACLE`] for the nearest obstacles, nearest first.
#[derive(Debug, Clone)]
pub(super) struct NearestObstacles {
    hull: Hull,
    obstacles: Vec<Obstacle>,
}

impl FromParameters for NearestObstacles {
    fn from_parameters(parameters: &FlockParameters) -> Result<Self> {
        Ok(Self {
            hull: Hull::new(parameters),
            obstacles: Obstacle::all(parameters),
        })
    }
}

impl WriteBlock for NearestObstacles {
    /// Distances are from the leader's center; equally near obstacles come in the order of the parameters.
    fn write(&mut self, view: &LeaderView, repeats: usize, physical: &mut Vec<f64>) {
        let leader = &view.flock.hulls[view.leader];
        let end = physical.len() + repeats * OBSTACLE.len();
        let distances = self
            .obstacles
            .iter()
            .map(|obstacle| obstacle.distance(leader.center));
        let mut by_distance: Vec<_> = distances.zip(&self.obstacles).collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, obstacle) in by_distance.into_iter().take(repeats) {
            let to_nearest_point = obstacle.nearest(leader.center) - leader.center;
            let distance = view.frame.components(to_nearest_point);
            let mut smallest_gap = f64::INFINITY;
            obstacle.gaps(leader, self.hull, f64::INFINITY, &mut |_, contact| {
                smallest_gap = smallest_gap.min(contact.gap);
            });
            physical.extend([1.0, distance.x, distance.y, smallest_gap]);
        }
        physical.resize(end, 0.0);
    }
}
