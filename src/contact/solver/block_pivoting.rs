//! The exact solver: block principal pivoting (Júdice and Pires 1994) on each island, warm-started
//! from the contacts that carried an impulse before, with a descent as the fallback that guarantees an
//! end.

mod closed_forms;
mod descent;
mod factor;
mod island_solver;
mod rows;

use super::{EXACT, SolveReport};
use crate::contact::{ContactProblem, Islands};
use crate::geometry::Velocity;
use crate::parallel;
use island_solver::IslandSolver;
use rows::NONE;
use std::cmp::Reverse;

/// The solvers of islands.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockPivoting {
    /// Added to the diagonal, relative to it, so that redundant contacts share their impulse.
    regularization: f64,
    /// Whether each island keeps its factor for another solve. Otherwise all share one solver, whose memory stays
    /// in the processor's cache.
    pub keeps_factors: bool,
    islands: Vec<IslandSolver>,
    /// b, contact by contact.
    rights: Vec<f64>,
    /// The islands that no closed form solves.
    left: Vec<u32>,
    /// One for each thread that islands are shared out to.
    workers: Vec<Worker>,
}

/// What a thread needs to solve islands, and what it has solved: memory that other threads touch is slow.
#[derive(Debug, Clone, Default)]
struct Worker {
    /// The solver of islands that keep none.
    solver: IslandSolver,
    /// Where each boat is among the bodies of an island that is being built; [`NONE`] between two.
    places: Vec<u32>,
    report: SolveReport,
    /// Contacts, whether they are active, and their impulses.
    contacts: Vec<(u32, bool, f64)>,
    velocities: Vec<(u32, Velocity)>,
}

impl Worker {
    fn clear(&mut self) {
        self.report = SolveReport::default();
        self.contacts.clear();
        self.velocities.clear();
    }
}

/// Contacts, in islands that no closed form solves, below which sharing them out takes longer than it saves.
const SHARED_CONTACTS: usize = 128;

impl BlockPivoting {
    /// A solver with a relative regularization.
    pub(super) fn new(regularization: f64) -> Self {
        Self {
            regularization,
            workers: vec![Worker::default()],
            ..Self::default()
        }
    }

    /// Has islands shared out to so many threads.
    pub(crate) fn set_threads(&mut self, threads: usize) {
        self.workers.resize_with(threads.max(1), Worker::default);
    }

    /// Forgets the factors; so many islands of so many boats come next.
    pub(super) fn reset(&mut self, boats: usize, islands: usize) {
        let solvers = if self.keeps_factors { islands } else { 1 };
        if self.islands.len() < solvers {
            self.islands.resize_with(solvers, IslandSolver::default);
        }
        for island in &mut self.islands {
            island.is_built = false;
        }
        for worker in &mut self.workers {
            worker.places.resize(boats, NONE);
        }
    }

    /// Solves all islands.
    pub(super) fn solve(
        &mut self,
        problem: &ContactProblem,
        islands: &Islands,
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut Vec<Velocity>,
    ) -> SolveReport {
        velocities.clear();
        velocities.extend_from_slice(problem.free);
        self.rights.clear();
        let contacts = problem.contacts.iter().zip(problem.biases);
        self.rights
            .extend(contacts.map(|(contact, bias)| contact.gap_rate(problem.free) + bias));
        let mut report = SolveReport::default();
        self.left.clear();
        for number in 0..islands.len() {
            let contacts = islands.contacts(number);
            if self.solve_directly(problem, contacts, active, impulses, velocities, &mut report) {
                report.iterations += 1;
            } else {
                self.left.push(number as u32);
            }
        }
        if self.is_worth_sharing(islands) {
            self.solve_shared(problem, islands, active, impulses, velocities, &mut report);
        } else {
            self.solve_in_turn(problem, islands, active, impulses, velocities, &mut report);
        }
        report.converged = report.residual <= EXACT.max(self.regularization);
        report
    }

    /// Solves an island without a factor; returns whether that is possible.
    fn solve_directly(
        &self,
        problem: &ContactProblem,
        contacts: &[u32],
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) -> bool {
        if let &[alone] = contacts {
            self.solve_alone(
                problem,
                alone as usize,
                active,
                impulses,
                velocities,
                report,
            );
            return true;
        }
        // Contacts that neither carry nor close anything: their boats move as they are.
        let is_idle = contacts
            .iter()
            .all(|&k| !active[k as usize] && self.rights[k as usize] >= 0.0);
        if is_idle {
            contacts.iter().for_each(|&k| impulses[k as usize] = 0.0);
            return true;
        }
        let &[k, l] = contacts else { return false };
        let pair = [k as usize, l as usize];
        self.solve_two(problem, pair, active, impulses, velocities, report)
    }

    /// Whether the islands that are left keep more than one thread busy.
    fn is_worth_sharing(&self, islands: &Islands) -> bool {
        if self.workers.len() < 2 || self.left.len() < 2 {
            return false;
        }
        let sizes = self
            .left
            .iter()
            .map(|&number| islands.range(number as usize).len());
        sizes.sum::<usize>() >= SHARED_CONTACTS
    }

    /// Solves the islands that are left one after the other.
    fn solve_in_turn(
        &mut self,
        problem: &ContactProblem,
        islands: &Islands,
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) {
        let places = &mut self.workers[0].places;
        for &number in &self.left {
            let number = number as usize;
            let island = &mut self.islands[if self.keeps_factors { number } else { 0 }];
            island.is_built &= self.keeps_factors;
            let contacts = islands.contacts(number);
            island.build(problem, contacts, active, impulses, places);
            island.set_right(problem, &self.rights);
            island.solve(self.regularization, report);
            for (contact, is_active, impulse) in island.solution() {
                (active[contact as usize], impulses[contact as usize]) = (is_active, impulse);
            }
            for (boat, velocity) in island.velocities() {
                velocities[boat as usize] = velocity;
            }
        }
    }

    /// Solves the islands that are left on several threads, the largest first. An island's solution depends neither
    /// on the thread nor on what else that has solved.
    fn solve_shared(
        &mut self,
        problem: &ContactProblem,
        islands: &Islands,
        active: &mut [bool],
        impulses: &mut [f64],
        velocities: &mut [Velocity],
        report: &mut SolveReport,
    ) {
        self.left.sort_unstable_by_key(|&number| {
            (Reverse(islands.range(number as usize).len()), number)
        });
        let mut solvers: Vec<_> = self.islands.iter_mut().map(Some).collect();
        let keeps_factors = self.keeps_factors;
        let tasks = self.left.iter().map(|&number| {
            let solver = keeps_factors.then(|| solvers[number as usize].take());
            (islands.contacts(number as usize), solver.flatten())
        });
        let (rights, regularization) = (&self.rights, self.regularization);
        self.workers.iter_mut().for_each(Worker::clear);
        parallel::hand_out(&mut self.workers, tasks, |worker, (contacts, solver)| {
            let island = match solver {
                Some(island) => island,
                None => {
                    worker.solver.is_built = false;
                    &mut worker.solver
                }
            };
            island.build(problem, contacts, active, impulses, &mut worker.places);
            island.set_right(problem, rights);
            island.solve(regularization, &mut worker.report);
            worker.contacts.extend(island.solution());
            worker.velocities.extend(island.velocities());
        });
        for worker in &self.workers {
            report.add(&worker.report);
            for &(contact, is_active, impulse) in &worker.contacts {
                (active[contact as usize], impulses[contact as usize]) = (is_active, impulse);
            }
            for &(boat, velocity) in &worker.velocities {
                velocities[boat as usize] = velocity;
            }
        }
    }
}
