//! The exact solver: block principal pivoting (Júdice and Pires 1994) on each island, warm-started
//! from the contacts that carried an impulse before, with a descent as the fallback that guarantees an
//! end.

mod descent;

use super::envelope::{ABSENT, EnvelopeFactor};
use super::matrix::ContactMatrix;
use super::{EXACT, SolveReport};
use crate::contact::{ContactProblem, Islands};
use crate::geometry::Velocity;
use std::ops::Range;

/// Signs are judged with this tolerance in cm/s, well below [`EXACT`].
const TOLERANCE: f64 = 1e-11;
/// Rounds without fewer violations before the descent takes over.
const PATIENCE: u32 = 5;

/// The matrix, the factors of all islands, and the state of pivoting, row by row of the matrix.
#[derive(Debug, Clone, Default)]
pub struct BlockPivoting {
    /// Added to the diagonal, relative to it, so that redundant contacts share their impulse.
    regularization: f64,
    matrix: ContactMatrix,
    /// Whether the matrix is that of the contacts at hand.
    is_built: bool,
    factors: Vec<EnvelopeFactor>,
    active: Vec<bool>,
    impulses: Vec<f64>,
    slacks: Vec<f64>,
    /// Velocities of all boats and, last, of the walls: without contacts, and with.
    free: Vec<Velocity>,
    velocities: Vec<Velocity>,
    wanted: Vec<u32>,
    places: Vec<u32>,
    solution: Vec<f64>,
}

impl BlockPivoting {
    /// A solver with a relative regularization.
    pub fn new(regularization: f64) -> Self {
        Self {
            regularization,
            ..Self::default()
        }
    }

    /// Forgets the factors; so many islands come next.
    pub fn reset(&mut self, islands: usize) {
        self.is_built = false;
        self.factors.iter_mut().for_each(EnvelopeFactor::clear);
        if self.factors.len() < islands {
            self.factors.resize_with(islands, EnvelopeFactor::default);
        }
    }

    /// Solves all islands.
    pub fn solve(
        &mut self,
        problem: &ContactProblem,
        islands: &Islands,
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut Vec<Velocity>,
    ) -> SolveReport {
        self.assemble(problem, islands, active);
        let mut report = SolveReport::default();
        for island in 0..islands.len() {
            self.solve_island(island, islands.range(island), &mut report);
        }
        let states = self.active.iter().zip(&self.impulses);
        for (row, (&is_active, &impulse)) in self.matrix.rows().iter().zip(states) {
            active[row.contact as usize] = is_active;
            impulses[row.contact as usize] = impulse;
        }
        velocities.clear();
        velocities.extend_from_slice(&self.velocities[..problem.free.len()]);
        report.converged = report.residual <= EXACT.max(self.regularization);
        report
    }

    fn assemble(&mut self, problem: &ContactProblem, islands: &Islands, active: &[bool]) {
        if !self.is_built {
            self.matrix.build(problem, islands);
            self.is_built = true;
        }
        self.free.clear();
        self.free.extend_from_slice(problem.free);
        self.free.push(Velocity::default());
        self.velocities.clone_from(&self.free);
        self.matrix.set_right(problem, &self.free);
        let rows = self.matrix.rows();
        self.active.clear();
        self.active
            .extend(rows.iter().map(|row| active[row.contact as usize]));
        self.impulses.clear();
        self.impulses.resize(rows.len(), 0.0);
        self.slacks.clear();
        self.slacks.resize(rows.len(), 0.0);
        self.places.clear();
        self.places.resize(rows.len(), ABSENT);
    }

    /// Whether an island's contacts neither carry nor close anything: its boats move as they are.
    fn is_idle(&self, rows: Range<usize>) -> bool {
        let matrix_rows = &self.matrix.rows()[rows.clone()];
        let pairs = matrix_rows.iter().zip(&self.active[rows]);
        pairs
            .into_iter()
            .all(|(row, &active)| !active && row.right >= 0.0)
    }

    fn solve_island(&mut self, island: usize, rows: Range<usize>, report: &mut SolveReport) {
        if self.is_idle(rows.clone()) {
            report.iterations += 1;
            return;
        }
        if rows.len() == 1 {
            report.iterations += 1;
            self.solve_alone(rows.start);
            report.residual = self.worst_residual(rows, report.residual);
            return;
        }
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        loop {
            report.iterations += 1;
            report.factored_rows += self.solve_active(island, rows.clone());
            let mut violations = self.count_violations(rows.clone());
            let mut refinements = 0;
            while violations == 0 && refinements < 3 && self.refine(island, rows.clone()) {
                violations = self.count_violations(rows.clone());
                refinements += 1;
            }
            if violations == 0 {
                break;
            }
            if violations < fewest {
                (fewest, patience) = (violations, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                self.descend(island, rows.clone(), report);
                break;
            }
            for row in rows.clone() {
                self.active[row] ^= self.is_violated(row);
            }
        }
        report.factor_entries += self.factors[island].len() as u64;
        self.drop_negative(rows.clone());
        report.residual = self.worst_residual(rows, report.residual);
    }

    /// One contact alone needs no guess and no factor: it pushes as much as it would overlap.
    fn solve_alone(&mut self, number: usize) {
        let row = &self.matrix.rows()[number];
        let impulse = (-row.right / (row.diagonal * (1.0 + self.regularization))).max(0.0);
        self.active[number] = impulse > 0.0;
        self.impulses[number] = impulse;
        if impulse > 0.0 {
            row.apply(impulse, &mut self.velocities);
        }
        self.slacks[number] = row.slack(&self.velocities);
    }

    /// Impulses that close exactly the active gaps, and the slacks of all; returns factored rows.
    fn solve_active(&mut self, island: usize, rows: Range<usize>) -> u64 {
        self.wanted.clear();
        self.wanted.extend(
            rows.clone()
                .filter(|&row| self.active[row])
                .map(|row| row as u32),
        );
        let factor = &mut self.factors[island];
        let computed = factor.update(
            &self.matrix,
            &self.wanted,
            self.regularization,
            &mut self.places,
        );
        let right = |&row: &u32| -self.matrix.rows()[row as usize].right;
        self.solution.clear();
        self.solution.extend(self.wanted.iter().map(right));
        factor.solve(&mut self.solution);
        self.impulses[rows.clone()].fill(0.0);
        self.add_solution(rows);
        computed
    }

    /// The regularization and rounding leave a remainder at the active contacts; another solve removes it. A
    /// regularized problem is meant to give way. Returns whether there was anything to do.
    fn refine(&mut self, island: usize, rows: Range<usize>) -> bool {
        let slack = |&row: &u32| self.slacks[row as usize];
        let worst = self
            .wanted
            .iter()
            .map(slack)
            .map(f64::abs)
            .fold(0.0, f64::max);
        if worst <= 0.5 * EXACT || self.regularization > TOLERANCE {
            return false;
        }
        self.solution.clear();
        self.solution
            .extend(self.wanted.iter().map(slack).map(|slack| -slack));
        self.factors[island].solve(&mut self.solution);
        self.add_solution(rows);
        true
    }

    /// Adds the solution to the impulses of the active rows, and brings slacks up to date.
    fn add_solution(&mut self, rows: Range<usize>) {
        for (&row, value) in self.wanted.iter().zip(&self.solution) {
            self.impulses[row as usize] += value;
        }
        self.update_slacks(rows);
    }

    fn update_slacks(&mut self, rows: Range<usize>) {
        let Self {
            matrix,
            impulses,
            free,
            velocities,
            slacks,
            ..
        } = self;
        let (impulses, slacks) = (&impulses[rows.clone()], &mut slacks[rows.clone()]);
        let rows = &matrix.rows()[rows];
        rows.iter().for_each(|row| row.release(free, velocities));
        for (row, &impulse) in rows.iter().zip(impulses) {
            if impulse != 0.0 {
                row.apply(impulse, velocities);
            }
        }
        rows.iter()
            .zip(slacks)
            .for_each(|(row, slack)| *slack = row.slack(velocities));
    }

    /// Whether a contact pulls, or overlaps although it carries nothing.
    #[inline]
    fn is_violated(&self, row: usize) -> bool {
        if self.active[row] {
            self.impulses[row] * self.matrix.rows()[row].diagonal < -TOLERANCE
        } else {
            self.slacks[row] < -TOLERANCE
        }
    }

    fn count_violations(&self, rows: Range<usize>) -> usize {
        rows.filter(|&row| self.is_violated(row)).count()
    }

    /// Drops impulses that are negative by rounding.
    fn drop_negative(&mut self, rows: Range<usize>) {
        let mut dropped = false;
        for row in rows.clone() {
            if self.impulses[row] < 0.0 {
                self.impulses[row] = 0.0;
                self.active[row] = false;
                dropped = true;
            }
        }
        if dropped {
            self.update_slacks(rows);
        }
    }

    /// The larger of an island's natural residual and the worst so far; NaN if anything is.
    fn worst_residual(&self, rows: Range<usize>, worst: f64) -> f64 {
        let regularization = if self.regularization < TOLERANCE {
            0.0
        } else {
            self.regularization
        };
        rows.fold(worst, |worst, row| {
            let scaled = self.matrix.rows()[row].diagonal * self.impulses[row];
            let residual = scaled.min(self.slacks[row] + regularization * scaled).abs();
            if residual > worst || residual.is_nan() {
                residual
            } else {
                worst
            }
        })
    }
}
