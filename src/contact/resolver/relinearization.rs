//! Solves again if gaps are curved functions of the motion, until no gap overlaps at the substep's end.

use super::{ContactResolver, Motion, Solution};
use crate::contact::Statistics;
use crate::parameters::FlockParameters;
use std::hint::select_unpredictable;

/// Relinearization passes after which a substep counts as not solved.
const MOST_PASSES: u32 = 20;

/// Settings of relinearization, with scratch space.
#[derive(Debug, Clone)]
pub(super) struct Relinearization {
    /// Deepest overlap in cm that a substep may leave; infinite: gaps are linearized once.
    pub(super) tolerance: f64,
    /// Islands that overlap at the substep's end.
    overlapping: Vec<u32>,
    /// Their contacts that may close, and the gaps of these at the substep's end in cm.
    end_gaps: Vec<(u32, f64)>,
}

impl Relinearization {
    /// Settings from checked parameters.
    pub(super) fn new(parameters: &FlockParameters) -> Self {
        Self {
            tolerance: parameters.allowed_overlap_cm(),
            overlapping: Vec::new(),
            end_gaps: Vec::new(),
        }
    }

    /// Whether gaps are evaluated at the predicted poses.
    pub(super) fn is_on(&self) -> bool {
        self.tolerance < f64::INFINITY
    }
}

impl ContactResolver {
    /// Solves islands again until no gap at the substep's end overlaps by more than the tolerance. The gaps are
    /// evaluated where the last solve moves the boats, and the next solve has biases for which they open to zero. The
    /// normals, along which forces act, and the factor stay those of the substep's start. `first` is the outcome of the
    /// first solve.
    pub(super) fn relinearize(
        &mut self,
        motion: &Motion,
        first: Solution,
        statistics: &mut Statistics,
    ) -> Solution {
        let dt = motion.dt;
        self.predict(motion);
        let mut left = std::mem::take(&mut self.relinearization.overlapping);
        left.clear();
        left.extend(0..self.solver.islands().count() as u32);
        let (mut solution, mut passes) = (first, 0);
        while self.is_overlapping(&mut left, dt) {
            if passes == MOST_PASSES || solution != Solution::Solved {
                solution = Solution::Overlapping;
                break;
            }
            passes += 1;
            self.aim_at_end_gaps(dt);
            solution = self.solve(Some(&left), motion, statistics);
            match solution {
                Solution::Exhausted => break,
                Solution::Solved if self.solver.has_islands() => self.predict_again(&left, motion),
                _ => self.predict(motion),
            }
        }
        self.relinearization.overlapping = left;
        solution
    }

    /// Computes biases for which the gaps noted at the substep's end open to zero.
    fn aim_at_end_gaps(&mut self, dt: f64) {
        for &(k, end_gap) in &self.relinearization.end_gaps {
            let rate = self.contacts[k as usize].gap_rate(&self.solver.velocities);
            self.biases[k as usize] = end_gap / dt - rate;
        }
    }

    /// Predicts where the last solve moves all boats.
    fn predict(&mut self, motion: &Motion) {
        let (velocities, hull) = (&self.solver.velocities, self.detector.hull());
        self.predicted
            .predict(motion.poses, velocities, motion.dt, hull);
    }

    /// Predicts where the last solve moves the boats of some islands; the others stay where they are predicted.
    fn predict_again(&mut self, islands: &[u32], motion: &Motion) {
        let (velocities, hull) = (&self.solver.velocities, self.detector.hull());
        let found = self.solver.islands();
        let islands = islands
            .iter()
            .map(|&island| found.contacts(island as usize));
        let contacts = &self.contacts;
        self.predicted
            .move_islands(contacts, islands, motion.poses, velocities, motion.dt, hull);
    }

    /// Whether the last solve leaves overlaps deeper than the tolerance.
    pub(super) fn leaves_overlaps(&mut self, motion: &Motion) -> bool {
        self.predict(motion);
        let mut islands = (0..self.solver.islands().count() as u32).collect();
        self.is_overlapping(&mut islands, motion.dt)
    }

    /// Whether gaps at the substep's end overlap by more than the tolerance. Removes the other islands from `islands`
    /// and their gaps from the list; a solver without islands keeps all.
    fn is_overlapping(&mut self, islands: &mut Vec<u32>, dt: f64) -> bool {
        let tolerance = self.relinearization.tolerance;
        let left_over = 1.0 - dt / dt.max(self.whole_substep_s);
        let has_islands = self.solver.has_islands();
        let mut deepest = 0.0;
        self.relinearization.end_gaps.clear();
        islands.retain(|&island| {
            let before = self.relinearization.end_gaps.len();
            let overlap = self.deepest_end_overlap(island, left_over);
            if overlap > deepest {
                deepest = overlap;
            }
            let stays = overlap > tolerance || !has_islands;
            if !stays {
                // No new biases for this island: the check for driven boats needs those that it was solved with.
                self.relinearization.end_gaps.truncate(before);
            }
            stays
        });
        deepest > tolerance
    }

    /// Notes the gaps of an island at the substep's end, except for contacts that cannot close at these velocities or
    /// whose touch is gone. Returns the deepest overlap in cm. A shortened substep need not close an earlier overlap
    /// fully: it may leave the fraction `left_over` of it.
    fn deepest_end_overlap(&mut self, island: u32, left_over: f64) -> f64 {
        let (mut deepest, mut pair) = (0.0, None);
        for &k in self.solver.islands().contacts(island as usize) {
            let contact = &self.contacts[k as usize];
            let gap = contact.gap.gap.min(0.0);
            if gap >= -self.penetration_slop && self.predicted.may_close(&self.contacts, k as usize)
            {
                let (detector, contacts) = (&self.detector, &self.contacts);
                let end_gap = self
                    .predicted
                    .gap(detector, contacts, k as usize, &mut pair);
                let is_deep = gap < -self.relinearization.tolerance;
                let overlap = select_unpredictable(is_deep, left_over * gap, 0.0) - end_gap;
                if overlap > deepest {
                    deepest = overlap;
                }
                if end_gap < f64::INFINITY {
                    let aim = end_gap - left_over * gap;
                    self.relinearization.end_gaps.push((k, aim));
                }
            }
        }
        deepest
    }
}
