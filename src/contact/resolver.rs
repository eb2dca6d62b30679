//! From free velocities to velocities that respect the contacts: detection, warm start, solution,
//! relinearization, and what to do where the constraints contradict each other.

mod relinearization;

use super::depenetration::{Depenetration, PENETRATION_SLOP, orbital_angular_momentum};
use super::parting::Parting;
use super::passivity::{self, Passivity};
use super::solver::ContactSolver;
use super::trial::Trial;
use super::velocity_bias::VelocityBias;
use super::warm_start::{CachedImpulse, WarmStartCache};
use super::{Contact, ContactDetector, ContactProblem, InverseInertia, Statistics};
use crate::clock::{seconds, ticks};
use crate::geometry::{HullPose, Pose, Vec2, Velocity};
use crate::parameters::{FlockParameters, Scheme, Solver};
use relinearization::Relinearization;

/// What the contacts of a substep came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ContactOutcome {
    /// Nothing is near enough to touch within the substep.
    Untouched,
    /// The contacts have been solved.
    Solved,
    /// Contacts turn too far within the substep, and a shorter one is possible; or a boat moves too far in it.
    TooLong,
}

/// Finds and solves the contacts of a flock, substep after substep.
#[derive(Debug, Clone)]
pub(crate) struct ContactResolver {
    /// Geometry of the flock and its pool.
    pub(crate) detector: ContactDetector,
    /// Impulses of the contacts found last, in cm/s, and the velocities of the last solve.
    pub(crate) solver: ContactSolver,
    /// The contacts found last.
    pub(crate) contacts: Vec<Contact>,
    /// Those that are left out while the solution leaves them apart.
    parting: Parting,
    biases: Vec<f64>,
    /// Whether each contact carried an impulse in the substep before.
    persistent: Vec<bool>,
    /// Contacts that carried an impulse, in the order of detection.
    warm_start_cache: WarmStartCache,
    depenetration: Option<Box<Depenetration>>,
    /// Whether the contacts of this substep were too much work, and a shorter one would not help.
    pub(crate) is_exhausted: bool,
    passivity: Passivity,
    trial: Trial,
    relinearization: Relinearization,
    boat_radius: f64,
    gyration_radius: f64,
    /// Overlaps beyond this (cm) are undone by moving poses.
    penetration_slop: f64,
    /// Length of a whole substep in s: what an overlap has to close in, however short a substep is.
    whole_substep_s: f64,
}

impl ContactResolver {
    /// For checked parameters.
    pub(crate) fn new(parameters: &FlockParameters) -> Self {
        let penetration_slop = PENETRATION_SLOP * parameters.boat_radius_cm;
        Self {
            detector: ContactDetector::new(parameters),
            solver: ContactSolver::new(parameters.solver)
                .keeping_factors(parameters.relinearizations > 0),
            contacts: Vec::new(),
            parting: Parting::default(),
            biases: Vec::new(),
            persistent: Vec::new(),
            warm_start_cache: WarmStartCache::default(),
            depenetration: None,
            is_exhausted: false,
            passivity: Passivity::default(),
            trial: Trial::default(),
            relinearization: Relinearization::new(parameters),
            boat_radius: parameters.boat_radius_cm,
            gyration_radius: parameters.gyration_radius_cm,
            // Overlaps that the paper's scheme accepts are left alone.
            penetration_slop: match parameters.scheme {
                Scheme::Paper => penetration_slop.max(2.0 * parameters.overlap_tolerance_cm),
                Scheme::Leapfrog | Scheme::Moreau => penetration_slop,
            },
            whole_substep_s: seconds(ticks(parameters.dt_s)),
        }
    }

    /// Impulses of the last substep's contacts; some are zero.
    pub(crate) fn warm_start_impulses(&self) -> &[CachedImpulse] {
        self.warm_start_cache.impulses()
    }

    /// Puts back what [`Self::warm_start_impulses`] gave.
    pub(crate) fn set_warm_start(&mut self, impulses: &[CachedImpulse]) {
        self.warm_start_cache.replace(impulses.iter().copied());
    }

    /// Forgets contacts and impulses: the poses have been set from outside.
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
        self.trial.set_old();
        let builds_before = self.detector.neighbors.builds();
        let margin = self
            .detector
            .detect_moving(boats, velocities, dt, &mut self.contacts);
        let mut smallest = 0.0;
        for contact in &self.contacts {
            if contact.gap.gap < smallest {
                smallest = contact.gap.gap;
            }
        }
        self.is_exhausted = false;
        statistics.worst_overlap_cm = statistics.worst_overlap_cm.max(-smallest);
        if smallest < -self.penetration_slop {
            self.depenetrate(poses, boats, velocities, margin, statistics);
        }
        self.parting.clear();
        if self.relinearization.allowed_overlap.is_some() && self.detector.is_far() {
            self.parting
                .set_apart(&self.detector, velocities, dt, &mut self.contacts);
        }
        statistics.contacts += self.contacts.len() as u64;
        statistics.neighbor_builds += self.detector.neighbors.builds() - builds_before;
        self.warm_start(poses.len());
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
        let (radius, gyration_radius) = (self.boat_radius, self.gyration_radius);
        let depenetration = self.depenetration.get_or_insert_with(|| {
            Box::new(Depenetration::new(poses.len(), radius, gyration_radius))
        });
        depenetration.solver.share_room(&self.solver);
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
        self.solver.share_room(&depenetration.solver);
        self.is_exhausted = self.solver.is_exhausted();
        statistics.depenetration_passes += depenetration.passes - passes;
        statistics.displaced_angular_momentum_cm2_s +=
            (orbital_angular_momentum(poses, velocities) - angular_momentum).abs();
    }

    /// Guesses that contacts which carried an impulse still do.
    fn warm_start(&mut self, boats: usize) {
        self.warm_start_cache
            .lookup(boats, &self.contacts, &mut self.solver.impulses);
        self.persistent.clear();
        self.persistent
            .extend(self.solver.impulses.iter().map(|&impulse| impulse > 0.0));
        self.solver.active.clone_from(&self.persistent);
    }

    /// Whether moving with these velocities for `dt` overlaps anything found last by more than `allowed`.
    pub(crate) fn overlaps_after(
        &mut self,
        poses: &[Pose],
        velocities: &[Velocity],
        dt: f64,
        allowed: f64,
    ) -> bool {
        self.trial
            .place(poses, velocities, dt, self.detector.hull());
        self.trial.overlaps(&self.detector, &self.contacts, allowed)
    }

    /// Solves the contacts found last for free velocities and effective inertia; the result is in `solver`. Poses are
    /// those at the substep's start.
    ///
    /// [`ContactOutcome::TooLong`] changes nothing but the statistics.
    pub(crate) fn resolve(
        &mut self,
        poses: &[Pose],
        free: &[Velocity],
        inertia: &[InverseInertia],
        dt: f64,
        shorter_possible: bool,
        statistics: &mut Statistics,
    ) -> ContactOutcome {
        let bias = VelocityBias {
            dt,
            closing_s: dt.max(self.whole_substep_s),
            penetration_slop: self.penetration_slop,
        };
        if self.is_exhausted {
            return ContactOutcome::TooLong;
        }
        self.solver.give_up_early(shorter_possible);
        self.solve_and_relinearize(poses, free, inertia, bias, statistics);
        let Self {
            trial, detector, ..
        } = &*self;
        let velocities = &self.solver.velocities;
        let is_apart = |allowed| {
            let parting = &self.parting;
            parting.is_apart(trial, detector, velocities, dt, allowed)
        };
        let is_short = !self.is_exhausted && !self.parting.is_empty();
        if is_short && !self.relinearization.allowed_overlap.is_some_and(is_apart) {
            self.take_parting_back(poses.len(), statistics);
            self.solve_and_relinearize(poses, free, inertia, bias, statistics);
        }
        if !self.is_exhausted && self.stop_driving(free, inertia, bias) {
            if shorter_possible {
                return ContactOutcome::TooLong;
            }
            // Other biases lead to other poses, at which nobody looks for what was left out.
            if !self.parting.is_empty() {
                self.take_parting_back(poses.len(), statistics);
                self.solve_and_relinearize(poses, free, inertia, bias, statistics);
                self.stop_driving(free, inertia, bias);
            }
            self.solve(None, free, inertia, statistics);
        }
        if self.is_exhausted {
            self.is_exhausted = !shorter_possible;
            return ContactOutcome::TooLong;
        }
        if self.detector.moves_too_far(&self.solver.velocities, dt) {
            return ContactOutcome::TooLong;
        }
        let impulses = self.solver.impulses.iter().copied();
        self.warm_start_cache
            .replace(self.contacts.iter().map(Contact::key).zip(impulses));
        ContactOutcome::Solved
    }

    /// Has the contacts that were left out solved for as well.
    fn take_parting_back(&mut self, boats: usize, statistics: &mut Statistics) {
        statistics.contacts += self.parting.give_back(&mut self.contacts);
        self.warm_start(boats);
    }

    /// Solves the contacts at hand, and relinearizes them if that was asked for.
    fn solve_and_relinearize(
        &mut self,
        poses: &[Pose],
        free: &[Velocity],
        inertia: &[InverseInertia],
        bias: VelocityBias,
        statistics: &mut Statistics,
    ) {
        self.biases.clear();
        self.biases.extend(self.contacts.iter().map(|contact| {
            let spin = free[contact.boat as usize].angular;
            bias.of_gap(&contact.gap) + bias.of_flank(&contact.gap, spin)
        }));
        self.solver.reset(poses.len(), &self.contacts);
        let solved = self.solve(None, free, inertia, statistics);
        if let Some(allowed) = self.relinearization.allowed_overlap
            && solved
        {
            self.relinearize(poses, free, inertia, bias.dt, allowed, statistics);
        }
    }

    /// Has velocity biases follow from the gaps at hand alone in islands that would be driven or turned back
    /// otherwise; returns whether there are any.
    fn stop_driving(
        &mut self,
        free: &[Velocity],
        inertia: &[InverseInertia],
        bias: VelocityBias,
    ) -> bool {
        let problem = ContactProblem {
            contacts: &self.contacts,
            inertia,
            free,
            biases: &self.biases,
        };
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

    /// Solves some islands again, or all; returns whether that succeeds.
    fn solve(
        &mut self,
        again: Option<&[u32]>,
        free: &[Velocity],
        inertia: &[InverseInertia],
        statistics: &mut Statistics,
    ) -> bool {
        self.trial.set_old();
        let Self {
            contacts,
            biases,
            solver,
            is_exhausted,
            ..
        } = self;
        let problem = ContactProblem {
            contacts,
            inertia,
            free,
            biases,
        };
        let report = match again {
            Some(islands) => solver.solve_again(&problem, islands),
            None => solver.solve(&problem),
        };
        if solver.is_exhausted() {
            *is_exhausted = true;
            return false;
        }
        statistics.count(&report);
        if report.converged {
            return true;
        }
        // Overlaps that cannot all close within the substep contradict each other. Without them, rest
        // satisfies every constraint, and impulses stay bounded.
        statistics.unsolved += 1;
        biases.iter_mut().for_each(|bias| *bias = bias.max(0.0));
        let problem = ContactProblem {
            contacts,
            inertia,
            free,
            biases,
        };
        let is_solved = solver.solve(&problem).converged;
        if !is_solved && !solver.is_exhausted() {
            solver.impulses.fill(0.0);
            solver.solve_as(Solver::GaussSeidel, &problem);
        }
        *is_exhausted = solver.is_exhausted();
        false
    }

    /// Moves the boats to the end of a substep that was solved, if a trial has put them there.
    pub(crate) fn take_end(&mut self, poses: &mut Vec<Pose>, hulls: &mut Vec<HullPose>) -> bool {
        self.trial.take_end(poses, hulls)
    }

    /// Forgets the impulses: nothing touched in this substep, and nothing near carried an impulse.
    pub(crate) fn clear_warm_start(&mut self) {
        self.warm_start_cache.clear();
        self.solver.impulses.fill(0.0);
    }

    /// Adds to each boat the linear acceleration from contacts that carried an impulse both in this
    /// kick, of length `dt`, and in the one before: which are likely to continue.
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
