//! Time in the cycle of phases.

use super::super::entry::{Entry, FLAG, Scale};
use super::super::view::FlockView;
use super::{LeaderView, WriteBlock};
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
    fn write(&mut self, view: &LeaderView, _repeats: usize, physical: &mut Vec<f64>) {
        physical.extend(phase_values(view.flock));
    }
}

/// The physical values of [`PHASE`].
pub(crate) fn phase_values(view: &FlockView) -> [f64; PHASE.len()] {
    let mut is_phase = [0.0; 4];
    is_phase[view.phase.phase.index()] = 1.0;
    let [fw, nop1, bw, nop2] = is_phase;
    [fw, nop1, bw, nop2, seconds(view.phase.left), view.bw_s]
}
