//! Projected Gauss–Seidel: one contact after another, until nothing changes. For comparison.

use super::{EXACT, SolveReport};
use crate::contact::ContactProblem;
use crate::geometry::Velocity;

/// Sweeps after which the solver gives up.
const MOST_SWEEPS: u64 = 20_000;
/// The same for contacts times sweeps, for huge flocks.
const MOST_UPDATES: u64 = 1_000_000_000;
/// Sweeps between two evaluations of the residual.
const SWEEPS_BETWEEN_CHECKS: u64 = 10;

/// Solves by sweeping, from the impulses given.
pub(super) fn solve(
    problem: &ContactProblem,
    impulses: &mut [f64],
    velocities: &mut Vec<Velocity>,
) -> SolveReport {
    impulses
        .iter_mut()
        .for_each(|impulse| *impulse = impulse.max(0.0));
    problem.velocities(impulses, velocities);
    let mut report = SolveReport::default();
    let most_sweeps = MOST_SWEEPS.min(MOST_UPDATES / impulses.len().max(1) as u64);
    while report.iterations < most_sweeps {
        for (k, impulse) in impulses.iter_mut().enumerate() {
            let wanted = *impulse - problem.slack(k, velocities) / problem.diagonal(k);
            let change = wanted.max(0.0) - *impulse;
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
    // Running updates gather rounding; the reported residual is that of the velocities handed out.
    problem.velocities(impulses, velocities);
    report.residual = problem.natural_residual(impulses, velocities);
    report.converged = report.residual <= EXACT;
    report
}
