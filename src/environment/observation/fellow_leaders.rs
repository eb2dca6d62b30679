//! The fellow leaders nearest to a leader, at any distance.

use super::entry::FELLOW_LEADER;
use super::view::FlockView;
use crate::geometry::{LapFrame, cross};

/// Finds fellow leaders, with its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct FellowLeaders {
    /// Squared distances of the other leaders, and their numbers.
    found: Vec<(f64, usize)>,
}

impl FellowLeaders {
    /// Adds the `wanted` leaders nearest to a leader by center distance in the order of [`FELLOW_LEADER`]: nearest
    /// first, equally near ones in the order of boats; zeros where there are fewer.
    pub(super) fn fill(
        &mut self,
        view: &FlockView,
        leader: usize,
        wanted: usize,
        physical: &mut Vec<f64>,
    ) {
        let filled = physical.len() + wanted * FELLOW_LEADER.len();
        let own = view.poses[leader].position;
        let outward = LapFrame::at(own).outward;
        let others = (0..view.leaders).filter(|&other| other != leader);
        let squares = others.map(|other| {
            let away = view.poses[other].position - own;
            (away.norm_squared(), other)
        });
        self.found.clear();
        self.found.extend(squares);
        self.found
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, other) in self.found.iter().take(wanted) {
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
