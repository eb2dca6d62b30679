//! Everything that one substep reads and writes: poses, velocities, what drives them, contacts.

use crate::boat::{Drive, FreeMotion, Pose, Velocity, misalignment, steering_law};
use crate::contact::{ContactResolver, InverseInertia, Load};
use crate::geometry::{HullPose, Vec2, turned_left};
use crate::parameters::{FlockParameters, Noise, Scheme, Target};
use crate::phase_schedule::{Phase, Ticks, seconds};
use crate::random_streams::{BrownianPaths, Stream};
use crate::scheme;
use crate::statistics::Statistics;
use rand::RngExt;

/// Where a leader's rudder command comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Steering<'a> {
    /// The paper's law, eq. (10), at every substep.
    Law,
    /// Commands held over the substep, one a leader.
    Held(&'a [f64]),
}

/// Part of `dt_s` below which no substep is cut for the sake of its contacts.
const SHORTEST_SHARE: f64 = 1.0 / 16.0;

/// One substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Substep<'a> {
    /// When it begins.
    pub start: Ticks,
    /// How long it lasts.
    pub length: Ticks,
    /// What the motors do.
    pub phase: Phase,
    /// What the rudders do.
    pub steering: Steering<'a>,
}

/// What the leapfrog scheme remembers of the substep before: its second half belongs to the next kick.
#[derive(Debug, PartialEq, Default)]
pub struct LastSubstep {
    /// Its length; 0 if there was none since the state was set.
    pub length: Ticks,
    /// The phase it lay in.
    pub phase: usize,
    /// The rudders held in it; `None` for the steering law.
    pub rudder: Option<Vec<f64>>,
    /// Linear acceleration of each boat by contacts that are likely to last; empty for none.
    pub lasting_acceleration: Vec<Vec2>,
}

impl Clone for LastSubstep {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    // A flock is saved before every advance: without allocations.
    fn clone_from(&mut self, source: &Self) {
        self.length = source.length;
        self.phase = source.phase;
        self.rudder.clone_from(&source.rudder);
        self.lasting_acceleration
            .clone_from(&source.lasting_acceleration);
    }
}

/// All that decides how the motion goes on, apart from parameters, seed and time.
#[derive(Debug, Clone, Default)]
pub struct Checkpoint {
    /// Poses of all boats.
    pub poses: Vec<Pose>,
    /// Velocities of all boats.
    pub velocities: Vec<Velocity>,
    /// What leapfrog remembers.
    pub last: LastSubstep,
    /// Contacts that carried an impulse in the last substep.
    pub loads: Vec<Load>,
    /// Centres that the neighbour list was built from, and within which distance.
    pub neighbor_reference: (Vec<Vec2>, f64),
    /// Length of the last kick in s.
    pub kick_s: f64,
    /// Running totals.
    pub statistics: Statistics,
}

/// State and working memory of a flock's motion.
#[derive(Debug, Clone)]
pub struct Dynamics {
    pub(crate) parameters: FlockParameters,
    pub(crate) motion: FreeMotion,
    /// Per-boat factor of the motor's speed; empty where all boats are alike.
    speed_factors: Vec<f64>,
    pub(crate) poses: Vec<Pose>,
    pub(crate) velocities: Vec<Velocity>,
    /// The poses with their direction vectors.
    pub(crate) boats: Vec<HullPose>,
    pub(crate) contacts: ContactResolver,
    /// η of eq. (9); `None` where c4 = 0.
    noise: Option<BrownianPaths>,
    /// Change of each boat's angular velocity by noise over the substep.
    pub(crate) kicks: Vec<f64>,
    pub(crate) drives: Vec<Drive>,
    pub(crate) free: Vec<Velocity>,
    pub(crate) inertia: Vec<InverseInertia>,
    pub(crate) last: LastSubstep,
    pub(crate) statistics: Statistics,
    /// Length of the last kick in s: what impulses are divided by to give forces.
    pub(crate) kick_s: f64,
}

impl Dynamics {
    /// For checked parameters; boats at the origin, to be placed.
    pub fn new(parameters: &FlockParameters, seed: u64) -> Self {
        let n = parameters.n_boats;
        let p = parameters;
        let density = 1.0 / (p.gyration_radius_cm * p.gyration_radius_cm);
        Self {
            motion: FreeMotion::new(p),
            speed_factors: speed_factors(p, seed),
            poses: vec![Pose::default(); n],
            velocities: vec![Velocity::default(); n],
            boats: vec![HullPose::new(&Pose::default()); n],
            contacts: ContactResolver::new(p),
            noise: (p.c4 > 0.0).then(|| noise_paths(p, seed)),
            kicks: vec![0.0; n],
            drives: Vec::with_capacity(n),
            free: Vec::with_capacity(n),
            inertia: vec![
                InverseInertia {
                    linear: 1.0,
                    angular: density
                };
                n
            ],
            last: LastSubstep::default(),
            statistics: Statistics::default(),
            kick_s: 0.0,
            parameters: parameters.clone(),
        }
    }

    /// Takes one substep with the scheme of the parameters. Returns `false` if it is too long for its
    /// contacts: deep overlaps may have been undone then, but no time has passed.
    pub fn step(&mut self, substep: &Substep) -> bool {
        let taken = match self.parameters.scheme {
            Scheme::Leapfrog => scheme::leapfrog(self, substep),
            Scheme::Moreau => scheme::moreau(self, substep),
            Scheme::Paper => {
                scheme::paper(self, substep);
                true
            }
        };
        self.statistics.substeps += u64::from(taken);
        taken
    }

    /// Puts boats somewhere else; motion so far is forgotten.
    pub fn place(&mut self, poses: &[Pose], velocities: &[Velocity]) {
        self.poses.copy_from_slice(poses);
        self.velocities.copy_from_slice(velocities);
        self.last = LastSubstep::default();
        self.kick_s = 0.0;
        self.contacts.forget();
        self.update_boats();
    }

    /// The motion as it is, to return to.
    pub fn checkpoint(&self) -> Checkpoint {
        let mut checkpoint = Checkpoint::default();
        self.save(&mut checkpoint);
        checkpoint
    }

    /// Writes the motion as it is over a checkpoint, whose memory is used again.
    pub fn save(&self, into: &mut Checkpoint) {
        into.poses.clone_from(&self.poses);
        into.velocities.clone_from(&self.velocities);
        into.last.clone_from(&self.last);
        into.loads.clear();
        into.loads.extend_from_slice(self.contacts.loads());
        let neighbors = self.contacts.neighbors();
        into.neighbor_reference.0.clear();
        into.neighbor_reference
            .0
            .extend_from_slice(neighbors.reference());
        into.neighbor_reference.1 = neighbors.cutoff();
        into.kick_s = self.kick_s;
        into.statistics = self.statistics;
    }

    /// Goes on from a checkpoint, bit for bit.
    pub fn return_to(&mut self, checkpoint: &Checkpoint) {
        self.place(&checkpoint.poses, &checkpoint.velocities);
        self.last.clone_from(&checkpoint.last);
        self.contacts.set_loads(&checkpoint.loads);
        let (reference, cutoff) = &checkpoint.neighbor_reference;
        self.contacts
            .detector()
            .neighbors
            .restore(reference, *cutoff);
        self.kick_s = checkpoint.kick_s;
        self.statistics = checkpoint.statistics;
    }

    /// Works out the direction vectors of the poses.
    pub fn update_boats(&mut self) {
        HullPose::replace_all(&mut self.boats, &self.poses);
    }

    /// Moves every boat with its velocity for a time.
    pub(crate) fn drift(&mut self, dt: f64) {
        for (pose, velocity) in self.poses.iter_mut().zip(&self.velocities) {
            *pose = pose.moved(velocity, dt);
        }
        self.update_boats();
    }

    /// Turns free velocities into velocities that respect the contacts of a substep; returns whether
    /// there is any contact, or `None` if the substep is too long for them.
    pub(crate) fn settle_contacts(&mut self, substep: &Substep) -> Option<bool> {
        let dt = seconds(substep.length);
        let shorter_possible = dt > SHORTEST_SHARE * self.parameters.dt_s;
        let Self {
            contacts,
            poses,
            boats,
            free,
            inertia,
            statistics,
            ..
        } = self;
        let touches = contacts.find(poses, boats, free, dt, statistics);
        if !touches {
            contacts.clear_loads();
            self.velocities.copy_from_slice(free);
        } else if contacts.resolve(poses, free, inertia, dt, shorter_possible, statistics) {
            self.velocities.copy_from_slice(contacts.velocities());
        } else {
            return None;
        }
        Some(touches)
    }

    /// Preferred speed in a phase, in cm/s, before the spread between boats.
    fn preferred_speed(&self, is_leader: bool, phase: Phase) -> f64 {
        let p = &self.parameters;
        match phase {
            Phase::Forward => p.speed_cm_s,
            Phase::Backward if !is_leader || p.leaders_reverse => -p.reverse_speed_cm_s,
            Phase::Backward | Phase::DriftAfterForward | Phase::DriftAfterBackward => 0.0,
        }
    }

    /// Preferred speed of a boat in a phase, in cm/s.
    pub(crate) fn thrust(&self, boat: usize, phase: Phase) -> f64 {
        let speed = self.preferred_speed(boat < self.parameters.n_leaders, phase);
        self.speed_factors
            .get(boat)
            .map_or(speed, |factor| speed * factor)
    }

    /// Rudder of a boat: the command or the law for a leader, the bias for a normal boat.
    pub(crate) fn rudder(&self, boat: usize, steering: Steering) -> f64 {
        if boat >= self.parameters.n_leaders {
            return self.parameters.turning_bias;
        }
        match steering {
            Steering::Held(commands) => commands[boat],
            Steering::Law => self.law(boat),
        }
    }

    /// The paper's rudder command for a boat where it is now, eq. (10).
    pub fn law(&self, boat: usize) -> f64 {
        let pose = &self.poses[boat];
        steering_law(misalignment(
            pose.position,
            pose.heading,
            self.parameters.target,
        ))
    }

    /// Changes the direction that leaders steer to.
    pub fn set_target(&mut self, target: Target) {
        self.parameters.target = target;
    }

    /// Fills `drives` for a substep: thrust and rudder of its phase, water, noise kicks.
    pub(crate) fn fill_drives(&mut self, substep: &Substep) {
        let normal = Drive {
            thrust: self.preferred_speed(false, substep.phase),
            rudder: self.parameters.turning_bias,
            water: Vec2::zeros(),
            kick: 0.0,
        };
        self.drives.clear();
        self.drives
            .extend(self.kicks.iter().map(|&kick| Drive { kick, ..normal }));
        for leader in 0..self.parameters.n_leaders {
            self.drives[leader].thrust = self.preferred_speed(true, substep.phase);
            self.drives[leader].rudder = self.rudder(leader, substep.steering);
        }
        for (drive, factor) in self.drives.iter_mut().zip(&self.speed_factors) {
            drive.thrust *= factor;
        }
        self.fill_water(|dynamics, boat| dynamics.velocities[boat].linear);
    }

    /// Sets the water in `drives` as boats with these velocities move it: counter-clockwise with the
    /// speed −κ·(mean tangential velocity of the boats), capped (Section 4.5).
    pub(crate) fn fill_water(&mut self, velocity: impl Fn(&Self, usize) -> Vec2) {
        let p = &self.parameters;
        if p.current_gain == 0.0 {
            return;
        }
        let sum: f64 = (0..self.poses.len())
            .map(|boat| velocity(self, boat).dot(&self.tangent(boat)))
            .sum();
        let cap = p.current_cap_cm_s;
        let current = (-p.current_gain * sum / self.poses.len() as f64).clamp(-cap, cap);
        for boat in 0..self.poses.len() {
            self.drives[boat].water = self.tangent(boat) * current;
        }
    }

    /// Counter-clockwise unit tangent at a boat; zero at the pool's centre.
    fn tangent(&self, boat: usize) -> Vec2 {
        let position = self.poses[boat].position;
        turned_left(position.try_normalize(0.0).unwrap_or_default())
    }

    /// Fills `kicks` with the noise of the interval [from, to] (half ticks), which the scheme takes
    /// at `start`.
    pub(crate) fn draw_kicks(&mut self, start: Ticks, from: u64, to: u64) {
        let Some(noise) = &mut self.noise else { return };
        let scale = match self.parameters.noise {
            Noise::White => {
                noise.increments(from, to, &mut self.kicks);
                self.parameters.c4
            }
            Noise::PerStep => {
                noise.step_draws(start, &mut self.kicks);
                self.parameters.c4 * seconds(to - from) / 2.0
            }
        };
        self.kicks.iter_mut().for_each(|kick| *kick *= scale);
    }

    /// Fills `kicks` with the noise of a whole substep.
    pub(crate) fn draw_step_kicks(&mut self, substep: &Substep) {
        let end = substep.start + substep.length;
        self.draw_kicks(substep.start, 2 * substep.start, 2 * end);
    }

    /// Whether every pose and velocity is one that a flock may hold.
    pub fn is_in_range(&self) -> bool {
        self.poses.iter().all(Pose::is_in_range)
            && self.velocities.iter().all(Velocity::is_in_range)
    }
}

/// Brownian paths whose cells are what full substeps ask for: leapfrog kicks reach from the middle of
/// one substep to the middle of the next.
fn noise_paths(parameters: &FlockParameters, seed: u64) -> BrownianPaths {
    let dt = crate::phase_schedule::ticks(parameters.dt_s);
    let shift = if parameters.scheme == Scheme::Leapfrog {
        dt
    } else {
        0
    };
    BrownianPaths::new(seed, parameters.n_boats, 2 * dt, shift)
}

fn speed_factors(parameters: &FlockParameters, seed: u64) -> Vec<f64> {
    let p = parameters;
    if p.speed_spread_cm_s == 0.0 {
        return Vec::new();
    }
    let mut rng = Stream::SpeedSpread.rng(seed);
    let spread = p.speed_spread_cm_s / p.speed_cm_s;
    (0..p.n_boats)
        .map(|_| 1.0 + spread * rng.random_range(-1.0..=1.0))
        .collect()
}
