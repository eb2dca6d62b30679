//! Block principal pivoting on one island.

use super::factor::Factor;
use super::rows::{Body, Row, Rows, TOLERANCE, residual};
use crate::contact::ContactProblem;
use crate::contact::solver::{EXACT, SolveReport};
use crate::geometry::Velocity;

/// Rounds without fewer violations before the descent takes over.
const PATIENCE: u32 = 5;

/// Islands of more rows than this are swept before the first round; in smaller ones a round costs less than the
/// sweeps.
pub(super) const SWEPT_ROWS: usize = 48;
/// Multiplications per row in each round, even if the round recomputes few rows of the factor.
const ROUND: u64 = 50;
/// Multiplications per entry of the factor in each round.
const ENTRY: u64 = 8;
/// Number of sweeps that guess the active rows.
const SWEEPS: u32 = 2;

/// One island with its factor.
#[derive(Debug, Clone, Default)]
pub(super) struct IslandSolver {
    pub rows: Rows,
    pub factor: Factor,
    /// Whether the active rows are those of the substep before.
    is_guess_old: bool,
    /// Right-hand side and solution, row by row, and a scratch entry.
    solution: Vec<f64>,
    /// Number of rows with a wrong sign.
    violations: usize,
    /// Largest absolute slack of an active row in cm/s.
    pub worst: f64,
}

impl IslandSolver {
    /// Lays out the rows of some contacts with the free velocities of their boats.
    pub(super) fn build(
        &mut self,
        problem: &ContactProblem,
        contacts: &[u32],
        active: &[bool],
        impulses: &[f64],
        indices: &mut [u32],
    ) {
        self.is_guess_old = true;
        self.rows.build(problem, contacts, indices);
        self.solution.resize(self.rows.rows.len() + 1, 0.0);
        for row in &mut self.rows.rows {
            row.is_active = active[row.contact as usize];
            row.impulse = impulses[row.contact as usize];
        }
        self.factor.reset(self.rows.rows.len());
    }

    /// Sets the free velocities of the boats.
    // Only a few solves need this: bodies are built with their free velocities.
    #[cold]
    pub(super) fn set_free(&mut self, problem: &ContactProblem) {
        for body in &mut self.rows.bodies[1..] {
            *body = Body::new(body.boat, &problem.free[body.boat as usize]);
        }
    }

    /// Sets biases and right-hand sides.
    pub(super) fn set_right(&mut self, problem: &ContactProblem, rights: &[f64]) {
        for row in &mut self.rows.rows {
            row.bias = problem.biases[row.contact as usize];
            row.right = rights[row.contact as usize];
        }
    }

    /// Solves for impulses and velocities.
    pub(super) fn solve(&mut self, regularization: f64, report: &mut SolveReport) {
        if std::mem::take(&mut self.is_guess_old) && self.rows.rows.len() > SWEPT_ROWS {
            self.rows.sweep(SWEEPS);
        }
        if self.are_dependent(regularization, |row| row.is_active) {
            self.descend(regularization, report);
        } else {
            self.pivot(regularization, report);
        }
        report.factor_entries += self.factor.len();
        self.drop_negative();
        report.residual = self.worst_residual(regularization, report.residual);
    }

    /// Whether the rows for which `is_counted` holds must be linearly dependent: they are more than the degrees of freedom
    /// of the island's boats. No solution needs so many, and they would fill the whole factor. False for a regularized
    /// problem, which shares impulses among all rows, and for small islands.
    fn are_dependent(&self, regularization: f64, is_counted: impl Fn(&Row) -> bool) -> bool {
        let (rows, most) = (&self.rows.rows, self.most_active());
        rows.len() > most.max(SWEPT_ROWS)
            && regularization < TOLERANCE
            && rows.iter().filter(|row| is_counted(row)).count() > most
    }

    /// Largest number of independent rows.
    pub(super) fn most_active(&self) -> usize {
        3 * (self.rows.bodies.len() - 1)
    }

    /// Pivots until no sign is wrong. If that takes too long, the descent takes over.
    #[inline]
    fn pivot(&mut self, regularization: f64, report: &mut SolveReport) {
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        loop {
            report.iterations += 1;
            report.factored_rows += self.solve_active(regularization);
            let mut refinements = 0;
            while self.violations == 0 && refinements < 3 && self.refine(regularization) {
                refinements += 1;
            }
            let violations = self.violations;
            if violations == 0 || self.factor.budget < 0 {
                break;
            }
            if violations < fewest {
                (fewest, patience) = (violations, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                return self.descend(regularization, report);
            }
            if self.rows.rows.len() > SWEPT_ROWS {
                self.charge_round();
            }
            // Flipping makes these rows active.
            if self.are_dependent(regularization, |row| row.is_active != row.is_violated()) {
                return self.descend(regularization, report);
            }
            self.flip_violated();
        }
    }

    /// The contacts, whether they are active, and their impulses.
    pub(crate) fn solution(&self) -> impl Iterator<Item = (u32, bool, f64)> {
        let rows = self.rows.rows.iter();
        rows.map(|row| (row.contact, row.is_active, row.impulse))
    }

    /// The boats and their velocities.
    pub(crate) fn velocities(&self) -> impl Iterator<Item = (u32, Velocity)> {
        // Body 0 stands for the walls.
        self.rows.bodies[1..].iter().map(|body| {
            let [x, y, angular] = body.velocity;
            (body.boat, Velocity::new(x, y, angular))
        })
    }

    /// Computes impulses that close the active gaps, and the slacks of all rows; returns the number of factored
    /// rows.
    pub(super) fn solve_active(&mut self, regularization: f64) -> u64 {
        let computed = self.factor.update(&self.rows, regularization);
        for (value, row) in self.solution.iter_mut().zip(&mut self.rows.rows) {
            *value = if row.is_active { -row.right } else { 0.0 };
            row.impulse = 0.0;
        }
        self.add_solution();
        computed
    }

    /// One step of iterative refinement: removes the slack that rounding left at the active contacts. Returns whether a
    /// step was needed. A regularized problem keeps its slack, since its contacts are meant to yield.
    pub(super) fn refine(&mut self, regularization: f64) -> bool {
        if self.worst <= 0.5 * EXACT || regularization > TOLERANCE {
            return false;
        }
        for (value, row) in self.solution.iter_mut().zip(&self.rows.rows) {
            *value = if row.is_active { -row.slack } else { 0.0 };
        }
        self.add_solution();
        true
    }

    /// Adds the solution for the present right-hand side to the impulses, and updates the slacks.
    #[inline(always)]
    fn add_solution(&mut self) {
        self.factor.solve(&mut self.solution);
        for (row, value) in self.rows.rows.iter_mut().zip(&self.solution) {
            row.impulse += value;
        }
        (self.violations, self.worst) = self.rows.update();
    }

    /// Subtracts the work of a round from the budget, except that of long rows of the factor: updates subtract that.
    #[cold]
    pub(super) fn charge_round(&mut self) {
        let rows = ROUND * self.rows.rows.len() as u64;
        self.factor.budget -= (rows + ENTRY * self.factor.len()) as i64;
    }

    /// Activates the inactive rows with a wrong sign, and deactivates the active ones.
    fn flip_violated(&mut self) {
        for k in 0..self.rows.rows.len() {
            if self.rows.rows[k].is_violated() {
                self.set_active(k, !self.rows.rows[k].is_active);
            }
        }
    }

    /// Lets a row enter or leave the active set.
    pub(super) fn set_active(&mut self, row: usize, is_active: bool) {
        if self.rows.rows[row].is_active != is_active {
            self.rows.rows[row].is_active = is_active;
            self.factor.set_stale();
        }
    }

    /// Drops impulses that are negative by rounding.
    fn drop_negative(&mut self) {
        let mut dropped = false;
        for k in 0..self.rows.rows.len() {
            if self.rows.rows[k].impulse < 0.0 {
                self.rows.rows[k].impulse = 0.0;
                self.set_active(k, false);
                dropped = true;
            }
        }
        if dropped {
            self.rows.update();
        }
    }

    /// The larger of the natural residual and the worst so far; NaN if an impulse is NaN.
    fn worst_residual(&self, regularization: f64, worst: f64) -> f64 {
        self.rows.rows.iter().fold(worst, |worst, row| {
            let residual = residual(row.diagonal * row.impulse, row.slack, regularization);
            if residual > worst || residual.is_nan() {
                residual
            } else {
                worst
            }
        })
    }
}
