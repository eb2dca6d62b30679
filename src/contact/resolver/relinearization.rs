//! Solves again where gaps are curved functions of the motion: until they hold at the substep's end.

use super::ContactResolver;
use crate::contact::{InverseInertia, Statistics};
use crate::geometry::{Pose, Velocity};
use crate::parameters::FlockParameters;

/// Relinearization passes after which a substep is taken as it is.
const MOST_PASSES: u32 = 20;

/// How far to go, with scratch space.
#[derive(Debug, Clone)]
pub(super) struct Relinearization {
    /// Overlap in cm at a substep's end at which to stop; `None`: off.
    pub(super) allowed_overlap: Option<f64>,
    /// Islands that overlap at the substep's end.
    overlapping: Vec<u32>,
    /// Contacts of one island that may close, and their gaps at the substep's end in cm.
    end_gaps: Vec<(u32, f64)>,
}

impl Relinearization {
    /// For checked parameters.
    pub(super) fn new(parameters: &FlockParameters) -> Self {
        let allowed = [None, Some(1e-6), Some(1e-9)];
        Self {
            allowed_overlap: allowed[parameters.relinearizations],
            overlapping: Vec::new(),
            end_gaps: Vec::new(),
        }
    }
}

impl ContactResolver {
    /// Solves islands again until no gap at the substep's end, evaluated where the last solve moves the boats, overlaps
    /// by more than `allowed`: with biases for which those gaps open to zero. The normals stay those of the substep's
    /// start, along which forces act, and so does the factor.
    pub(super) fn relinearize(
        &mut self,
        poses: &[Pose],
        free: &[Velocity],
        inertia: &[InverseInertia],
        dt: f64,
        allowed: f64,
        statistics: &mut Statistics,
    ) {
        let hull = self.detector.hull();
        self.trial.place(poses, &self.solver.velocities, dt, hull);
        let mut left = std::mem::take(&mut self.relinearization.overlapping);
        left.clear();
        left.extend(0..self.solver.islands().count() as u32);
        let left_over = 1.0 - dt / dt.max(self.whole_substep_s);
        let has_islands = self.solver.has_islands();
        let least = if has_islands {
            allowed
        } else {
            f64::NEG_INFINITY
        };
        for _ in 0..MOST_PASSES {
            let mut deepest = 0.0;
            left.retain(|&island| {
                let overlap = self.aim(island, dt, least, left_over);
                if overlap > deepest {
                    deepest = overlap;
                }
                overlap > least
            });
            if deepest <= allowed || !self.solve(Some(&left), free, inertia, statistics) {
                break;
            }
            if has_islands {
                let (contacts, solver) = (&self.contacts, &self.solver);
                let islands = left
                    .iter()
                    .map(|&island| solver.islands().contacts(island as usize));
                let velocities = &solver.velocities;
                self.trial
                    .move_islands(contacts, islands, poses, velocities, dt, hull);
            } else {
                self.trial.place(poses, &self.solver.velocities, dt, hull);
            }
        }
        self.relinearization.overlapping = left;
    }

    /// Sets the biases of an island so that its gaps at the substep's end open to zero, if one of them overlaps by more
    /// than `least`. What cannot close at these velocities keeps its bias. Returns the deepest overlap at the substep's
    /// end in cm. A shortened substep leaves its share `left_over` of an overlap from before, which does not count.
    fn aim(&mut self, island: u32, dt: f64, least: f64, left_over: f64) -> f64 {
        let velocities = &self.solver.velocities;
        let (mut deepest, mut pair) = (0.0, None);
        self.relinearization.end_gaps.clear();
        for &k in self.solver.islands().contacts(island as usize) {
            let contact = &self.contacts[k as usize];
            let gap = contact.gap.gap;
            if self.trial.may_close(contact) && gap >= -self.penetration_slop {
                let (detector, contacts) = (&self.detector, &self.contacts);
                let end_gap = self.trial.gap(detector, contacts, k as usize, &mut pair)
                    - left_over * gap.min(0.0);
                if -end_gap > deepest {
                    deepest = -end_gap;
                }
                self.relinearization.end_gaps.push((k, end_gap));
            }
        }
        // Elsewhere biases stay those that were solved for: whether contacts drive boats is judged by them.
        if deepest > least {
            for &(k, end_gap) in &self.relinearization.end_gaps {
                let rate = self.contacts[k as usize].gap_rate(velocities);
                self.biases[k as usize] = end_gap / dt - rate;
            }
        }
        deepest
    }
}
