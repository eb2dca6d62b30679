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
use crate::geometry::{Vec2, Velocity};
use island_solver::IslandSolver;
use rows::NONE;

/// The solvers of islands.
#[derive(Debug, Clone, Default)]
pub struct BlockPivoting {
    /// Added to the diagonal, relative to it, so that redundant contacts share their impulse.
    regularization: f64,
    /// Whether each island keeps its factor for another solve. Otherwise all share one solver, whose memory stays
    /// in the processor's cache.
    pub keeps_factors: bool,
    islands: Vec<IslandSolver>,
    /// b, contact by contact.
    rights: Vec<f64>,
    /// Where each boat is among the bodies of an island that is being built; [`NONE`] between two.
    places: Vec<u32>,
}

impl BlockPivoting {
    /// A solver with a relative regularization.
    pub fn new(regularization: f64) -> Self {
        Self {
            regularization,
            ..Self::default()
        }
    }

    /// Forgets the factors; so many islands of so many boats come next.
    pub fn reset(&mut self, boats: usize, islands: usize) {
        let solvers = if self.keeps_factors { islands } else { 1 };
        if self.islands.len() < solvers {
            self.islands.resize_with(solvers, IslandSolver::default);
        }
        for island in &mut self.islands[..solvers] {
            island.is_built = false;
        }
        self.places.resize(boats, NONE);
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
        velocities.clear();
        velocities.extend_from_slice(problem.free);
        self.rights.clear();
        let contacts = problem.contacts.iter().zip(problem.biases);
        self.rights
            .extend(contacts.map(|(contact, bias)| contact.gap_rate(problem.free) + bias));
        let mut report = SolveReport::default();
        for number in 0..islands.len() {
            let contacts = islands.contacts(number);
            if let &[alone] = contacts {
                report.iterations += 1;
                self.solve_alone(
                    problem,
                    alone as usize,
                    active,
                    impulses,
                    velocities,
                    &mut report,
                );
                continue;
            }
            // Contacts that neither carry nor close anything: their boats move as they are.
            let is_idle = contacts
                .iter()
                .all(|&k| !active[k as usize] && self.rights[k as usize] >= 0.0);
            if is_idle {
                report.iterations += 1;
                contacts.iter().for_each(|&k| impulses[k as usize] = 0.0);
                continue;
            }
            if let &[k, l] = contacts
                && self.solve_two(
                    problem,
                    [k, l].map(|k| k as usize),
                    active,
                    impulses,
                    velocities,
                    &mut report,
                )
            {
                report.iterations += 1;
                continue;
            }
            let island = &mut self.islands[if self.keeps_factors { number } else { 0 }];
            island.is_built &= self.keeps_factors;
            island.build(problem, contacts, active, impulses, &mut self.places);
            island.set_right(problem, &self.rights);
            island.solve(self.regularization, &mut report);
            for row in &island.rows.rows {
                active[row.contact as usize] = row.is_active;
                impulses[row.contact as usize] = row.impulse;
            }
            for body in &island.rows.bodies {
                if let Some(velocity) = velocities.get_mut(body.boat as usize) {
                    let [x, y, angular] = body.velocity;
                    *velocity = Velocity {
                        linear: Vec2::new(x, y),
                        angular,
                    };
                }
            }
        }
        report.converged = report.residual <= EXACT.max(self.regularization);
        report
    }
}
