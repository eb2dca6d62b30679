//! Time in the cycle of phases.

use super::super::entry::{Entry, FLAG, Scale};
use super::super::view::FlockView;
use super::{Seen, WriteBlock};
use crate::clock::seconds;

/// Time in the cycle of phases.
#[rustfmt::skip]
pub(crate) const PHASE: [Entry; 6] = [
    Entry::new("fw", "", Scale::Plain, FLAG, "1 in the forward phase"),
    Entry::new("nop1", "", Scale::Plain, FLAG, "1 in the drift after it"),
    Entry::new("bw", "", Scale::Plain, FLAG, "1 in the backward phase"),
    Entry::new("nop2", "", Scale::Plain, FLAG, "1 in the drift after that"),
    Entry::new("time_left", "s", Scale::TimeLeft, (0.0, 2.0), "time until the phase ends"),
    Entry::new("bw_duration", "s", Scale::Second, (0.0, 4.0), "length of the backward phase, which sets the noise"),
];

/// Writes [`PHASE`].
#[derive(Debug, Clone, Default)]
pub(super) struct Phase;

impl WriteBlock for Phase {
    fn write(&mut self, seen: &Seen, _repeats: usize, physical: &mut Vec<f64>) {
        physical.extend(phase(seen.view));
    }
}

/// Time in the cycle of phases, in the order of [`PHASE`].
pub(crate) fn phase(view: &FlockView) -> [f64; PHASE.len()] {
    let mut entries = [0.0; PHASE.len()];
    entries[view.phase.phase.index()] = 1.0;
    entries[4] = seconds(view.phase.left);
    entries[5] = view.bw_s;
    entries
}
