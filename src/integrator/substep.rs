//! One substep, and the memory of the last one.

use super::phase_schedule::Phase;
use crate::clock::Ticks;
use crate::geometry::Vec2;

/// Source of the leaders' rudder commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Steering<'a> {
    /// The paper's law, eq. (10), at every substep.
    Law,
    /// Commands held over the substep, one per leader.
    Held(&'a [f64]),
}

/// One substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Substep<'a> {
    /// Time at its start.
    pub start: Ticks,
    /// Its length.
    pub length: Ticks,
    /// The phase of the motors.
    pub phase: Phase,
    /// The steering.
    pub steering: Steering<'a>,
}

/// The last substep, which leapfrog remembers because its second half belongs to the next kick.
/// Snapshots store the fields in this order.
#[derive(Debug, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct LastSubstep {
    /// Length of that substep; 0 if there was none since the state was set.
    pub length: Ticks,
    /// Index of its phase.
    pub phase: usize,
    /// The rudder commands held in it; `None` for the steering law.
    pub rudder: Option<Vec<f64>>,
    /// Linear acceleration of each boat by contacts that are likely to last; empty without such
    /// contacts.
    pub persistent_acceleration: Vec<Vec2>,
}

impl Clone for LastSubstep {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    // Every advance saves the state first, so this must not allocate.
    fn clone_from(&mut self, source: &Self) {
        self.length = source.length;
        self.phase = source.phase;
        self.rudder.clone_from(&source.rudder);
        self.persistent_acceleration
            .clone_from(&source.persistent_acceleration);
    }
}
