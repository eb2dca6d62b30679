//! The exact solver: block principal pivoting (Júdice and Pires 1994) on each island. It is warm-started
//! with the contacts that carried an impulse before. If pivoting cycles, a descent that always ends takes over.

mod closed_forms;
mod descent;
mod factor;
mod island_solver;
mod rows;

use super::{EXACT, SolveReport};
use crate::contact::{ContactProblem, Islands};
use crate::geometry::Velocity;
use island_solver::IslandSolver;
use rows::NONE;

/// Number of rows for which the solvers may hold memory. Each solver keeps the memory of its largest island so far. As
/// islands are numbered differently in each substep, this could add up to many times the rows of a large flock.
const MOST_ROWS_HELD: usize = 1000;
/// Number of rows by which each boat raises that limit.
const MOST_ROWS_HELD_A_BOAT: usize = 8;

/// The solvers of islands.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockPivoting {
    /// Added to the diagonal, relative to it, so that redundant contacts share their impulse.
    regularization: f64,
    /// Whether each island keeps its factor for another solve. Otherwise all share one solver, whose memory stays
    /// in the processor's cache.
    pub keeps_factors: bool,
    solvers: Vec<IslandSolver>,
    /// Index of each island's solver, or [`NONE`].
    solver_of_island: Vec<u32>,
    /// Number of solvers that hold an island.
    used_solvers: usize,
    /// Number of rows that the solvers have memory for.
    rows_held: usize,
    /// Number of multiplications that are still allowed; negative if an island was given up.
    pub budget: i64,
    /// J·v_free for each contact: how fast its gap opens at the free velocities.
    rates: Vec<f64>,
    /// Right-hand side b for each contact.
    rights: Vec<f64>,
    /// The islands that no closed form solves.
    remaining: Vec<u32>,
    /// Scratch space for building an island: each boat's index in the island. All [`NONE`] between builds.
    indices: Vec<u32>,
}

impl BlockPivoting {
    /// A solver with a relative regularization.
    pub(super) fn new(regularization: f64) -> Self {
        Self {
            regularization,
            budget: i64::MAX,
            ..Self::default()
        }
    }

    /// Forgets the factors, and prepares for the next numbers of islands and boats.
    pub(super) fn reset(&mut self, boats: usize, islands: usize) {
        if self.keeps_factors {
            self.solver_of_island.clear();
            self.solver_of_island.resize(islands, NONE);
            self.used_solvers = 0;
        }
        if self.rows_held > MOST_ROWS_HELD + MOST_ROWS_HELD_A_BOAT * boats {
            self.solvers.clear();
            self.rows_held = 0;
        }
        if self.solvers.is_empty() {
            self.solvers.push(IslandSolver::default());
        }
        self.indices.resize(boats, NONE);
    }

    /// Computes the opening rates of gaps at the free velocities, for all solves of a substep.
    pub(super) fn set_free(&mut self, problem: &ContactProblem) {
        let contacts = problem.contacts.iter();
        self.rates.clear();
        self.rates
            .extend(contacts.map(|contact| contact.gap_rate(problem.free)));
        for solver in &mut self.solvers[..self.used_solvers] {
            solver.set_free(problem);
        }
    }

    /// Solves the listed islands. Call [`Self::set_free`] first. In islands of one or two contacts, `velocities` must hold
    /// the free velocities.
    pub(super) fn solve(
        &mut self,
        problem: &ContactProblem,
        islands: &Islands,
        listed: &[u32],
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
    ) -> SolveReport {
        let rates = self.rates.iter().zip(problem.biases);
        self.rights.clear();
        self.rights.extend(rates.map(|(rate, bias)| rate + bias));
        let mut report = SolveReport::default();
        self.remaining.clear();
        for &number in listed {
            let contacts = islands.contacts(number as usize);
            if self.solve_directly(problem, contacts, active, impulses, velocities, &mut report) {
                report.iterations += 1;
            } else {
                self.remaining.push(number);
            }
        }
        self.solve_remaining(problem, islands, active, impulses, velocities, &mut report);
        report.converged = self.budget >= 0 && report.residual <= EXACT.max(self.regularization);
        report
    }

    /// Solves an island without a factor, if possible; returns whether it did.
    fn solve_directly(
        &self,
        problem: &ContactProblem,
        contacts: &[u32],
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) -> bool {
        if let &[single] = contacts {
            self.solve_single(
                problem,
                single as usize,
                active,
                impulses,
                velocities,
                report,
            );
            return true;
        }
        // Contacts that carry no impulse and do not close: their boats keep their free velocities.
        let is_idle = contacts
            .iter()
            .all(|&k| !active[k as usize] && self.rights[k as usize] >= 0.0);
        if is_idle {
            contacts.iter().for_each(|&k| impulses[k as usize] = 0.0);
            if contacts.len() > 2 {
                problem.reset_velocities(contacts, velocities);
            }
            return true;
        }
        let &[k, l] = contacts else { return false };
        let pair = [k as usize, l as usize];
        self.solve_two(problem, pair, active, impulses, velocities, report)
    }

    /// Solves the islands that no closed form solves.
    // Not inlined: inlining costs a jam 0.4 % more instructions.
    #[inline(never)]
    fn solve_remaining(
        &mut self,
        problem: &ContactProblem,
        islands: &Islands,
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) {
        for index in 0..self.remaining.len() {
            let number = self.remaining[index] as usize;
            let (solver, is_built) = self.solver_index(number);
            let island = &mut self.solvers[solver];
            if !is_built {
                let contacts = islands.contacts(number);
                let rows_before = island.rows.rows.capacity();
                island.build(problem, contacts, active, impulses, &mut self.indices);
                self.rows_held += island.rows.rows.capacity() - rows_before;
            }
            island.set_right(problem, &self.rights);
            island.factor.budget = self.budget;
            island.solve(self.regularization, report);
            self.budget = island.factor.budget;
            for (contact, is_active, impulse) in island.solution() {
                (active[contact as usize], impulses[contact as usize]) = (is_active, impulse);
            }
            for (boat, velocity) in island.velocities() {
                velocities[boat as usize] = velocity;
            }
        }
    }

    /// The index of an island's solver, and whether an earlier solve has already built the island's rows.
    #[inline]
    fn solver_index(&mut self, island: usize) -> (usize, bool) {
        if !self.keeps_factors {
            return (0, false);
        }
        let index = &mut self.solver_of_island[island];
        let is_built = *index != NONE;
        if !is_built {
            *index = self.used_solvers as u32;
            self.used_solvers += 1;
            if self.solvers.len() < self.used_solvers {
                self.solvers.push(IslandSolver::default());
            }
        }
        (*index as usize, is_built)
    }
}
