//! A flock as it is observed, and the scaling of physical values to observed numbers.

use super::entry::Entry;
use crate::analysis::OrderParameters;
use crate::flock::Flock;
use crate::geometry::{HullPose, Pose, Velocity};
use crate::integrator::PhaseMoment;
use crate::parameters::{FlockParameters, Targets};

/// Everything that an observation depends on.
#[derive(Debug, Clone, Copy)]
pub struct FlockView<'a> {
    /// Poses of all boats, leaders first.
    pub poses: &'a [Pose],
    /// The same poses with their direction vectors.
    pub hulls: &'a [HullPose],
    /// Velocities of all boats, leaders first.
    pub velocities: &'a [Velocity],
    /// Number of leaders.
    pub leaders: usize,
    /// Time in the cycle of phases.
    pub phase: PhaseMoment,
    /// Length of the backward phase in s.
    pub bw_s: f64,
    /// The leaders' targets: the directions to lead in.
    pub targets: &'a Targets,
    /// The leaders' present rudders, positive counter-clockwise.
    pub rudders: &'a [f64],
    /// Order parameters of the normal boats; `None` if there are none.
    pub order: Option<&'a OrderParameters>,
}

impl<'a> FlockView<'a> {
    /// The view of a flock without a camera. `rudders` are the leaders' present rudders, `order` the order parameters of
    /// the normal boats.
    pub fn new(flock: &'a Flock, rudders: &'a [f64], order: Option<&'a OrderParameters>) -> Self {
        let parameters = flock.parameters();
        Self {
            poses: flock.poses(),
            hulls: flock.hulls(),
            velocities: flock.velocities(),
            leaders: parameters.n_leaders,
            phase: flock.phase(),
            bw_s: parameters.bw_s,
            targets: &parameters.target,
            rudders,
            order,
        }
    }
}

/// Scaling of a row of physical values to observed numbers: gain·value + offset, clipped at the bounds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scaling {
    /// The gains without mirroring, then with mirroring.
    gains: [Vec<f64>; 2],
    offsets: Vec<f64>,
    lows: Vec<f64>,
    highs: Vec<f64>,
}

impl Scaling {
    /// The scaling of these entries for flocks with these parameters.
    pub(super) fn new(entries: impl Iterator<Item = Entry>, parameters: &FlockParameters) -> Self {
        let mut scaling = Self {
            gains: [Vec::new(), Vec::new()],
            offsets: Vec::new(),
            lows: Vec::new(),
            highs: Vec::new(),
        };
        for entry in entries {
            let (gain, offset) = entry.scale.affine(parameters);
            scaling.gains[0].push(gain);
            scaling.gains[1].push(if entry.mirrored { -gain } else { gain });
            scaling.offsets.push(offset);
            scaling.lows.push(entry.low);
            scaling.highs.push(entry.high);
        }
        scaling
    }

    /// Number of entries.
    pub(super) fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Writes scaled and clipped numbers; returns how many were clipped.
    pub(super) fn write(&self, physical: &[f64], is_mirrored: bool, out: &mut [f32]) -> u32 {
        // Slices of equal length spare the loop its bounds checks.
        let n = self.len();
        let gains = &self.gains[usize::from(is_mirrored)][..n];
        let (offsets, lows, highs) = (&self.offsets[..n], &self.lows[..n], &self.highs[..n]);
        let (physical, out) = (&physical[..n], &mut out[..n]);
        let mut clipped_count = 0;
        for i in 0..n {
            let scaled = gains[i] * physical[i] + offsets[i];
            // NaN becomes the lower bound.
            let at_least_low = if scaled > lows[i] { scaled } else { lows[i] };
            let clipped = if at_least_low < highs[i] {
                at_least_low
            } else {
                highs[i]
            };
            clipped_count += u32::from(clipped != scaled);
            out[i] = clipped as f32;
        }
        clipped_count
    }
}
