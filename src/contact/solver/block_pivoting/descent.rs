//! The way out where pivoting cycles: contacts whose normals nearly depend on each other make the
//! matrix as good as singular, and signs after a pivot are then those of rounding. (Murty's single
//! pivots, the usual way out, rely on those signs too, and cycle as well.)
//!
//! Lawson and Hanson's active-set method (1974) on the dual ½·λᵀ·A·λ + bᵀ·λ over λ ≥ 0. Impulses stay
//! non-negative and every step lowers the dual, so that no active set comes twice.

use super::{BlockPivoting, SolveReport, TOLERANCE};
use std::ops::Range;

/// Impulses (times A_kk, in cm/s) that only constraints which contradict each other ask for.
const CONTRADICTION: f64 = 1e9;

impl BlockPivoting {
    /// Solves an island anew, from no impulses at all.
    pub(super) fn descend(&mut self, island: usize, rows: Range<usize>, report: &mut SolveReport) {
        self.active[rows.clone()].fill(false);
        self.impulses[rows.clone()].fill(0.0);
        self.update_slacks(rows.clone());
        let mut held = vec![0.0; rows.len()];
        // A contact that would have to pull as soon as it enters depends on those already in.
        let mut is_refused = vec![false; rows.len()];
        for _ in 0..50 + 10 * rows.len() {
            let Some(entering) = self.most_violated(rows.clone(), &is_refused) else {
                return;
            };
            self.active[entering] = true;
            let moved = self.approach(island, rows.clone(), &mut held, report);
            if !self.active[entering] && moved == 0.0 {
                is_refused[entering - rows.start] = true;
            } else {
                is_refused.fill(false);
            }
            let largest = held.iter().copied().fold(0.0, f64::max);
            if !largest.is_finite() || largest > CONTRADICTION {
                return;
            }
        }
    }

    fn most_violated(&self, rows: Range<usize>, is_refused: &[bool]) -> Option<usize> {
        rows.clone()
            .filter(|&row| !self.active[row] && !is_refused[row - rows.start])
            .filter(|&row| self.slacks[row] < -TOLERANCE)
            .min_by(|&a, &b| self.slacks[a].total_cmp(&self.slacks[b]))
    }

    /// Goes from `held` towards the impulses that close all active gaps, dropping contacts whose
    /// impulse vanishes on the way, until it gets there; returns how far the first step went, in (0, 1],
    /// or 0 if it could not be taken.
    fn approach(
        &mut self,
        island: usize,
        rows: Range<usize>,
        held: &mut [f64],
        report: &mut SolveReport,
    ) -> f64 {
        let mut first = None;
        loop {
            report.iterations += 1;
            report.factored_rows += self.solve_active(island, rows.clone());
            self.refine(island, rows.clone());
            let step = self.feasible_step(rows.clone(), held);
            first.get_or_insert(step);
            for (held, row) in held.iter_mut().zip(rows.clone()) {
                let target = self.impulses[row];
                *held = (*held + step * (target - *held)).max(0.0);
                // At a step below 1 this drops at least the contact that stopped it.
                if self.active[row] && target <= 0.0 && *held <= 1e-14 * (1.0 + target.abs()) {
                    self.active[row] = false;
                    *held = 0.0;
                }
            }
            if step == 1.0 {
                return first.unwrap_or(0.0);
            }
        }
    }

    /// The largest part of the way from `held` to the impulses on which none turns negative.
    fn feasible_step(&self, rows: Range<usize>, held: &[f64]) -> f64 {
        rows.zip(held)
            .filter(|&(row, _)| self.active[row] && self.impulses[row] < 0.0)
            .map(|(row, held)| held / (held - self.impulses[row]))
            .fold(1.0, f64::min)
    }
}
