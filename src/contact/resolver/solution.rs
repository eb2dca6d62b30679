//! Solves the contacts of a substep until a solution passes the checks.

use super::{ContactResolver, Motion};
use crate::contact::passivity;
use crate::contact::{CachedImpulse, Statistics};
use crate::parameters::Solver;

/// Reason why a substep was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NotTaken {
    /// The substep leaves overlaps, its contacts would add energy to boats or are too much work, or a boat moves too
    /// far. A shorter substep has to be tried. Poses may have been moved to undo deep overlaps, but no time has passed.
    TooLong,
    /// The contacts are too much work, and a shorter substep must not be tried or has no work left. The motion must be
    /// discarded.
    Exhausted,
}

/// Reasons for which a substep may be shortened.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Divisibility {
    /// Whether it may be shortened if contacts would add energy to boats, or are too much work.
    pub if_driven: bool,
    /// Whether it may be shortened if overlaps remain at the substep's end.
    pub if_overlapping: bool,
}

/// Outcome of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Solution {
    /// The solve converged, and no check has failed.
    Solved,
    /// The work budget was spent before a solution was found.
    Exhausted,
    /// Contacts overlap at the substep's end by more than the tolerance, or their constraints contradict each other.
    Overlapping,
    /// Skipped contacts overlap at the substep's end by more than the tolerance.
    SkippedOverlapping,
    /// Contacts would add energy to boats. The biases have been changed so that the next solve adds none.
    Driven,
}

impl ContactResolver {
    /// Solves the contacts found last. `solver` then holds the impulses and velocities.
    ///
    /// # Errors
    /// [`NotTaken`]. Then the warm start is that of the substep before.
    pub(crate) fn resolve(
        &mut self,
        motion: &Motion,
        divisibility: Divisibility,
        statistics: &mut Statistics,
    ) -> Result<(), NotTaken> {
        self.solver.reserve_budget(divisibility.if_driven);
        if self.solver.is_exhausted() {
            return Err(NotTaken::Exhausted);
        }
        let leaves_overlaps = self.solve_until_accepted(motion, divisibility, statistics)?;
        let mut is_unsolved = leaves_overlaps || self.is_deep;
        // The paper's scheme has linear gaps and its own tolerance. It gives no velocities before the substep.
        let limits_overlaps = self.relinearization.is_on() && motion.before.is_some();
        if limits_overlaps && !is_unsolved {
            let tolerance = self.relinearization.tolerance;
            is_unsolved =
                self.predicted
                    .overlaps_undetected(&mut self.detector, &self.contacts, tolerance);
            if is_unsolved && divisibility.if_overlapping {
                return Err(NotTaken::TooLong);
            }
        }
        let velocities = &self.solver.velocities;
        if self.detector.moves_too_far(velocities, motion.dt) {
            return Err(NotTaken::TooLong);
        }
        statistics.unsolved += u64::from(is_unsolved);
        let impulses = self.solver.impulses.iter();
        let entries = self.contacts.iter().zip(impulses);
        self.warm_start_cache
            .replace(entries.map(|(contact, &impulse)| CachedImpulse::new(contact, impulse)));
        Ok(())
    }

    /// Solves until a solution passes the checks, or no further attempt can help. Returns whether overlaps remain. If a
    /// check fails, skipped contacts are restored, or the caller takes a shorter substep.
    fn solve_until_accepted(
        &mut self,
        motion: &Motion,
        divisibility: Divisibility,
        statistics: &mut Statistics,
    ) -> Result<bool, NotTaken> {
        loop {
            match self.solve_and_check(motion, statistics) {
                Solution::Solved => return Ok(false),
                Solution::SkippedOverlapping => self.restore_skipped(statistics),
                Solution::Exhausted | Solution::Driven if divisibility.if_driven => {
                    return Err(NotTaken::TooLong);
                }
                Solution::Overlapping if divisibility.if_overlapping => {
                    return Err(NotTaken::TooLong);
                }
                Solution::Exhausted => return Err(NotTaken::Exhausted),
                // With other biases boats move elsewhere, so the skipped contacts have to be checked again.
                Solution::Driven if !self.skipped.is_empty() => self.restore_skipped(statistics),
                Solution::Driven => {
                    if self.solve(None, motion, statistics) == Solution::Exhausted {
                        return Err(NotTaken::Exhausted);
                    }
                    let is_overlapping = self.leaves_overlaps(motion);
                    if is_overlapping && divisibility.if_overlapping {
                        return Err(NotTaken::TooLong);
                    }
                    return Ok(is_overlapping);
                }
                Solution::Overlapping => return Ok(true),
            }
        }
    }

    /// Adds the skipped contacts to the problem again.
    fn restore_skipped(&mut self, statistics: &mut Statistics) {
        statistics.contacts += self.skipped.restore(&mut self.contacts);
        self.warm_start();
    }

    /// Solves the contacts that are not skipped, and checks the solution: the gaps at the substep's end, the skipped
    /// contacts, and the energy.
    fn solve_and_check(&mut self, motion: &Motion, statistics: &mut Statistics) -> Solution {
        self.fill_biases(motion);
        self.solver.reset(motion.free.len(), &self.contacts);
        let mut solution = self.solve(None, motion, statistics);
        if solution == Solution::Overlapping && self.look_ahead_along_all_curves(motion) {
            self.warm_start();
            self.solver.reset(motion.free.len(), &self.contacts);
            solution = self.solve(None, motion, statistics);
        }
        if self.relinearization.is_on() && solution != Solution::Exhausted {
            solution = self.relinearize(motion, solution, statistics);
        }
        if solution == Solution::Exhausted {
            return solution;
        }
        let tolerance = self.relinearization.tolerance;
        let (predicted, detector) = (&self.predicted, &self.detector);
        let velocities = &self.solver.velocities;
        let skipped = &self.skipped;
        if !skipped.stay_open(predicted, detector, velocities, motion.dt, tolerance) {
            return Solution::SkippedOverlapping;
        }
        if self.stop_driving(motion) {
            return Solution::Driven;
        }
        solution
    }

    /// If contacts may add energy, finds the islands whose contacts do or reverse a boat's turn, and recomputes their
    /// velocity biases from the present gaps alone. Returns whether there are such islands.
    fn stop_driving(&mut self, motion: &Motion) -> bool {
        let bias = self.bias(motion);
        let problem = motion.problem(&self.contacts, &self.biases);
        if !passivity::may_add_energy(&problem, &self.solver.impulses, bias) {
            return false;
        }
        let has_obstacles = !self.detector.obstacles.obstacles.is_empty();
        let passivity = &mut self.passivity;
        let driven = passivity.driven_contacts(&self.solver, &problem, bias, has_obstacles);
        for &k in &driven {
            self.biases[k] = bias.for_gap(&self.contacts[k].gap);
        }
        !driven.is_empty()
    }

    /// Solves all islands, or the listed ones again. Returns [`Solution::Solved`] or [`Solution::Exhausted`]. If
    /// constraints contradict each other, it returns [`Solution::Overlapping`] and the velocities of the nearest
    /// problem that has a solution.
    pub(super) fn solve(
        &mut self,
        islands: Option<&[u32]>,
        motion: &Motion,
        statistics: &mut Statistics,
    ) -> Solution {
        self.predicted.set_outdated();
        let Self {
            contacts,
            biases,
            solver,
            ..
        } = self;
        let problem = motion.problem(contacts, biases);
        let report = match islands {
            Some(islands) => solver.solve_again(&problem, islands),
            None => solver.solve(&problem),
        };
        if solver.is_exhausted() {
            return Solution::Exhausted;
        }
        statistics.count(&report);
        if report.converged {
            return Solution::Solved;
        }
        // The overlaps cannot all be undone within the substep. Without negative biases none has to be: boats at rest then
        // satisfy every constraint, and impulses stay bounded.
        biases.iter_mut().for_each(|bias| *bias = bias.max(0.0));
        let problem = motion.problem(contacts, biases);
        let is_solved = solver.solve(&problem).converged;
        if !is_solved && !solver.is_exhausted() {
            solver.impulses.fill(0.0);
            solver.solve_as(Solver::GaussSeidel, &problem);
        }
        if solver.is_exhausted() {
            return Solution::Exhausted;
        }
        Solution::Overlapping
    }
}
