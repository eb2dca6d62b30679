//! The look of a frame.

use super::palette::Coloring;
use crate::flock::Flock;
use crate::parameters::Target;

/// The look of a flock in a frame.
#[derive(Debug, Clone, Copy)]
pub struct Look<'a> {
    /// Meaning of a boat's color.
    pub coloring: Coloring,
    /// Title above the time, shortened to fit its corner; empty: no title.
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

/// Common target of all leaders; `None` without leaders or if their targets differ.
pub(super) fn target_of(flock: &Flock) -> Option<Target> {
    let parameters = flock.parameters();
    (parameters.n_leaders > 0 && !parameters.target.are_opposed())
        .then(|| parameters.target.reference())
}
