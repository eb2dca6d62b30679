//! One flock: it owns all state, and is placed, advanced, observed, stored and restored.

use super::placement;
use crate::analysis::OrderParameters;
use crate::analysis::quantities::{self, Recorded};
use crate::clock::{Ticks, seconds, ticks};
use crate::contact::{KeepGoing, NotTaken, Statistics};
use crate::error::{FlockError, Result};
use crate::geometry::{HullPose, Pose, Velocity};
use crate::integrator::{Checkpoint, Integrator, PhaseMoment, PhaseSchedule, Steering, Substep};
use crate::parameters::{FlockParameters, Targets};

/// The latest time a flock may reach: 10⁹ s.
pub(crate) const LATEST: Ticks = 1_000_000_000_000_000_000;

/// A flock of boats in a pool.
#[derive(Debug, Clone)]
pub struct Flock {
    pub(crate) parameters: FlockParameters,
    schedule: PhaseSchedule,
    pub(crate) seed: u64,
    /// Seed of the noise, if the flock continues a snapshot with other noise.
    noise_seed: Option<u64>,
    pub(crate) time: Ticks,
    /// `dt_s` when the flock was made, which determines the paths of white noise.
    pub(super) noise_dt_s: f64,
    pub(crate) integrator: Integrator,
    /// The motion before the last advance, which is restored if the advance fails.
    before_advance: Box<Checkpoint>,
}

/// Work between two calls of `keep_going`, counted in boats moved, contacts and factored rows. It takes some
/// milliseconds, unless a single substep takes longer.
const WORK_BETWEEN_CHECKS: u64 = 20_000;
/// A substep that is too long is halved, but not below `dt_s` over this number.
const SHORTEST_FRACTION: Ticks = 1024;
const TOO_FAST: &str = "a boat is so fast that it might pass through a wall: it would move by more than half \
                        boat_radius_cm within dt_s / 1024; slower boats or a smaller dt_s help";
const TOO_MUCH: &str = "the contacts of a substep are too many and too entangled to be solved; a smaller dt_s, slower \
                        boats or milder constants may help";
const OUT_OF_RANGE: &str = "the motion left the range of 1e9 cm, cm/s, rad and rad/s; smaller dt_s or milder constants \
                            may help";
const LEFT_THE_WATER: &str = "would leave the water: it moves too far within dt_s for its contacts to hold it; smaller \
                              dt_s, slower boats or milder constants may help";

impl Flock {
    /// Argument `include_leaders` of measurements over the normal boats alone.
    pub const WITHOUT_LEADERS: bool = false;

    /// A flock placed at random without overlap, at rest.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for parameters out of range, [`FlockError::Placement`] if the boats
    /// do not fit.
    pub fn new(parameters: FlockParameters, seed: u64) -> Result<Self> {
        Self::new_while(&|| true, parameters, seed)
    }

    /// As [`Self::new`], but calls `keep_going` now and then, since large flocks take seconds to place.
    ///
    /// # Errors
    /// As for [`Self::new`]; [`FlockError::Interrupted`] if `keep_going` returned false.
    pub fn new_while(
        keep_going: KeepGoing,
        parameters: FlockParameters,
        seed: u64,
    ) -> Result<Self> {
        parameters.check()?;
        let poses = placement::place(&parameters, seed, keep_going)?;
        let mut flock = Self::unplaced(parameters, seed);
        flock
            .integrator
            .place(&poses, &vec![Velocity::default(); poses.len()]);
        Ok(flock)
    }

    /// A flock whose boats have no poses yet.
    pub(crate) fn unplaced(parameters: FlockParameters, seed: u64) -> Self {
        Self {
            schedule: PhaseSchedule::new(&parameters),
            integrator: Integrator::new(&parameters, seed),
            before_advance: Box::default(),
            seed,
            noise_seed: None,
            time: 0,
            noise_dt_s: parameters.dt_s,
            parameters,
        }
    }

    /// Starts over with another seed, like a new flock with these parameters.
    ///
    /// # Errors
    /// As for [`Self::new_while`]; the flock is unchanged then.
    pub fn reset(&mut self, keep_going: KeepGoing, seed: u64) -> Result<()> {
        *self = Self::new_while(keep_going, self.parameters.clone(), seed)?;
        Ok(())
    }

    /// The parameters.
    pub fn parameters(&self) -> &FlockParameters {
        &self.parameters
    }

    /// The seed of all streams.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The seed of the noise if it differs from the flock's seed, as in a branch.
    pub fn noise_seed(&self) -> Option<u64> {
        self.noise_seed
    }

    /// Continues with the noise of another seed. All flocks with the same noise seed get the same noise. A flock that
    /// was made with this number as its seed gets other noise. `None` leaves the noise as it is.
    pub(super) fn branch(&mut self, noise_seed: Option<u64>) {
        if let Some(seed) = noise_seed {
            self.noise_seed = noise_seed;
            self.integrator.branch_noise(seed);
        }
    }

    /// Time in s.
    pub fn time_s(&self) -> f64 {
        seconds(self.time)
    }

    /// Time in ticks.
    pub fn time(&self) -> Ticks {
        self.time
    }

    /// The cycle of phases.
    pub fn schedule(&self) -> &PhaseSchedule {
        &self.schedule
    }

    /// The present phase, with the time since it started and the time until it ends.
    pub fn phase(&self) -> PhaseMoment {
        self.schedule.at(self.time)
    }

    /// Poses of all boats, leaders first.
    pub fn poses(&self) -> &[Pose] {
        &self.integrator.poses
    }

    /// Poses of all boats with their direction vectors.
    pub fn hulls(&self) -> &[HullPose] {
        &self.integrator.boats
    }

    /// Velocities of all boats. With `leapfrog` these are means over the last substep: they belong to its middle, and
    /// the poses moved with exactly these velocities.
    pub fn velocities(&self) -> &[Velocity] {
        &self.integrator.velocities
    }

    /// Speed of the water's current in cm/s (Section 4.5), at the time of the velocities. It is positive if
    /// counter-clockwise.
    pub fn current_cm_s(&self) -> f64 {
        self.integrator.current_cm_s()
    }

    /// Statistics of the substeps so far.
    pub fn statistics(&self) -> &Statistics {
        &self.integrator.statistics
    }

    /// The paper's rudder command, eq. (10), for a leader in its present pose.
    pub fn steering_law(&self, leader: usize) -> f64 {
        self.integrator.paper_rudder(leader)
    }

    /// Sets the target of the steering law, for all leaders or for each leader.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if the numbers of targets and leaders differ; the flock is unchanged then.
    pub fn set_target(&mut self, target: impl Into<Targets>) -> Result<()> {
        let target = target.into();
        target.check(self.parameters.n_leaders)?;
        self.integrator.parameters.target.clone_from(&target);
        self.parameters.target = target;
        Ok(())
    }

    /// Advances by a duration. `rudder` holds one command in [−1, 1] per leader; `None` steers by the paper's law at
    /// every substep.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] or [`FlockError::Shape`] for a bad duration or rudder,
    /// [`FlockError::Solver`] if the motion left the range or the water. The flock is unchanged then.
    pub fn advance(&mut self, duration_s: f64, rudder: Option<&[f64]>) -> Result<()> {
        let end = self.end_of(duration_s)?;
        self.check_rudder(rudder)?;
        let steering = rudder.map_or(Steering::Law, Steering::Held);
        self.advance_to(&|| true, end, steering)
    }

    /// End of a duration in s that starts now.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a bad duration.
    pub fn end_of(&self, duration_s: f64) -> Result<Ticks> {
        let is_duration = (0.0..=seconds(LATEST)).contains(&duration_s);
        let accepted = "a finite duration of at least 0 s";
        FlockError::unless(is_duration, "seconds", duration_s, accepted)?;
        let end = self.time + ticks(duration_s);
        let accepted = "a duration that ends before time_s = 1e9";
        FlockError::unless(end <= LATEST, "seconds", duration_s, accepted)?;
        Ok(end)
    }

    /// Checks rudder commands.
    ///
    /// # Errors
    /// [`FlockError::Shape`] or [`FlockError::Parameter`].
    pub fn check_rudder(&self, rudder: Option<&[f64]>) -> Result<()> {
        let Some(commands) = rudder else {
            return Ok(());
        };
        let k = self.parameters.n_leaders;
        if commands.len() != k {
            return Err(FlockError::Shape {
                field: "rudder",
                found: format!("({},)", commands.len()),
                expected: format!("({k},), one per leader"),
            });
        }
        commands.iter().try_for_each(|command| {
            let is_rudder = (-1.0..=1.0).contains(command);
            FlockError::unless(is_rudder, "rudder", command, "numbers in [-1, 1]")
        })
    }

    /// Advances to a time with checked steering. Substeps end on multiples of dt, on phase switches and at `end`. Calls
    /// `keep_going` now and then.
    ///
    /// # Errors
    /// [`FlockError::Solver`] if the motion left the range or the water, [`FlockError::Interrupted`] if `keep_going`
    /// returned false; the flock is unchanged then.
    pub fn advance_to(
        &mut self,
        keep_going: KeepGoing,
        end: Ticks,
        steering: Steering,
    ) -> Result<()> {
        self.advance_watched(keep_going, end, steering, &mut |_| {})
    }

    /// As [`Self::advance_to`], but also calls a function with the motion after every substep.
    pub(crate) fn advance_watched(
        &mut self,
        keep_going: KeepGoing,
        end: Ticks,
        steering: Steering,
        watch: &mut impl FnMut(&Integrator),
    ) -> Result<()> {
        self.integrator.save(&mut self.before_advance);
        let start = self.time;
        let result = self.take_substeps(keep_going, end, steering, watch);
        if result.is_err() {
            self.integrator.return_to(&self.before_advance);
            self.time = start;
        }
        result
    }

    /// Takes substeps until `end`, and checks the poses and velocities that result.
    fn take_substeps(
        &mut self,
        keep_going: KeepGoing,
        end: Ticks,
        steering: Steering,
        watch: &mut impl FnMut(&Integrator),
    ) -> Result<()> {
        let dt = ticks(self.parameters.dt_s);
        let unsolved_before = self.integrator.statistics.unsolved;
        let (mut work_at_check, mut budget_end) = (self.work(), 0);
        while self.time < end {
            let next_multiple = (self.time / dt + 1) * dt;
            // The contacts of each interval of dt have one work budget, however many substeps divide it.
            if next_multiple > budget_end {
                let solver = &mut self.integrator.contacts.solver;
                solver.refill(self.parameters.n_boats);
                budget_end = next_multiple;
            }
            self.take_substep(end.min(next_multiple), steering)?;
            watch(&self.integrator);
            if self.work() - work_at_check >= WORK_BETWEEN_CHECKS {
                work_at_check = self.work();
                if !keep_going() {
                    return Err(FlockError::Interrupted);
                }
            }
            // Contacts of boats out of range would fail only after long work, so stop here.
            let is_unsolved = self.integrator.statistics.unsolved > unsolved_before;
            if is_unsolved && !self.integrator.is_in_range() {
                break;
            }
        }
        if !self.integrator.is_in_range() {
            return Err(FlockError::Solver(OUT_OF_RANGE.to_owned()));
        }
        match self.integrator.left_the_water(&self.before_advance.poses) {
            Some(boat) => Err(FlockError::Solver(format!("boat {boat} {LEFT_THE_WATER}"))),
            None => Ok(()),
        }
    }

    /// Takes a substep that ends at `end` or at the next phase switch. A substep that is too long is halved until it can be
    /// taken.
    fn take_substep(&mut self, end: Ticks, steering: Steering) -> Result<()> {
        let shortest = (ticks(self.parameters.dt_s) / SHORTEST_FRACTION).max(1);
        let moment = self.schedule.at(self.time);
        let mut substep = Substep {
            start: self.time,
            length: end.min(self.time + moment.left) - self.time,
            phase: moment.phase,
            steering,
        };
        while let Err(reason) = self.integrator.step(&substep) {
            let fault = match reason {
                NotTaken::TooLong if substep.length > shortest => {
                    substep.length = substep.length.div_ceil(2);
                    self.integrator.statistics.halved_substeps += 1;
                    continue;
                }
                NotTaken::TooLong => TOO_FAST,
                NotTaken::Exhausted => TOO_MUCH,
            };
            return Err(FlockError::Solver(fault.to_owned()));
        }
        self.time += substep.length;
        Ok(())
    }

    /// Work of the substeps so far: boats moved, contacts and rows factored.
    fn work(&self) -> u64 {
        let statistics = &self.integrator.statistics;
        let moved = statistics.substeps * self.parameters.n_boats as u64;
        moved + statistics.contacts + statistics.factored_rows
    }

    /// Approximate number of multiplications that the contacts of all substeps took, failed substeps included. It is
    /// bounded for each interval of dt.
    pub fn contact_work(&self) -> u64 {
        self.integrator.contacts.solver.work().unsigned_abs()
    }

    /// When about `boat_substeps` (substeps times boats) more will be done, but at most `end`. It is `end` or a multiple of
    /// dt, so that a stop there does not change the run.
    pub fn stop_towards(&self, end: Ticks, boat_substeps: u64) -> Ticks {
        let dt = ticks(self.parameters.dt_s);
        let substeps = (boat_substeps / self.parameters.n_boats as u64).max(1);
        let substeps_from_zero = (self.time / dt).saturating_add(substeps);
        end.min(substeps_from_zero.saturating_mul(dt))
    }

    /// Order parameters of the normal boats, or of all boats.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if the flock has no such boats.
    pub fn order_parameters(&self, include_leaders: bool) -> Result<OrderParameters> {
        let (hulls, velocities) = self.measured(include_leaders);
        OrderParameters::from_hulls(hulls, velocities)
    }

    /// The recorded quantities of the normal boats, or of all boats, in the order of `QUANTITIES`.
    ///
    /// # Errors
    /// As for [`Self::order_parameters`].
    pub fn recorded(&self, include_leaders: bool) -> Result<Recorded> {
        let (hulls, velocities) = self.measured(include_leaders);
        quantities::recorded(hulls, velocities)
    }

    /// Hulls and velocities of the normal boats, or of all boats.
    pub(crate) fn measured(&self, include_leaders: bool) -> (&[HullPose], &[Velocity]) {
        let leaders = self.parameters.n_leaders;
        let first = if include_leaders { 0 } else { leaders };
        (&self.hulls()[first..], &self.velocities()[first..])
    }
}
