//! From free velocities to velocities that respect the contacts: detection, warm start, solution,
//! relinearization, and the fallback if constraints contradict each other.

mod biases;
mod relinearization;

use super::depenetration::{
    Depenetration, PENETRATION_SLOP, orbital_angular_momentum, smallest_gap,
};
use super::passivity::{self, Passivity};
use super::predicted_poses::PredictedPoses;
use super::skipped_contacts::SkippedContacts;
use super::solver::ContactSolver;
use super::warm_start::{CachedImpulse, WarmStartCache};
use super::{Contact, ContactDetector, ContactProblem, InverseInertia, Statistics};
use crate::clock::{seconds, ticks};
use crate::geometry::{HullPose, Pose, Vec2, Velocity};
use crate::parameters::{FlockParameters, Scheme, Solver};
use relinearization::Relinearization;

/// Reason why a substep was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NotTaken {
    /// It leaves overlaps, would drive boats, or moves a boat too far: a shorter one has to be tried. Deep overlaps may
    /// have been undone, but no time has passed.
    TooLong,
    /// Its contacts are too much work, and a shorter substep would not help; the motion must be discarded.
    Exhausted,
}

/// Reasons for which a substep may be shortened.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Divisibility {
    /// Contacts would drive boats, or are too much work.
    pub if_driven: bool,
    /// Overlaps are left.
    pub if_overlapping: bool,
}

/// Outcome of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Solution {
    /// No gap closes beyond the tolerance.
    Solved,
    /// The work budget was spent before a solution was found.
    Exhausted,
    /// Contacts overlap at the substep's end by more than the tolerance.
    Overlapping,
    /// Skipped contacts overlap at the substep's end by more than the tolerance.
    Closing,
    /// Contacts would add energy to boats; the biases are now such that they do not.
    Driven,
}

/// The motion of a substep before its contacts are solved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion<'a> {
    /// Poses at the substep's start.
    pub poses: &'a [Pose],
    /// The hulls at these poses.
    pub hulls: &'a [HullPose],
    /// Velocities before the substep; `None` where gaps are taken as linear.
    pub before: Option<&'a [Velocity]>,
    /// Velocities without contacts.
    pub free: &'a [Velocity],
    /// Effective inertia.
    pub inertia: &'a [InverseInertia],
    /// Length of the substep in s.
    pub dt: f64,
}

impl<'a> Motion<'a> {
    fn problem(&self, contacts: &'a [Contact], biases: &'a [f64]) -> ContactProblem<'a> {
        ContactProblem {
            contacts,
            inertia: self.inertia,
            free: self.free,
            biases,
        }
    }
}

/// Finds and solves the contacts of a flock, substep after substep.
#[derive(Debug, Clone)]
pub(crate) struct ContactResolver {
    /// Geometry of the flock and its pool.
    pub(crate) detector: ContactDetector,
    /// Impulses of the contacts found last, in cm/s. Its velocities hold only until the substep takes them.
    pub(crate) solver: ContactSolver,
    /// The contacts found last.
    pub(crate) contacts: Vec<Contact>,
    /// Contacts that are skipped as long as the solution keeps them open.
    skipped: SkippedContacts,
    biases: Vec<f64>,
    /// Whether each contact carried an impulse in the substep before.
    persistent: Vec<bool>,
    /// Contacts that carried an impulse, in the order of detection.
    warm_start_cache: WarmStartCache,
    depenetration: Box<Depenetration>,
    passivity: Passivity,
    predicted: PredictedPoses,
    relinearization: Relinearization,
    /// Overlaps beyond this (cm) are undone by moving poses.
    penetration_slop: f64,
    /// Whether moving poses has left overlaps beyond that.
    is_deep: bool,
    /// Length of a whole substep in s. An overlap has to open within this time, however short a substep is.
    whole_substep_s: f64,
}

impl ContactResolver {
    /// A resolver for checked parameters.
    pub(crate) fn new(parameters: &FlockParameters) -> Self {
        let penetration_slop = PENETRATION_SLOP * parameters.boat_radius_cm;
        Self {
            detector: ContactDetector::new(parameters),
            solver: ContactSolver::new(parameters.solver)
                .keeping_factors(parameters.tolerance_cm < f64::INFINITY),
            contacts: Vec::new(),
            skipped: SkippedContacts::default(),
            biases: Vec::new(),
            persistent: Vec::new(),
            warm_start_cache: WarmStartCache::default(),
            depenetration: Box::new(Depenetration::new(parameters)),
            passivity: Passivity::default(),
            predicted: PredictedPoses::default(),
            relinearization: Relinearization::new(parameters),
            // Overlaps that the paper's scheme accepts are left alone.
            penetration_slop: match parameters.scheme {
                Scheme::Paper => penetration_slop.max(2.0 * parameters.overlap_tolerance_cm),
                Scheme::Leapfrog | Scheme::Moreau => penetration_slop,
            },
            is_deep: false,
            whole_substep_s: seconds(ticks(parameters.dt_s)),
        }
    }

    /// Sets the length in s of a whole substep.
    pub(crate) fn set_whole_substep(&mut self, dt_s: f64) {
        self.whole_substep_s = seconds(ticks(dt_s));
        self.detector.set_whole_substep(dt_s);
    }

    /// Impulses of the last substep's contacts; some are zero.
    pub(crate) fn warm_start_impulses(&self) -> &[CachedImpulse] {
        self.warm_start_cache.impulses()
    }

    /// Restores impulses that [`Self::warm_start_impulses`] returned.
    pub(crate) fn set_warm_start(&mut self, impulses: &[CachedImpulse]) {
        self.warm_start_cache.replace(impulses.iter().copied());
    }

    /// Clears contacts, impulses and the neighbor list, after poses were set from outside.
    pub(crate) fn forget(&mut self) {
        self.contacts.clear();
        self.solver.impulses.clear();
        self.warm_start_cache.clear();
        self.detector.neighbors.clear();
    }

    /// Finds the contacts that matter within `dt` at these velocities. Deep overlaps are undone first,
    /// by moving poses. Returns whether there is any contact.
    pub(crate) fn find(
        &mut self,
        poses: &mut [Pose],
        boats: &mut Vec<HullPose>,
        velocities: &[Velocity],
        dt: f64,
        statistics: &mut Statistics,
    ) -> bool {
        self.predicted.set_outdated();
        let builds_before = self.detector.neighbors.builds();
        let margin = self
            .detector
            .detect_moving(boats, velocities, dt, &mut self.contacts);
        let smallest = smallest_gap(&self.contacts).min(0.0);
        self.is_deep = false;
        statistics.worst_overlap_cm = statistics.worst_overlap_cm.max(-smallest);
        if smallest < -self.penetration_slop {
            self.depenetrate(poses, boats, velocities, margin, statistics);
            self.is_deep = smallest_gap(&self.contacts) < -self.penetration_slop;
        }
        self.skipped.clear();
        if self.relinearization.is_on() && self.detector.is_far() {
            self.skipped
                .skip_open(&self.detector, velocities, dt, &mut self.contacts);
        }
        statistics.contacts += self.contacts.len() as u64;
        statistics.neighbor_builds += self.detector.neighbors.builds() - builds_before;
        self.warm_start();
        !self.contacts.is_empty()
    }

    /// Undoes deep overlaps, and finds the contacts nearer than `margin` again.
    fn depenetrate(
        &mut self,
        poses: &mut [Pose],
        boats: &mut Vec<HullPose>,
        velocities: &[Velocity],
        margin: f64,
        statistics: &mut Statistics,
    ) {
        let depenetration = &mut self.depenetration;
        depenetration.solver.share_budget(&self.solver);
        let passes = depenetration.passes;
        let angular_momentum = orbital_angular_momentum(poses, velocities);
        depenetration.open_overlaps(
            &mut self.detector,
            poses,
            boats,
            0.1 * self.penetration_slop,
            margin,
            &mut self.contacts,
        );
        self.solver.share_budget(&depenetration.solver);
        statistics.depenetration_passes += depenetration.passes - passes;
        statistics.displaced_angular_momentum_cm2_s +=
            (orbital_angular_momentum(poses, velocities) - angular_momentum).abs();
    }

    /// Guesses that the contacts that carried an impulse in the last substep do so again.
    fn warm_start(&mut self) {
        self.warm_start_cache
            .lookup(&self.contacts, &mut self.solver.impulses);
        self.persistent.clear();
        self.persistent
            .extend(self.solver.impulses.iter().map(|&impulse| impulse > 0.0));
        self.solver.active.clone_from(&self.persistent);
    }

    /// Whether one of the contacts found last overlaps by more than `allowed` after boats move with these velocities for
    /// `dt`.
    pub(crate) fn overlaps_after(
        &mut self,
        poses: &[Pose],
        velocities: &[Velocity],
        dt: f64,
        allowed: f64,
    ) -> bool {
        self.predicted
            .predict(poses, velocities, dt, self.detector.hull());
        self.predicted
            .overlaps(&self.detector, &self.contacts, allowed)
    }

    /// Solves the contacts found last for free velocities and effective inertia; the result is in `solver`.
    ///
    /// # Errors
    /// [`NotTaken`]; nothing but the statistics has changed then.
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
        let mut is_unsolved = self.settle(motion, divisibility, statistics)? || self.is_deep;
        let is_promised = self.relinearization.is_on() && motion.before.is_some();
        if is_promised && !is_unsolved {
            let tolerance = self.relinearization.tolerance;
            is_unsolved =
                self.predicted
                    .overlaps_unseen(&mut self.detector, &self.contacts, tolerance);
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

    /// Solves until a solution passes the checks; returns whether it leaves overlaps. If a check fails, skipped
    /// contacts are restored, or the caller takes a shorter substep.
    fn settle(
        &mut self,
        motion: &Motion,
        divisibility: Divisibility,
        statistics: &mut Statistics,
    ) -> Result<bool, NotTaken> {
        loop {
            match self.solve_and_check(motion, statistics) {
                Solution::Solved => return Ok(false),
                Solution::Closing => self.restore_skipped(statistics),
                Solution::Exhausted | Solution::Driven if divisibility.if_driven => {
                    return Err(NotTaken::TooLong);
                }
                Solution::Overlapping if divisibility.if_overlapping => {
                    return Err(NotTaken::TooLong);
                }
                Solution::Exhausted => return Err(NotTaken::Exhausted),
                // With other biases boats move elsewhere, and there skipped contacts were not checked.
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
        if solution == Solution::Overlapping && self.look_ahead_along_all(motion) {
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
            return Solution::Closing;
        }
        if self.stop_driving(motion) {
            return Solution::Driven;
        }
        solution
    }

    /// Finds the islands that contacts would drive or turn back, and computes their velocity biases from the present
    /// gaps alone. Returns whether there are such islands.
    fn stop_driving(&mut self, motion: &Motion) -> bool {
        let bias = self.bias(motion);
        let problem = motion.problem(&self.contacts, &self.biases);
        if !passivity::may_drive(&problem, &self.solver.impulses, bias) {
            return false;
        }
        let has_obstacles = !self.detector.obstacles.obstacles.is_empty();
        let passivity = &mut self.passivity;
        let driven = passivity.driven(&self.solver, &problem, bias, has_obstacles);
        for &k in &driven {
            self.biases[k] = bias.of_gap(&self.contacts[k].gap);
        }
        !driven.is_empty()
    }

    /// Solves some islands again, or all: [`Solution::Solved`], [`Solution::Exhausted`], or [`Solution::Overlapping`]
    /// where the constraints contradict each other. Then the velocities are those of the nearest problem that has a
    /// solution.
    fn solve(
        &mut self,
        again: Option<&[u32]>,
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
        let report = match again {
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
        // Overlaps that cannot all close within the substep contradict each other. Without them, rest
        // satisfies every constraint, and impulses stay bounded.
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

    /// Moves the boats to the end of the solved substep, if the prediction is up to date.
    pub(crate) fn take_end(&mut self, poses: &mut Vec<Pose>, hulls: &mut Vec<HullPose>) -> bool {
        self.predicted.take_end(poses, hulls)
    }

    /// Forgets the impulses, because nothing touched in this substep.
    pub(crate) fn clear_warm_start(&mut self) {
        self.warm_start_cache.clear();
        self.solver.impulses.fill(0.0);
    }

    /// Adds to each boat the linear acceleration from contacts that carried an impulse both in this kick, of length
    /// `dt`, and in the one before. Such contacts are likely to persist.
    pub(crate) fn add_persistent_acceleration(
        &self,
        inertia: &[InverseInertia],
        dt: f64,
        sums: &mut [Vec2],
    ) {
        for (k, contact) in self.contacts.iter().enumerate() {
            let impulse = self.solver.impulses[k];
            if !self.persistent[k] || impulse <= 0.0 {
                continue;
            }
            let push = contact.gap.normal * (impulse / dt);
            let first = contact.boat as usize;
            sums[first] += push * inertia[first].linear;
            if let Some(second) = contact.second() {
                sums[second] -= push * inertia[second].linear;
            }
        }
    }
}
