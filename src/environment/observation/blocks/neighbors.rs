//! The nearest boats.

use super::super::entry::{Entry, FLAG, Scale, TWICE, UNIT};
use super::super::nearest::Nearest;
use super::{LeaderView, WriteBlock};
use crate::geometry::cross;

/// One neighbor; zeros for neighbors that the flock lacks.
#[rustfmt::skip]
pub(super) const NEIGHBOR: [Entry; 8] = [
    Entry::new("present", "", Scale::Plain, FLAG, "1 if there is such a neighbor"),
    Entry::new("outward_distance", "cm", Scale::Length, (-4.0, 4.0), "its center, seen from the leader along the leader's outward axis"),
    Entry::new("clockwise_distance", "cm", Scale::Length, (-4.0, 4.0), "the same along the leader's clockwise axis").odd(),
    Entry::new("cos_relative_heading", "", Scale::Plain, UNIT, "cosine of the angle between the headings"),
    Entry::new("sin_relative_heading", "", Scale::Plain, UNIT, "its sine: positive where the neighbor heads clockwise of the leader").odd(),
    Entry::new("outward_velocity", "cm/s", Scale::Speed, TWICE, "its velocity along the leader's outward axis"),
    Entry::new("clockwise_velocity", "cm/s", Scale::Speed, TWICE, "its velocity along the leader's clockwise axis").odd(),
    Entry::new("is_leader", "", Scale::Plain, FLAG, "1 for a leader"),
];

/// Writes [`NEIGHBOR`] for the nearest boats, nearest first.
#[derive(Debug, Clone, Default)]
pub(super) struct Neighbors(Nearest);

impl WriteBlock for Neighbors {
    fn write(&mut self, view: &LeaderView, repeats: usize, physical: &mut Vec<f64>) {
        let flock = view.flock;
        let leader = &flock.hulls[view.leader];
        let end = physical.len() + repeats * NEIGHBOR.len();
        for boat in self.0.of_leader(flock.hulls, view.leader, repeats) {
            let neighbor = &flock.hulls[boat];
            let distance = view.frame.components(neighbor.center - leader.center);
            let velocity = view.frame.components(flock.velocities[boat].linear);
            physical.extend([
                1.0,
                distance.x,
                distance.y,
                leader.axis.dot(&neighbor.axis),
                -cross(leader.axis, neighbor.axis),
                velocity.x,
                velocity.y,
                f64::from(u8::from(boat < flock.leaders)),
            ]);
        }
        physical.resize(end, 0.0);
    }
}
