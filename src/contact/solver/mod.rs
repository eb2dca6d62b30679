//! Solvers of the contact problem.

mod block_pivoting;
#[cfg(feature = "clarabel")]
mod clarabel;
mod gauss_seidel;

use super::{Contact, ContactProblem, Islands};
use crate::geometry::Velocity;
use crate::parameters::Solver;

use block_pivoting::BlockPivoting;

/// Work and quality of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SolveReport {
    /// Whether the residual meets the solver's bound (1e-10 cm/s for block pivoting). It may exceed the bound if
    /// the linearized constraints contradict each other.
    pub converged: bool,
    /// Natural residual max|min(A_kk·λ_k, w_k)| in cm/s.
    pub residual: f64,
    /// Pivoting rounds, sweeps or interior-point iterations, over all islands.
    pub iterations: u64,
    /// Rows of Cholesky factors computed.
    pub factored_rows: u64,
    /// Numbers held by the Cholesky factors.
    pub factor_entries: u64,
    /// Islands with contacts.
    pub islands: u64,
}

/// Rough number of multiplications that the contacts of a whole substep may take, even if it is cut into shorter ones. A
/// densely packed flock takes a hundredth of the budget while it is placed, and less once it moves.
const MOST_WORK: i64 = 1_000_000_000;
/// Number of multiplications by which each boat raises the budget.
const MOST_WORK_A_BOAT: i64 = 500_000;

/// Residual in cm/s that counts as solved.
pub const EXACT: f64 = 1e-10;

/// A contact solver with its memory of the substep before.
#[derive(Debug, Clone)]
pub struct ContactSolver {
    kind: Solver,
    islands: Islands,
    /// Indices of all islands.
    all_islands: Vec<u32>,
    pivoting: BlockPivoting,
    /// The work budget of a whole substep.
    most_work: i64,
    /// The part of the remaining budget that is reserved for later contacts.
    reserved: i64,
    /// Work of the earlier substeps.
    work_before: i64,
    /// Whether each contact carries an impulse: a guess before a solve, the solution after it.
    pub active: Vec<bool>,
    /// Impulses λ in cm/s (mass 1): a guess before a solve, the solution after it.
    pub impulses: Vec<f64>,
    /// Velocities after contact; scratch once a flock has swapped them with its own.
    pub velocities: Vec<Velocity>,
}

impl ContactSolver {
    /// A solver of the given kind.
    pub fn new(kind: Solver) -> Self {
        Self {
            kind,
            islands: Islands::default(),
            all_islands: Vec::new(),
            pivoting: BlockPivoting::new(1e-13),
            // The budget of `pivoting` is unlimited until the first substep sets one. These values make `work` 0 until then.
            most_work: 0,
            reserved: 0,
            work_before: i64::MAX,
            active: Vec::new(),
            impulses: Vec::new(),
            velocities: Vec::new(),
        }
    }

    /// An exact solver in which every contact yields by `regularization`·A_kk·λ_k, so that contradicting constraints
    /// are satisfied as well as possible.
    pub(crate) fn regularized(regularization: f64) -> Self {
        Self {
            pivoting: BlockPivoting::new(regularization),
            ..Self::new(Solver::BlockPivoting)
        }
    }

    /// Sets whether the solver keeps its factors. With them, it costs less to solve the same contacts again.
    pub fn keeping_factors(mut self, keeps: bool) -> Self {
        self.pivoting.keeps_factors = keeps;
        self
    }

    /// Prepares for new contacts; `active` and `impulses` must hold a guess for each.
    pub fn reset(&mut self, boats: usize, contacts: &[Contact]) {
        debug_assert_eq!(self.active.len(), contacts.len());
        self.islands.find(boats, contacts);
        self.all_islands.clear();
        self.all_islands.extend(0..self.islands.count() as u32);
        self.pivoting.reset(boats, self.islands.count());
    }

    /// Restores the full work budget for a whole substep, if some of it has been used.
    pub(crate) fn refill(&mut self, boats: usize) {
        if self.pivoting.budget + self.reserved != self.most_work {
            self.work_before = self.work();
            self.most_work = MOST_WORK + MOST_WORK_A_BOAT * boats as i64;
            (self.pivoting.budget, self.reserved) = (self.most_work, 0);
        }
    }

    /// Takes over the remaining work budget of another solver in the same substep.
    pub(crate) fn share_budget(&mut self, other: &Self) {
        let budget = other.pivoting.budget + other.reserved;
        (self.pivoting.budget, self.reserved) = (budget, 0);
    }

    /// If the substep may still be shortened, leaves at most a sixteenth of the full budget for its contacts and reserves
    /// the remainder. Otherwise makes the whole remaining budget available.
    pub(crate) fn reserve_budget(&mut self, is_divisible: bool) {
        let budget = self.pivoting.budget + self.reserved;
        let spare = (budget - self.most_work / 16).max(0);
        self.reserved = if is_divisible { spare } else { 0 };
        self.pivoting.budget = budget - self.reserved;
    }

    /// Rough number of multiplications spent on the contacts of all substeps, including discarded ones.
    pub(crate) fn work(&self) -> i64 {
        self.work_before + self.most_work - self.pivoting.budget - self.reserved
    }

    /// Whether the last contacts exceeded the work budget and have no solution.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.pivoting.budget < 0
    }

    /// The islands of the present contacts.
    pub fn islands(&self) -> &Islands {
        &self.islands
    }

    /// Solves for `impulses` and `velocities`.
    pub fn solve(&mut self, problem: &ContactProblem) -> SolveReport {
        self.solve_as(self.kind, problem)
    }

    /// Whether islands can be solved without the others.
    pub(crate) fn has_islands(&self) -> bool {
        self.kind == Solver::BlockPivoting
    }

    /// Solves the listed islands again, with other biases. Kept factors are reused as far as the active set stays the
    /// same. A solver without islands solves the whole problem.
    pub(crate) fn solve_again(&mut self, problem: &ContactProblem, listed: &[u32]) -> SolveReport {
        if !self.has_islands() {
            return self.solve(problem);
        }
        for &island in listed {
            let contacts = self.islands.contacts(island as usize);
            if contacts.len() <= 2 {
                problem.reset_velocities(contacts, &mut self.velocities);
            }
        }
        let report = self.pivoting.solve(
            problem,
            &self.islands,
            listed,
            &mut self.active,
            &mut self.impulses,
            &mut self.velocities,
        );
        SolveReport {
            islands: listed.len() as u64,
            ..report
        }
    }

    /// Solves with a solver of another kind.
    pub(crate) fn solve_as(&mut self, kind: Solver, problem: &ContactProblem) -> SolveReport {
        let (impulses, velocities) = (&mut self.impulses, &mut self.velocities);
        let mut report = match kind {
            Solver::BlockPivoting => {
                velocities.clear();
                velocities.extend_from_slice(problem.free);
                let active = &mut self.active;
                let (islands, all) = (&self.islands, &self.all_islands);
                self.pivoting.set_free(problem);
                self.pivoting
                    .solve(problem, islands, all, active, impulses, velocities)
            }
            Solver::GaussSeidel => {
                gauss_seidel::solve(problem, impulses, velocities, &mut self.pivoting.budget)
            }
            #[cfg(feature = "clarabel")]
            Solver::Clarabel => clarabel::solve(problem, impulses, velocities),
        };
        if kind != Solver::BlockPivoting {
            let are_active = self.impulses.iter().map(|&impulse| impulse > 0.0);
            self.active.clear();
            self.active.extend(are_active);
        }
        report.islands = self.islands.count() as u64;
        report
    }
}
