//! The interior-point solver clarabel on the primal quadratic program. An independent check: it stops at residuals of
//! 1e-4 to 1e-7 cm/s, and reports them.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use super::SolveReport;
use crate::contact::ContactProblem;
use crate::geometry::Velocity;

/// Residual in cm/s that counts as solved here.
const GOOD: f64 = 1e-3;

/// Solves min ½ dᵀ·M·d over d = v − v_free with −J·d ≤ J·v_free + bias.
pub(super) fn solve(
    problem: &ContactProblem,
    impulses: &mut [f64],
    velocities: &mut Vec<Velocity>,
) -> SolveReport {
    let contacts = problem.contacts.len();
    let slack = |k| problem.slack(k, problem.free);
    let right: Vec<f64> = (0..contacts).map(slack).collect();
    let cones = [SupportedConeT::NonnegativeConeT(contacts)];
    let settings = DefaultSettings {
        verbose: false,
        ..DefaultSettings::default()
    };
    let linear = vec![0.0; 3 * problem.free.len()];
    let solver = DefaultSolver::new(
        &metric(problem),
        &linear,
        &constraints(problem),
        &right,
        &cones,
        settings,
    );
    let mut report = SolveReport::default();
    if let Ok(mut solver) = solver {
        solver.solve();
        let solution = &solver.solution;
        report.iterations = u64::from(solution.iterations);
        use SolverStatus::{AlmostSolved, Solved};
        let is_usable = matches!(solution.status, Solved | AlmostSolved);
        for (impulse, dual) in impulses.iter_mut().zip(&solution.z) {
            *impulse = if is_usable { dual.max(0.0) } else { 0.0 };
        }
    } else {
        impulses.fill(0.0);
    }
    problem.velocities(impulses, velocities);
    report.residual = problem.natural_residual(impulses, velocities);
    report.converged = report.residual <= GOOD;
    report
}

/// M, the effective inertia of each boat on the diagonal.
fn metric(problem: &ContactProblem) -> CscMatrix<f64> {
    let numbers = 3 * problem.free.len();
    let inertia = problem.inertia.iter();
    let diagonal = inertia
        .flat_map(|i| [1.0 / i.linear, 1.0 / i.linear, 1.0 / i.angular])
        .collect();
    let columns: Vec<usize> = (0..numbers).collect();
    CscMatrix::new_from_triplets(numbers, numbers, columns.clone(), columns, diagonal)
}

/// −J, contacts × 3·boats.
fn constraints(problem: &ContactProblem) -> CscMatrix<f64> {
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (k, contact) in problem.contacts.iter().enumerate() {
        let gap = &contact.gap;
        let mut entry = |boat: usize, sign: f64, arm: f64| {
            for (axis, value) in [gap.normal.x, gap.normal.y, arm].into_iter().enumerate() {
                rows.push(k);
                columns.push(3 * boat + axis);
                values.push(-sign * value);
            }
        };
        entry(contact.boat as usize, 1.0, gap.arm_i);
        if let Some(second) = contact.second() {
            entry(second, -1.0, gap.arm_j);
        }
    }
    CscMatrix::new_from_triplets(
        problem.contacts.len(),
        3 * problem.free.len(),
        rows,
        columns,
        values,
    )
}
