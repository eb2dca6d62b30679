//! The exact solver: block principal pivoting (Júdice and Pires 1994) on each island, warm-started
//! from the contacts that carried an impulse before, with Murty's single pivots as the fallback that
//! guarantees an end.

use super::envelope::{ABSENT, EnvelopeFactor};
use super::matrix::ContactMatrix;
use super::{EXACT, SolveReport};
use crate::boat::Velocity;
use crate::contact::{ContactProblem, Islands};
use std::ops::Range;

/// Signs are judged with this tolerance in cm/s, well below [`EXACT`].
const TOLERANCE: f64 = 1e-11;
/// Rounds without fewer violations before single pivots take over.
const PATIENCE: u32 = 5;

/// The matrix, the factors of all islands, and the state of pivoting, row by row of the matrix.
#[derive(Debug, Clone)]
pub struct BlockPivoting {
    /// Added to the diagonal, relative to it, so that redundant contacts share their load.
    ridge: f64,
    matrix: ContactMatrix,
    /// Whether the matrix is that of the contacts at hand.
    is_built: bool,
    factors: Vec<EnvelopeFactor>,
    active: Vec<bool>,
    impulses: Vec<f64>,
    slacks: Vec<f64>,
    /// Velocities of all boats and, last, of the walls.
    velocities: Vec<Velocity>,
    wanted: Vec<u32>,
    places: Vec<u32>,
    solution: Vec<f64>,
}

impl BlockPivoting {
    /// A solver with a relative ridge.
    pub fn new(ridge: f64) -> Self {
        Self {
            ridge,
            matrix: ContactMatrix::default(),
            is_built: false,
            factors: Vec::new(),
            active: Vec::new(),
            impulses: Vec::new(),
            slacks: Vec::new(),
            velocities: Vec::new(),
            wanted: Vec::new(),
            places: Vec::new(),
            solution: Vec::new(),
        }
    }

    /// Forgets the factors; so many islands come next.
    pub fn begin(&mut self, islands: usize) {
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
        self.load(problem, islands, active);
        let mut report = SolveReport::default();
        let mut begin = 0;
        for island in 0..islands.len() {
            let end = begin + islands.contacts(island).len();
            self.solve_island(problem, island, begin..end, &mut report);
            begin = end;
        }
        for row in 0..begin {
            let contact = self.matrix.contact(row);
            active[contact] = self.active[row];
            impulses[contact] = self.impulses[row];
        }
        velocities.clear();
        velocities.extend_from_slice(&self.velocities[..problem.free.len()]);
        report.converged = report.residual <= EXACT.max(self.ridge);
        report
    }

    fn load(&mut self, problem: &ContactProblem, islands: &Islands, active: &[bool]) {
        if !self.is_built {
            self.matrix.build(problem, islands);
            self.is_built = true;
        }
        self.matrix.set_right(problem);
        let rows = active.len();
        self.active.clear();
        self.active
            .extend((0..rows).map(|row| active[self.matrix.contact(row)]));
        self.impulses.clear();
        self.impulses.resize(rows, 0.0);
        self.slacks.clear();
        self.slacks.resize(rows, 0.0);
        self.places.clear();
        self.places.resize(rows, ABSENT);
        self.velocities.clear();
        self.velocities.extend_from_slice(problem.free);
        self.velocities.push(Velocity::default());
    }

    fn solve_island(
        &mut self,
        problem: &ContactProblem,
        island: usize,
        rows: Range<usize>,
        report: &mut SolveReport,
    ) {
        let most_rounds = 50 + 4 * rows.len();
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..most_rounds {
            report.iterations += 1;
            report.factored_rows += self.solve_active(problem, island, rows.clone());
            let (mut violations, mut last) = self.count_violations(rows.clone());
            if violations == 0 && self.refine(problem, island, rows.clone()) {
                (violations, last) = self.count_violations(rows.clone());
            }
            if violations == 0 {
                break;
            }
            if violations < fewest {
                (fewest, patience) = (violations, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                self.active[last] = !self.active[last];
                continue;
            }
            for row in rows.clone() {
                self.active[row] ^= self.is_violated(row);
            }
        }
        report.factor_entries += self.factors[island].len() as u64;
        self.drop_negative(problem, rows.clone());
        report.residual = self.worst_residual(rows, report.residual);
    }

    /// Impulses that close exactly the active gaps, and the slacks of all; returns factored rows.
    fn solve_active(&mut self, problem: &ContactProblem, island: usize, rows: Range<usize>) -> u64 {
        self.wanted.clear();
        self.wanted.extend(
            rows.clone()
                .filter(|&row| self.active[row])
                .map(|row| row as u32),
        );
        let factor = &mut self.factors[island];
        let computed = factor.update(&self.matrix, &self.wanted, self.ridge, &mut self.places);
        let right = self.matrix.right();
        self.solution.clear();
        self.solution
            .extend(self.wanted.iter().map(|&row| -right[row as usize]));
        factor.solve(&mut self.solution);
        self.impulses[rows.clone()].fill(0.0);
        self.add_solution(problem, rows.clone());
        computed
    }

    /// The ridge and rounding leave a remainder at the active contacts; another solve removes it. A
    /// softened problem is meant to give way. Returns whether there was anything to do.
    fn refine(&mut self, problem: &ContactProblem, island: usize, rows: Range<usize>) -> bool {
        let slack = |&row: &u32| self.slacks[row as usize];
        let worst = self
            .wanted
            .iter()
            .map(slack)
            .map(f64::abs)
            .fold(0.0, f64::max);
        if worst <= 0.5 * EXACT || self.ridge > TOLERANCE {
            return false;
        }
        self.solution.clear();
        self.solution
            .extend(self.wanted.iter().map(slack).map(|slack| -slack));
        self.factors[island].solve(&mut self.solution);
        self.add_solution(problem, rows);
        true
    }

    /// Adds the solution to the impulses of the active rows, and brings slacks up to date.
    fn add_solution(&mut self, problem: &ContactProblem, rows: Range<usize>) {
        for (&row, value) in self.wanted.iter().zip(&self.solution) {
            self.impulses[row as usize] += value;
        }
        self.update_slacks(problem, rows);
    }

    fn update_slacks(&mut self, problem: &ContactProblem, rows: Range<usize>) {
        let Self {
            matrix,
            impulses,
            velocities,
            slacks,
            ..
        } = self;
        matrix.move_bodies(rows.clone(), impulses, problem.free, velocities);
        matrix.slacks(rows, problem, velocities, slacks);
    }

    /// Whether a contact pulls, or overlaps although it carries nothing.
    #[inline]
    fn is_violated(&self, row: usize) -> bool {
        if self.active[row] {
            self.impulses[row] * self.matrix.diagonal()[row] < -TOLERANCE
        } else {
            self.slacks[row] < -TOLERANCE
        }
    }

    /// How many contacts are violated, and the last of them.
    fn count_violations(&self, rows: Range<usize>) -> (usize, usize) {
        let mut last = rows.start;
        let violated = rows
            .filter(|&row| self.is_violated(row))
            .inspect(|&row| last = row);
        (violated.count(), last)
    }

    /// Drops impulses that are negative by rounding.
    fn drop_negative(&mut self, problem: &ContactProblem, rows: Range<usize>) {
        let mut dropped = false;
        for row in rows.clone() {
            if self.impulses[row] < 0.0 {
                self.impulses[row] = 0.0;
                self.active[row] = false;
                dropped = true;
            }
        }
        if dropped {
            self.update_slacks(problem, rows);
        }
    }

    /// The larger of an island's natural residual and the worst so far; NaN if anything is.
    fn worst_residual(&self, rows: Range<usize>, worst: f64) -> f64 {
        let softness = if self.ridge < TOLERANCE {
            0.0
        } else {
            self.ridge
        };
        rows.fold(worst, |worst, row| {
            let load = self.matrix.diagonal()[row] * self.impulses[row];
            let residual = load.min(self.slacks[row] + softness * load).abs();
            if residual > worst || residual.is_nan() {
                residual
            } else {
                worst
            }
        })
    }
}
