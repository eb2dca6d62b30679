//! Projected Gauss–Seidel, for comparison: solves one contact after another until the residual is small.

use super::{EXACT, SolveReport};
use crate::contact::ContactProblem;
use crate::geometry::Velocity;

/// Sweeps after which the solver gives up.
const MOST_SWEEPS: u64 = 20_000;
/// Multiplications for each contact in a sweep.
const UPDATE: i64 = 5;
/// Sweeps between two evaluations of the residual.
const SWEEPS_BETWEEN_CHECKS: u64 = 10;

/// Solves by sweeping from the given impulses, while the budget of multiplications lasts.
pub(super) fn solve(
    problem: &ContactProblem,
    impulses: &mut [f64],
    velocities: &mut Vec<Velocity>,
    budget: &mut i64,
) -> SolveReport {
    impulses
        .iter_mut()
        .for_each(|impulse| *impulse = impulse.max(0.0));
    problem.velocities(impulses, velocities);
    let mut report = SolveReport::default();
    while report.iterations < MOST_SWEEPS && *budget >= 0 {
        *budget -= UPDATE * impulses.len() as i64;
        for (k, impulse) in impulses.iter_mut().enumerate() {
            let target = *impulse - problem.slack(k, velocities) / problem.diagonal(k);
            let change = target.max(0.0) - *impulse;
            if change != 0.0 {
                *impulse += change;
                problem.apply(k, change, velocities);
            }
        }
        report.iterations += 1;
        if report.iterations.is_multiple_of(SWEEPS_BETWEEN_CHECKS) {
            report.residual = problem.natural_residual(impulses, velocities);
            if report.residual <= 0.1 * EXACT {
                break;
            }
        }
    }
    // Running updates accumulate rounding errors; the residual is computed from the velocities that are returned.
    problem.velocities(impulses, velocities);
    report.residual = problem.natural_residual(impulses, velocities);
    report.converged = report.residual <= EXACT;
    report
}
