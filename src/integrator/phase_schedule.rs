//! The fw-nop-bw-nop cycle that all motors follow.

use crate::clock::{Ticks, ticks};
use crate::parameters::{FlockParameters, named_choice};

named_choice! {
    /// Phase of the motors.
    pub enum Phase ("phase") {
        /// Forward.
        Forward = "fw",
        /// Drifting after the forward phase.
        DriftAfterForward = "nop1",
        /// Backward: rotation, the source of disorder.
        Backward = "bw",
        /// Drifting after the backward phase.
        DriftAfterBackward = "nop2",
    }
}

impl Phase {
    /// 0 to 3 in the order fw, nop1, bw, nop2.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Whether a time lies in the analysis window: the second half of fw and the first half of the drift after it (Section
    /// 4). `elapsed` is the time since the phase started, `left` the time until it ends.
    fn is_analyzed<T: PartialOrd>(self, elapsed: T, left: T) -> bool {
        match self {
            Self::Forward => elapsed >= left,
            Self::DriftAfterForward => elapsed < left,
            Self::Backward | Self::DriftAfterBackward => false,
        }
    }
}

/// Whether each of some increasing times in s lies in the analysis window. `phases` holds the phase at each time. A phase
/// lasts until the first time of the next one, the last phase until the last time.
pub fn sampled_analysis_window(times_s: &[f64], phases: &[Phase]) -> Vec<bool> {
    let mut analyzed = Vec::with_capacity(times_s.len());
    for same_phase in phases.chunk_by(|a, b| a == b) {
        let start = analyzed.len();
        let end = start + same_phase.len();
        let (start_s, end_s) = (times_s[start], times_s[end.min(times_s.len() - 1)]);
        let is_analyzed = |time: &f64| same_phase[0].is_analyzed(time - start_s, end_s - time);
        analyzed.extend(times_s[start..end].iter().map(is_analyzed));
    }
    analyzed
}

/// Phase at a time, with the time since it started and the time until the next switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PhaseMoment {
    /// The phase that holds from this time on.
    pub phase: Phase,
    /// Time since the phase started.
    pub elapsed: Ticks,
    /// Time until the next switch.
    pub left: Ticks,
}

/// The repeating cycle [fw nop1 bw nop2]; phases of length 0 do not occur.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhaseSchedule {
    durations: [Ticks; 4],
    cycle: Ticks,
}

impl PhaseSchedule {
    /// The cycle of checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        let p = parameters;
        let durations = [p.fw_s, p.nop1_s, p.bw_s, p.nop2_s].map(ticks);
        Self {
            durations,
            cycle: durations.iter().sum(),
        }
    }

    /// Length of a whole cycle.
    pub fn cycle(&self) -> Ticks {
        self.cycle
    }

    /// Length of one phase.
    pub fn duration(&self, phase: Phase) -> Ticks {
        self.durations[phase.index()]
    }

    /// The phase at a time; a switch belongs to the phase that starts there.
    pub fn at(&self, time: Ticks) -> PhaseMoment {
        let mut elapsed = time % self.cycle;
        for &phase in Phase::ALL {
            let duration = self.durations[phase.index()];
            if elapsed < duration {
                return PhaseMoment {
                    phase,
                    elapsed,
                    left: duration - elapsed,
                };
            }
            elapsed -= duration;
        }
        unreachable!("elapsed < cycle, the sum of the durations")
    }

    /// Whether a time lies in the analysis window: the second half of fw and the first half of the
    /// drift after it (Section 4).
    pub fn in_analysis_window(&self, time: Ticks) -> bool {
        let moment = self.at(time);
        moment.phase.is_analyzed(moment.elapsed, moment.left)
    }
}
