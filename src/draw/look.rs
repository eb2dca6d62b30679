//! What a frame is to show of a flock.

use super::palette::Coloring;
use crate::flock::Flock;
use crate::parameters::Target;

/// How a frame shows a flock.
#[derive(Debug, Clone, Copy)]
pub struct Look<'a> {
    /// What the color of a boat shows.
    pub coloring: Coloring,
    /// What stands above the time, cut where it does not fit its corner; nothing if it is empty.
    pub caption: &'a str,
}

impl Default for Look<'_> {
    fn default() -> Self {
        Self {
            coloring: Coloring::Direction,
            caption: "",
        }
    }
}

/// Where all leaders head; `None` without leaders and where they head against each other.
pub(super) fn target_of(flock: &Flock) -> Option<Target> {
    let parameters = flock.parameters();
    (parameters.n_leaders > 0 && !parameters.target.are_opposed())
        .then(|| parameters.target.reference())
}
