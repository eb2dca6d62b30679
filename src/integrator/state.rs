//! State that a substep reads and writes: poses, velocities, drives, contacts.

use super::substep::LastSubstep;
use crate::boat::{Drive, FreeMotion};
use crate::clock::ticks;
use crate::contact::{ContactResolver, InverseInertia, Statistics};
use crate::geometry::{HullPose, Pose, Velocity};
use crate::parameters::{FlockParameters, Scheme};
use crate::random::{BrownianPaths, Stream, StreamRng};
use rand::RngExt;

/// State and working memory of a flock's motion.
#[derive(Debug, Clone)]
pub(crate) struct Integrator {
    pub(crate) parameters: FlockParameters,
    pub(crate) motion: FreeMotion,
    /// Factor of each boat's preferred speed; empty if all boats are alike.
    pub(super) speed_factors: Vec<f64>,
    pub(crate) poses: Vec<Pose>,
    pub(crate) velocities: Vec<Velocity>,
    /// The poses with their direction vectors.
    pub(crate) boats: Vec<HullPose>,
    pub(crate) contacts: ContactResolver,
    /// η of eq. (9); `None` if c4 = 0.
    pub(super) noise: Option<BrownianPaths>,
    /// Change of each boat's angular velocity by noise over the substep.
    pub(crate) noise_increments: Vec<f64>,
    /// Drives of each boat in the substep.
    pub(crate) drives: Vec<Drive>,
    /// Velocity of each boat after the substep without contacts.
    pub(crate) free: Vec<Velocity>,
    /// Effective inertia of each boat in the substep.
    pub(crate) inertia: Vec<InverseInertia>,
    pub(crate) last: LastSubstep,
    /// Speed in cm/s of water with inertia at the time of the velocities, counter-clockwise positive; 0 without inertia.
    pub(crate) water_cm_s: f64,
    /// Speed in cm/s that the water approaches in this substep; without inertia, its speed.
    pub(super) driven_water_cm_s: f64,
    pub(crate) statistics: Statistics,
    /// Length of the last change of velocity in s. Impulses divided by it are forces.
    pub(crate) step_length_s: f64,
}

impl Integrator {
    /// The state for checked parameters; all boats lie at the origin until they are placed.
    pub(crate) fn new(parameters: &FlockParameters, seed: u64) -> Self {
        let n = parameters.n_boats;
        let p = parameters;
        let inertia = InverseInertia {
            linear: 1.0,
            angular: 1.0 / (p.gyration_radius_cm * p.gyration_radius_cm),
        };
        Self {
            motion: FreeMotion::new(p),
            speed_factors: speed_factors(p, seed),
            poses: vec![Pose::default(); n],
            velocities: vec![Velocity::default(); n],
            boats: vec![HullPose::new(&Pose::default()); n],
            contacts: ContactResolver::new(p),
            noise: (p.c4 > 0.0).then(|| noise_paths(p, Stream::NOISE.rng(seed))),
            noise_increments: vec![0.0; n],
            drives: Vec::with_capacity(n),
            free: Vec::with_capacity(n),
            inertia: vec![inertia; n],
            last: LastSubstep::default(),
            water_cm_s: 0.0,
            driven_water_cm_s: 0.0,
            statistics: Statistics::default(),
            step_length_s: 0.0,
            parameters: parameters.clone(),
        }
    }

    /// Sets poses and velocities, in water at rest, and forgets earlier motion.
    pub(crate) fn place(&mut self, poses: &[Pose], velocities: &[Velocity]) {
        self.poses.copy_from_slice(poses);
        self.velocities.copy_from_slice(velocities);
        self.last = LastSubstep::default();
        (self.water_cm_s, self.driven_water_cm_s) = (0.0, 0.0);
        self.step_length_s = 0.0;
        self.contacts.forget();
        self.update_boats();
    }

    /// Replaces the noise by that of a branch with this seed.
    pub(crate) fn branch_noise(&mut self, noise_seed: u64) {
        if let Some(noise) = &mut self.noise {
            noise.replace_keys(Stream::BRANCH_NOISE.rng(noise_seed));
        }
    }

    /// Sets the length of whole substeps; the noise paths stay the same.
    pub(crate) fn set_step(&mut self, dt_s: f64) {
        self.parameters.dt_s = dt_s;
        self.contacts.set_whole_substep(dt_s);
    }

    /// Computes the direction vectors of the poses.
    pub(crate) fn update_boats(&mut self) {
        HullPose::replace_all(&mut self.boats, &self.poses);
    }

    /// Moves every boat with its velocity for a time. If relinearization has already predicted these poses, they are taken
    /// over.
    pub(crate) fn drift(&mut self, dt: f64) {
        let (poses, hulls) = (&mut self.poses, &mut self.boats);
        if self.contacts.take_predicted_poses(poses, hulls) {
            return;
        }
        for (pose, velocity) in self.poses.iter_mut().zip(&self.velocities) {
            *pose = pose.moved(velocity, dt);
        }
        self.update_boats();
    }

    /// The first boat whose center is outside the water now and was inside before.
    pub(crate) fn left_the_water(&self, before: &[Pose]) -> Option<usize> {
        let detector = &self.contacts.detector;
        let is_inside = |boat: usize, center| detector.is_in_water(boat as u32, center);
        let left = |&boat: &usize| {
            !is_inside(boat, self.poses[boat].position) && is_inside(boat, before[boat].position)
        };
        (0..self.poses.len()).find(left)
    }

    /// Whether every component of poses and velocities is finite and within the range that a flock may hold.
    pub(crate) fn is_in_range(&self) -> bool {
        self.poses.iter().all(Pose::is_in_range)
            && self.velocities.iter().all(Velocity::is_in_range)
    }
}

/// Brownian paths whose cells are the intervals of noise in full substeps. In leapfrog such an interval reaches from the
/// middle of one substep to the middle of the next.
fn noise_paths(parameters: &FlockParameters, keys: StreamRng) -> BrownianPaths {
    let dt = ticks(parameters.dt_s);
    let shift = if parameters.scheme == Scheme::Leapfrog {
        dt
    } else {
        0
    };
    BrownianPaths::from_keys(keys, parameters.n_boats, 2 * dt, shift)
}

/// Factor of each boat's preferred speed; empty if all boats are alike.
fn speed_factors(parameters: &FlockParameters, seed: u64) -> Vec<f64> {
    let p = parameters;
    if p.speed_spread_cm_s == 0.0 {
        return Vec::new();
    }
    let mut rng = Stream::SPEED_SPREAD.rng(seed);
    let spread = p.speed_spread_cm_s / p.speed_cm_s;
    (0..p.n_boats)
        .map(|_| 1.0 + spread * rng.random_range(-1.0..=1.0))
        .collect()
}
