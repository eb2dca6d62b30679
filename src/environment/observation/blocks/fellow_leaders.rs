//! The fellow leaders nearest to a leader, at any distance.

use super::super::entry::{Entry, FLAG, Scale, UNIT};
use super::{Seen, WriteBlock, nearest_first};
use crate::geometry::{LapFrame, cross};

/// One fellow leader; all zero where there are fewer than places.
#[rustfmt::skip]
pub(super) const FELLOW_LEADER: [Entry; 6] = [
    Entry::new("fellow", "", Scale::Plain, FLAG, "1 where there is such a leader"),
    Entry::new("cos_angle", "", Scale::Plain, UNIT, "cosine of the angle along the ring, at the pool's center, from the observing leader to it"),
    Entry::new("sin_angle", "", Scale::Plain, UNIT, "its sine: positive where it is clockwise").odd(),
    Entry::new("radial_distance", "cm", Scale::Length, (-4.0, 4.0), "how much farther than the observing leader it is from the pool's center"),
    Entry::new("cos_orientation", "", Scale::Plain, UNIT, "cosine of its LAP orientation, in its own LAP frame"),
    Entry::new("sin_orientation", "", Scale::Plain, UNIT, "its sine: 1 heads clockwise").odd(),
];

/// Writes [`FELLOW_LEADER`].
#[derive(Debug, Clone, Default)]
pub(super) struct FellowLeaders;

impl WriteBlock for FellowLeaders {
    /// Nearest by center distance first, equally near ones in the order of boats; zeros where there are fewer.
    fn write(&mut self, seen: &Seen, repeats: usize, physical: &mut Vec<f64>) {
        let (view, leader) = (seen.view, seen.leader);
        let filled = physical.len() + repeats * FELLOW_LEADER.len();
        let own = view.poses[leader].position;
        let outward = seen.frame.outward;
        let others = (0..view.leaders).filter(|&other| other != leader);
        let squares = others.map(|other| {
            let away = view.poses[other].position - own;
            (away.norm_squared(), other)
        });
        for other in nearest_first(squares, repeats) {
            let place = view.poses[other].position;
            let frame = LapFrame::at(place);
            let orientation = frame.components(view.hulls[other].axis);
            physical.extend([
                1.0,
                outward.dot(&frame.outward),
                -cross(outward, frame.outward),
                place.norm() - own.norm(),
                orientation.x,
                orientation.y,
            ]);
        }
        physical.resize(filled, 0.0);
    }
}
