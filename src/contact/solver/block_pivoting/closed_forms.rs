//! Islands of one or two contacts, which need no guess and no factor.

use super::rows::{TOLERANCE, residual};
use super::{BlockPivoting, EXACT, SolveReport};
use crate::contact::ContactProblem;
use crate::geometry::Velocity;

/// Two contacts depend on each other if their determinant is at most this fraction of the product of their diagonals.
const INDEPENDENT: f64 = 1e-6;

impl BlockPivoting {
    /// Solves an island of a single contact, which pushes just enough not to overlap.
    pub(super) fn solve_single(
        &self,
        problem: &ContactProblem,
        k: usize,
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) {
        let right = self.rights[k];
        active[k] = right < 0.0;
        impulses[k] = 0.0;
        if right >= 0.0 {
            return;
        }
        let diagonal = problem.diagonal(k);
        let impulse = (-right / (diagonal * (1.0 + self.regularization))).max(0.0);
        impulses[k] = impulse;
        problem.apply(k, impulse, velocities);
        let slack = problem.slack(k, velocities);
        let residual = residual(diagonal * impulse, slack, self.regularization);
        if residual > report.residual || residual.is_nan() {
            report.residual = residual;
        }
    }

    /// Solves two contacts if one or both push; returns whether it did. Contacts that depend on each other, and
    /// regularized problems, are left to pivoting.
    pub(super) fn solve_two(
        &self,
        problem: &ContactProblem,
        contacts: [usize; 2],
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) -> bool {
        let diagonals = contacts.map(|k| problem.diagonal(k));
        let coupling = problem.coupling(contacts[0], contacts[1]);
        let rights = contacts.map(|k| self.rights[k]);
        if self.regularization > TOLERANCE {
            return false;
        }
        let Some(pushes) = two_impulses(diagonals, coupling, rights) else {
            return false;
        };
        for (k, impulse) in contacts.into_iter().zip(pushes) {
            problem.apply(k, impulse, velocities);
        }
        let residuals = [0, 1].map(|side| {
            let slack = problem.slack(contacts[side], velocities);
            residual(diagonals[side] * pushes[side], slack, self.regularization)
        });
        // Pivoting then solves the island, and overwrites these velocities.
        if !residuals.iter().all(|residual| *residual <= 0.5 * EXACT) {
            return false;
        }
        for (k, impulse) in contacts.into_iter().zip(pushes) {
            (active[k], impulses[k]) = (impulse > 0.0, impulse);
        }
        report.residual = residuals.into_iter().fold(report.residual, f64::max);
        true
    }
}

/// The impulses λ ≥ 0 of a complementarity problem of two rows, if these are independent.
fn two_impulses([a, b]: [f64; 2], coupling: f64, [r, s]: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = a * b - coupling * coupling;
    if determinant <= INDEPENDENT * a * b {
        return None;
    }
    let both = [coupling * s - b * r, coupling * r - a * s].map(|x| x / determinant);
    let (first, second) = ((-r / a).max(0.0), (-s / b).max(0.0));
    if both[0] > 0.0 && both[1] > 0.0 {
        Some(both)
    } else if s + coupling * first >= 0.0 {
        Some([first, 0.0])
    } else if r + coupling * second >= 0.0 {
        Some([0.0, second])
    } else {
        None
    }
}
