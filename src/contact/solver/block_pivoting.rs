//! The exact solver: block principal pivoting (Júdice and Pires 1994) on each island, warm-started
//! from the contacts that carried an impulse before, with Murty's single pivots as the fallback that
//! guarantees an end.

use super::envelope::{BoatLinks, EnvelopeFactor};
use super::{EXACT, SolveReport};
use crate::boat::Velocity;
use crate::contact::{ContactProblem, Islands};

/// Signs are judged with this tolerance in cm/s, well below [`EXACT`].
const TOLERANCE: f64 = 1e-11;
/// Rounds without fewer violations before single pivots take over.
const PATIENCE: u32 = 5;

/// Factors of all islands and scratch space.
#[derive(Debug, Clone)]
pub struct BlockPivoting {
    /// Added to the diagonal, relative to it, so that redundant contacts share their load.
    ridge: f64,
    factors: Vec<EnvelopeFactor>,
    links: BoatLinks,
    solution: Vec<f64>,
    slacks: Vec<f64>,
}

/// What the pivoting of one island works on.
struct IslandState<'a> {
    problem: &'a ContactProblem<'a>,
    contacts: &'a [u32],
    active: &'a mut [bool],
    impulses: &'a mut [f64],
    velocities: &'a mut [Velocity],
}

impl BlockPivoting {
    /// A solver with a relative ridge.
    pub fn new(ridge: f64) -> Self {
        Self {
            ridge,
            factors: Vec::new(),
            links: BoatLinks::default(),
            solution: Vec::new(),
            slacks: Vec::new(),
        }
    }

    /// Forgets the factors; so many islands come next.
    pub fn begin(&mut self, islands: usize) {
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
        velocities.clear();
        velocities.extend_from_slice(problem.free);
        self.links.reset(problem.free.len());
        let mut report = SolveReport {
            converged: true,
            ..SolveReport::default()
        };
        for island in 0..islands.len() {
            let contacts = islands.contacts(island);
            let mut state = IslandState {
                problem,
                contacts,
                active: &mut *active,
                impulses: &mut *impulses,
                velocities: &mut *velocities,
            };
            self.solve_island(island, &mut state, &mut report);
        }
        report.converged = report.residual <= EXACT.max(self.ridge);
        report
    }

    fn solve_island(&mut self, island: usize, state: &mut IslandState, report: &mut SolveReport) {
        let most_rounds = 50 + 4 * state.contacts.len();
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..most_rounds {
            report.iterations += 1;
            report.factored_rows += self.solve_active(island, state);
            let (violations, last) = self.count_violations(state);
            if violations == 0 {
                break;
            }
            if violations < fewest {
                (fewest, patience) = (violations, PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                let k = state.contacts[last] as usize;
                state.active[k] = !state.active[k];
                continue;
            }
            for (place, &k) in state.contacts.iter().enumerate() {
                let k = k as usize;
                if state.is_violated(k, self.slacks[place]) {
                    state.active[k] = !state.active[k];
                }
            }
        }
        report.factor_entries += self.factors[island].len() as u64;
        report.residual = report.residual.max(self.finish(state));
    }

    /// Impulses that close exactly the active gaps, and the slacks of all; returns factored rows.
    fn solve_active(&mut self, island: usize, state: &mut IslandState) -> u64 {
        let problem = state.problem;
        let members = state
            .contacts
            .iter()
            .copied()
            .filter(|&k| state.active[k as usize]);
        let factor = &mut self.factors[island];
        let rows = factor.update(problem, members.clone(), self.ridge, &mut self.links);
        self.solution.clear();
        self.solution
            .extend(members.map(|k| -problem.slack(k as usize, problem.free)));
        factor.solve(&mut self.solution);
        state.set_impulses(&self.solution);
        state.update_slacks(&mut self.slacks);
        // The ridge and rounding leave a remainder at the active contacts; one more solve removes it.
        // A softened problem is meant to give way.
        let worst = state.worst_active_slack(&self.slacks);
        if worst > TOLERANCE && self.ridge < TOLERANCE {
            let mut correction: Vec<f64> = state.active_slacks(&self.slacks).map(|w| -w).collect();
            factor.solve(&mut correction);
            self.solution
                .iter_mut()
                .zip(&correction)
                .for_each(|(x, dx)| *x += dx);
            state.set_impulses(&self.solution);
            state.update_slacks(&mut self.slacks);
        }
        rows
    }

    /// How many contacts pull, or overlap although they carry nothing; and the last of them.
    fn count_violations(&self, state: &IslandState) -> (usize, usize) {
        let mut count = 0;
        let mut last = 0;
        for (place, &k) in state.contacts.iter().enumerate() {
            if state.is_violated(k as usize, self.slacks[place]) {
                count += 1;
                last = place;
            }
        }
        (count, last)
    }

    /// Drops impulses that are negative by rounding, and returns the island's natural residual.
    fn finish(&mut self, state: &mut IslandState) -> f64 {
        let mut dropped = false;
        for &k in state.contacts {
            let k = k as usize;
            if state.impulses[k] < 0.0 {
                state.impulses[k] = 0.0;
                state.active[k] = false;
                dropped = true;
            }
        }
        if dropped {
            state.apply_impulses();
            state.update_slacks(&mut self.slacks);
        }
        let softness = if self.ridge < TOLERANCE {
            0.0
        } else {
            self.ridge
        };
        let residual = |(&k, &slack): (&u32, &f64)| {
            let load = state.problem.diagonal(k as usize) * state.impulses[k as usize];
            load.min(slack + softness * load).abs()
        };
        // A NaN must not be lost in a maximum.
        state
            .contacts
            .iter()
            .zip(&self.slacks)
            .map(residual)
            .fold(0.0, |worst, value| {
                if value > worst || value.is_nan() {
                    value
                } else {
                    worst
                }
            })
    }
}

impl IslandState<'_> {
    fn is_violated(&self, k: usize, slack: f64) -> bool {
        if self.active[k] {
            self.impulses[k] * self.problem.diagonal(k) < -TOLERANCE
        } else {
            slack < -TOLERANCE
        }
    }

    fn set_impulses(&mut self, solution: &[f64]) {
        let mut values = solution.iter();
        for &k in self.contacts {
            let k = k as usize;
            let value = if self.active[k] { values.next() } else { None };
            self.impulses[k] = value.copied().unwrap_or(0.0);
        }
        self.apply_impulses();
    }

    /// Velocities of the island's boats from its impulses.
    fn apply_impulses(&mut self) {
        for &k in self.contacts {
            let contact = &self.problem.contacts[k as usize];
            let first = contact.boat as usize;
            self.velocities[first] = self.problem.free[first];
            if let Some(second) = contact.second() {
                self.velocities[second] = self.problem.free[second];
            }
        }
        for &k in self.contacts {
            let impulse = self.impulses[k as usize];
            if impulse != 0.0 {
                self.problem.apply(k as usize, impulse, self.velocities);
            }
        }
    }

    fn update_slacks(&self, slacks: &mut Vec<f64>) {
        slacks.clear();
        slacks.extend(
            self.contacts
                .iter()
                .map(|&k| self.problem.slack(k as usize, self.velocities)),
        );
    }

    fn active_slacks<'s>(&'s self, slacks: &'s [f64]) -> impl Iterator<Item = f64> + 's {
        let pairs = self.contacts.iter().zip(slacks);
        pairs
            .filter(|(k, _)| self.active[**k as usize])
            .map(|(_, &slack)| slack)
    }

    fn worst_active_slack(&self, slacks: &[f64]) -> f64 {
        self.active_slacks(slacks).map(f64::abs).fold(0.0, f64::max)
    }
}
