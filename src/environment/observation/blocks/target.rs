//! The direction to lead in.

use super::super::entry::{Entry, Scale, UNIT};
use super::{LeaderView, WriteBlock};

/// The direction to lead in.
#[rustfmt::skip]
pub(crate) const TARGET: [Entry; 1] = [
    Entry::new("target", "", Scale::Plain, UNIT, "+1 clockwise, -1 counter-clockwise").odd(),
];

/// Writes [`TARGET`].
#[derive(Debug, Clone, Default)]
pub(super) struct Target;

impl WriteBlock for Target {
    fn write(&mut self, view: &LeaderView, _repeats: usize, physical: &mut Vec<f64>) {
        physical.push(view.flock.targets.of(view.leader).sign());
    }
}
