//! Holds the contacts of a flock from substep to substep: finds them, guesses their impulses, and solves them for
//! velocities that respect them.

mod biases;
mod relinearization;
mod solution;

use super::depenetration::{
    Depenetration, PENETRATION_SLOP, orbital_angular_momentum, smallest_gap,
};
use super::passivity::Passivity;
use super::predicted_poses::PredictedPoses;
use super::skipped_contacts::SkippedContacts;
use super::solver::ContactSolver;
use super::warm_start::{CachedImpulse, WarmStartCache};
use super::{Contact, ContactDetector, ContactProblem, InverseInertia, Statistics};
use crate::clock::{seconds, ticks};
use crate::geometry::{HullPose, Pose, Vec2, Velocity};
use crate::parameters::{FlockParameters, Scheme};
use relinearization::Relinearization;
pub(crate) use solution::{Divisibility, NotTaken};

/// The motion of a substep before its contacts are solved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion<'a> {
    /// Poses at the substep's start.
    pub poses: &'a [Pose],
    /// The hulls at these poses.
    pub hulls: &'a [HullPose],
    /// Velocities before the substep; `None` if gaps count as linear.
    pub before: Option<&'a [Velocity]>,
    /// Velocities after the substep without contacts.
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
    /// Holds the impulses of the contacts found last, in cm/s, and the solved velocities until the substep takes them.
    pub(crate) solver: ContactSolver,
    /// The contacts found last.
    pub(crate) contacts: Vec<Contact>,
    /// Contacts that are skipped as long as the solution keeps them open.
    skipped: SkippedContacts,
    biases: Vec<f64>,
    /// Whether each contact carried an impulse in the previous substep.
    persistent: Vec<bool>,
    /// Contacts and impulses of the previous substep.
    warm_start_cache: WarmStartCache,
    depenetration: Box<Depenetration>,
    passivity: Passivity,
    predicted: PredictedPoses,
    relinearization: Relinearization,
    /// Overlaps beyond this (cm) are undone by moving poses.
    penetration_slop: f64,
    /// Whether overlaps beyond the slop remain after poses were moved.
    is_deep: bool,
    /// Length of a whole substep in s. An overlap has to open within this time, however short a substep is.
    whole_substep_s: f64,
}

impl ContactResolver {
    /// A resolver for checked parameters.
    pub(crate) fn new(parameters: &FlockParameters) -> Self {
        let penetration_slop = PENETRATION_SLOP * parameters.boat_radius_cm;
        let solves_again = parameters.tolerance_cm < f64::INFINITY;
        Self {
            detector: ContactDetector::new(parameters),
            solver: ContactSolver::new(parameters.solver).keeping_factors(solves_again),
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

    /// Clears contacts, impulses and the neighbor list. Needed after poses were set from outside.
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
        let deepest = smallest_gap(&self.contacts).min(0.0);
        self.is_deep = false;
        statistics.worst_overlap_cm = statistics.worst_overlap_cm.max(-deepest);
        if deepest < -self.penetration_slop {
            self.depenetrate(poses, boats, velocities, margin, statistics);
            self.is_deep = smallest_gap(&self.contacts) < -self.penetration_slop;
        }
        self.skipped.clear();
        if self.relinearization.is_on() && self.detector.does_skipping_save_work() {
            self.skipped
                .skip_open(&self.detector, velocities, dt, &mut self.contacts);
        }
        statistics.contacts += self.contacts.len() as u64;
        statistics.neighbor_builds += self.detector.neighbors.builds() - builds_before;
        self.warm_start();
        !self.contacts.is_empty()
    }

    /// Undoes deep overlaps by moving poses, and then finds the contacts nearer than `margin` again.
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
        let passes_before = depenetration.passes;
        let momentum_before = orbital_angular_momentum(poses, velocities);
        depenetration.open_overlaps(
            &mut self.detector,
            poses,
            boats,
            0.1 * self.penetration_slop,
            margin,
            &mut self.contacts,
        );
        self.solver.share_budget(&depenetration.solver);
        statistics.depenetration_passes += depenetration.passes - passes_before;
        statistics.displaced_angular_momentum_cm2_s +=
            (orbital_angular_momentum(poses, velocities) - momentum_before).abs();
    }

    /// Guesses that the impulses of the previous substep recur.
    fn warm_start(&mut self) {
        self.warm_start_cache
            .lookup(&self.contacts, &mut self.solver.impulses);
        self.persistent.clear();
        self.persistent
            .extend(self.solver.impulses.iter().map(|&impulse| impulse > 0.0));
        self.solver.active.clone_from(&self.persistent);
    }

    /// Whether any contact found last overlaps by more than `allowed` after boats move with these velocities for `dt`.
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

    /// Moves the boats to the end of the solved substep if their poses there are already predicted; returns whether they
    /// were.
    pub(crate) fn take_predicted_poses(
        &mut self,
        poses: &mut Vec<Pose>,
        hulls: &mut Vec<HullPose>,
    ) -> bool {
        self.predicted.take_poses(poses, hulls)
    }

    /// Forgets the impulses. For substeps without contacts.
    pub(crate) fn clear_warm_start(&mut self) {
        self.warm_start_cache.clear();
        self.solver.impulses.fill(0.0);
    }

    /// Adds to each boat's entry the linear acceleration by contacts that carried an impulse both in this kick, of length
    /// `dt`, and in the one before. Such contacts are likely to persist.
    pub(crate) fn add_persistent_acceleration(
        &self,
        inertia: &[InverseInertia],
        dt: f64,
        accelerations: &mut [Vec2],
    ) {
        for (k, contact) in self.contacts.iter().enumerate() {
            let impulse = self.solver.impulses[k];
            if !self.persistent[k] || impulse <= 0.0 {
                continue;
            }
            let force = contact.gap.normal * (impulse / dt);
            let first = contact.boat as usize;
            accelerations[first] += force * inertia[first].linear;
            if let Some(second) = contact.second() {
                accelerations[second] -= force * inertia[second].linear;
            }
        }
    }
}
