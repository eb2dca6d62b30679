//! Repeats solves, since gaps are curved functions of the motion, until no gap overlaps at the substep's end.

use super::solution::Solution;
use super::{ContactResolver, Motion};
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
    /// Whether the first solve of the last substep left overlaps. Then the first solve of the next
    /// substep probably does, too.
    had_overlaps: bool,
    /// Islands that overlap at the substep's end.
    overlapping: Vec<u32>,
    /// For each contact, its gap at the substep's end in cm, plus the overlap that a shortened substep may leave. Infinite
    /// if the overlap is beyond the slop, the gap cannot close, or the touch is gone. Valid only in islands that the last
    /// check visited.
    end_gaps: Vec<f64>,
}

impl Relinearization {
    /// Settings from checked parameters.
    pub(super) fn new(parameters: &FlockParameters) -> Self {
        Self {
            tolerance: parameters.allowed_overlap_cm(),
            had_overlaps: false,
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
    /// Solves islands again until no gap at the substep's end overlaps by more than the tolerance, a solve fails, or
    /// [`MOST_PASSES`] are done. Each pass evaluates gaps at the poses to which the last solve moves the boats, and chooses
    /// biases with which these gaps would not end below zero. The factor and the normals, along which forces act, stay
    /// those of the substep's start. `first` is the outcome of the first solve.
    pub(super) fn relinearize(
        &mut self,
        motion: &Motion,
        first: Solution,
        statistics: &mut Statistics,
    ) -> Solution {
        let dt = motion.dt;
        self.predict(motion);
        if first == Solution::Solved && !self.may_overlap(dt) {
            return first;
        }
        let mut overlapping = std::mem::take(&mut self.relinearization.overlapping);
        overlapping.clear();
        overlapping.extend(0..self.solver.islands().count() as u32);
        let (mut solution, mut passes) = (first, 0);
        while self.is_overlapping(&mut overlapping, dt) {
            if passes == MOST_PASSES || solution != Solution::Solved {
                solution = Solution::Overlapping;
                break;
            }
            passes += 1;
            self.correct_biases(&overlapping, dt);
            solution = self.solve(Some(&overlapping), motion, statistics);
            match solution {
                Solution::Exhausted => break,
                Solution::Solved if self.solver.has_islands() => {
                    self.predict_again(&overlapping, motion);
                }
                _ => self.predict(motion),
            }
        }
        self.relinearization.overlapping = overlapping;
        self.relinearization.had_overlaps = passes > 0 || solution != Solution::Solved;
        solution
    }

    /// Whether the first solve may leave overlaps deeper than the tolerance; true for shortened substeps. Checking all
    /// contacts at once takes less time than checking island by island. `had_overlaps` skips this check without changing
    /// results, because the check is slightly stricter than that by island, whatever rounding does.
    fn may_overlap(&self, dt: f64) -> bool {
        let is_whole = dt >= self.whole_substep_s;
        let allowed = (1.0 - 1e-9) * self.relinearization.tolerance;
        !is_whole
            || self.relinearization.had_overlaps
            || self
                .predicted
                .closing_overlaps(&self.detector, &self.contacts, allowed)
    }

    /// Computes biases with which the gaps of these islands would not end the substep below zero, or below what a
    /// shortened substep may leave. The other islands keep the biases with which they were solved: the check for added
    /// energy needs those.
    fn correct_biases(&mut self, islands: &[u32], dt: f64) {
        let all_islands = self.solver.islands();
        let contacts = islands
            .iter()
            .flat_map(|&island| all_islands.contacts(island as usize));
        for &k in contacts {
            let (k, end_gap) = (k as usize, self.relinearization.end_gaps[k as usize]);
            if end_gap < f64::INFINITY {
                let rate = self.contacts[k].gap_rate(&self.solver.velocities);
                self.biases[k] = end_gap / dt - rate;
            }
        }
    }

    /// Predicts the poses to which the last solve moves all boats.
    fn predict(&mut self, motion: &Motion) {
        let (velocities, hull) = (&self.solver.velocities, self.detector.hull());
        self.predicted
            .predict(motion.poses, velocities, motion.dt, hull);
    }

    /// Predicts the poses to which the last solve moves the boats of these islands; the others keep their predicted poses.
    fn predict_again(&mut self, islands: &[u32], motion: &Motion) {
        let (velocities, hull) = (&self.solver.velocities, self.detector.hull());
        let all_islands = self.solver.islands();
        let islands = islands
            .iter()
            .map(|&island| all_islands.contacts(island as usize));
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

    /// Whether gaps of these islands overlap by more than the tolerance at the substep's end. Keeps only the overlapping
    /// islands in `islands`, or all for a solver without islands.
    fn is_overlapping(&mut self, islands: &mut Vec<u32>, dt: f64) -> bool {
        let tolerance = self.relinearization.tolerance;
        let left_fraction = 1.0 - dt / dt.max(self.whole_substep_s);
        let has_islands = self.solver.has_islands();
        let mut end_gaps = std::mem::take(&mut self.relinearization.end_gaps);
        end_gaps.resize(self.contacts.len(), f64::INFINITY);
        let (mut deepest, mut kept) = (0.0, 0);
        // Not `Vec::retain`: its closure call for each island would take long, since most islands are a single contact.
        for index in 0..islands.len() {
            let island = islands[index];
            let overlap = self.deepest_end_overlap(island, left_fraction, &mut end_gaps);
            if overlap > deepest {
                deepest = overlap;
            }
            if overlap > tolerance || !has_islands {
                islands[kept] = island;
                kept += 1;
            }
        }
        islands.truncate(kept);
        self.relinearization.end_gaps = end_gaps;
        deepest > tolerance
    }

    /// Sets the `end_gaps` of an island's contacts (see the field), and returns the deepest overlap in cm. A shortened
    /// substep may leave the fraction `left_fraction` of an earlier overlap that is deeper than the tolerance.
    #[inline]
    fn deepest_end_overlap(&self, island: u32, left_fraction: f64, end_gaps: &mut [f64]) -> f64 {
        let (detector, contacts) = (&self.detector, self.contacts.as_slice());
        let (mut deepest, mut twin_gaps) = (0.0, None);
        for &k in self.solver.islands().contacts(island as usize) {
            let k = k as usize;
            let start_gap = contacts[k].gap.gap.min(0.0);
            end_gaps[k] = f64::INFINITY;
            if start_gap >= -self.penetration_slop && self.predicted.may_close(contacts, k) {
                let end_gap = self.predicted.gap(detector, contacts, k, &mut twin_gaps);
                let is_deep = start_gap < -self.relinearization.tolerance;
                let least_gap = select_unpredictable(is_deep, left_fraction * start_gap, 0.0);
                let overlap = least_gap - end_gap;
                if overlap > deepest {
                    deepest = overlap;
                }
                end_gaps[k] = end_gap - left_fraction * start_gap;
            }
        }
        deepest
    }
}
