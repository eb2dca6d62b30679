//! The fallback if pivoting cycles: contacts whose normals nearly depend on each other make the matrix almost singular,
//! and the signs after a pivot are then due to rounding. (Murty's single pivots, the usual fallback, rely on those
//! signs, too, and also cycle.)
//!
//! Lawson and Hanson's active-set method (1974) on the dual ½·λᵀ·A·λ + bᵀ·λ over λ ≥ 0. Impulses stay
//! non-negative and every step lowers the dual, so that no active set comes twice.

use super::island_solver::{IslandSolver, SWEPT_ROWS};
use super::rows::{Row, TOLERANCE};
use crate::contact::solver::{EXACT, SolveReport};

/// Larger impulses (times A_kk, in cm/s) come only from constraints that contradict each other.
const CONTRADICTION: f64 = 1e9;

impl IslandSolver {
    /// Solves the island again. A large island starts from the pushing impulses of the last round. If that fails, and
    /// in a small island, all impulses start at zero.
    pub(super) fn descend(&mut self, regularization: f64, report: &mut SolveReport) {
        let rows = &self.rows.rows;
        let mut pushes: Vec<_> = rows.iter().map(|row| row.impulse.max(0.0)).collect();
        self.keep_strongest(&mut pushes);
        let is_warm = rows.len() > SWEPT_ROWS && pushes.iter().any(|&impulse| impulse > 0.0);
        let is_solved = is_warm && self.descend_from(pushes, regularization, report);
        if !is_solved {
            // If this fails, too, the residual shows it.
            self.descend_from(vec![0.0; self.rows.rows.len()], regularization, report);
        }
    }

    /// Descends from these impulses; returns whether that solves the island. If some contacts push at the start, the others
    /// enter together. If none does, contacts enter one by one.
    fn descend_from(
        &mut self,
        mut current: Vec<f64>,
        regularization: f64,
        report: &mut SolveReport,
    ) -> bool {
        let is_warm = self.start_from(&current);
        if is_warm {
            self.approach(&mut current, regularization, report);
        }
        // A contact that would have to pull as soon as it enters is refused until the impulses move.
        let mut is_refused = vec![false; current.len()];
        let mut enters_alone = !is_warm;
        let most_rounds = 50 + 10 * current.len();
        for _ in 0..most_rounds {
            let largest = current.iter().copied().fold(0.0, f64::max);
            if !largest.is_finite() || largest > CONTRADICTION || self.factor.budget < 0 {
                return false;
            }
            let Some(entering) = self.most_violated(&is_refused) else {
                let is_exact = self.worst <= EXACT || regularization > TOLERANCE;
                return is_exact && !self.rows.rows.iter().any(Row::is_violated);
            };
            if enters_alone {
                self.set_active(entering, true);
            } else {
                self.enter_violated();
            }
            let first_step = self.approach(&mut current, regularization, report);
            if first_step > 0.0 || self.rows.rows[entering].is_active {
                is_refused.fill(false);
                enters_alone = !is_warm;
            } else {
                // Contacts that were refused together are tried one by one.
                is_refused[entering] = enters_alone;
                enters_alone = true;
            }
        }
        false
    }

    /// Sets the rows' impulses and activates the contacts that push; returns whether any does.
    fn start_from(&mut self, current: &[f64]) -> bool {
        for (k, &impulse) in current.iter().enumerate() {
            self.rows.rows[k].impulse = impulse;
            self.set_active(k, impulse > 0.0);
        }
        self.rows.update();
        current.iter().any(|&impulse| impulse > 0.0)
    }

    /// Sets all but the strongest impulses to zero if more are positive than the island has degrees of freedom.
    fn keep_strongest(&self, pushes: &mut [f64]) {
        let most = self.most_active();
        if pushes.len() <= most || pushes.iter().filter(|&&push| push > 0.0).count() <= most {
            return;
        }
        let mut order: Vec<usize> = (0..pushes.len()).collect();
        order.sort_by(|&a, &b| pushes[b].total_cmp(&pushes[a]));
        order[most..].iter().for_each(|&k| pushes[k] = 0.0);
    }

    /// Activates the contacts whose gaps close, the fastest first, and at most as many as can be independent of each
    /// other. Those that would have to pull leave again at once. In a large island most contacts are far apart, so most
    /// of those that enter together do not affect each other.
    fn enter_violated(&mut self) {
        let rows = &self.rows.rows;
        let active = rows.iter().filter(|row| row.is_active).count();
        let mut entering: Vec<usize> = (0..rows.len())
            .filter(|&k| !rows[k].is_active && rows[k].is_violated())
            .collect();
        let most = self.most_active().saturating_sub(active).max(1);
        if entering.len() > most {
            entering.sort_by(|&a, &b| rows[a].slack.total_cmp(&rows[b].slack));
            entering.truncate(most);
        }
        for k in entering {
            self.set_active(k, true);
        }
    }

    /// The inactive row that is not refused and whose gap closes fastest.
    fn most_violated(&self, is_refused: &[bool]) -> Option<usize> {
        let rows = self.rows.rows.iter().zip(is_refused).enumerate();
        rows.filter(|(_, (row, refused))| !row.is_active && !**refused && row.slack < -TOLERANCE)
            .min_by(|(_, (a, _)), (_, (b, _))| a.slack.total_cmp(&b.slack))
            .map(|(k, _)| k)
    }

    /// Moves `current` to the impulses that close all active gaps, and drops contacts whose impulse vanishes on the way.
    /// Returns the fraction of the first step that was taken, in (0, 1], or 0 if it could not be taken.
    fn approach(
        &mut self,
        current: &mut [f64],
        regularization: f64,
        report: &mut SolveReport,
    ) -> f64 {
        let mut first_step = None;
        loop {
            report.iterations += 1;
            report.factored_rows += self.solve_active(regularization);
            self.refine(regularization);
            self.charge_round();
            let step = self.feasible_step(current);
            first_step.get_or_insert(step);
            for (k, current) in current.iter_mut().enumerate() {
                let target = self.rows.rows[k].impulse;
                *current = (*current + step * (target - *current)).max(0.0);
                // If the step is below 1, this drops at least the contact that stopped it.
                let is_active = self.rows.rows[k].is_active;
                if is_active && target <= 0.0 && *current <= 1e-14 * (1.0 + target.abs()) {
                    self.set_active(k, false);
                    *current = 0.0;
                }
            }
            if step == 1.0 || self.factor.budget < 0 {
                return first_step.unwrap_or(0.0);
            }
        }
    }

    /// The largest fraction of the step from `current` to the rows' impulses at which no impulse is negative.
    fn feasible_step(&self, current: &[f64]) -> f64 {
        let pairs = self.rows.rows.iter().zip(current);
        pairs
            .filter(|(row, _)| row.is_active && row.impulse < 0.0)
            .map(|(row, current)| current / (current - row.impulse))
            .fold(1.0, f64::min)
    }
}
