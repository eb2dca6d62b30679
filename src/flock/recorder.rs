//! Runs sampled at a fixed rate.

use super::change::Change;
use super::contact_force::ContactForce;
use super::flock::Flock;
use crate::analysis::quantities::{RECORDED, Recorded};
use crate::clock::{Ticks, seconds, ticks};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::integrator::{Phase, Steering};
use crate::parameters::FlockParameters;
use std::collections::VecDeque;

/// When samples are taken: at 0, 1/rate, 2/rate … up to and including the duration. Each time is
/// rounded to a tick by itself, so that errors do not add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    sample_hz: f64,
    count: u64,
    end: Ticks,
}

impl Sampling {
    /// The highest rate that samples may be taken at, in 1/s.
    pub(crate) const FASTEST_HZ: f64 = 1e6;
    /// The longest run in s.
    pub(crate) const LONGEST_S: f64 = 1e9;

    /// Samples of a run of this duration.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a duration or rate out of range.
    pub fn new(duration_s: f64, sample_hz: f64) -> Result<Self> {
        let is_duration = (0.0..=Self::LONGEST_S).contains(&duration_s);
        let accepted = "a finite duration of at least 0 s, at most 1e9 s";
        FlockError::unless(is_duration, "duration_s", duration_s, accepted)?;
        // A NaN fails both comparisons.
        let is_rate = sample_hz > 0.0 && sample_hz <= Self::FASTEST_HZ;
        let accepted = "a positive rate of at most 1e6 samples per second";
        FlockError::unless(is_rate, "sample_hz", sample_hz, accepted)?;
        let periods = (duration_s * sample_hz).floor() as u64;
        let mut sampling = Self {
            sample_hz,
            count: periods + 1,
            end: ticks(duration_s),
        };
        // 0.29 s at 100 Hz has 29 periods, but 0.29·100 < 29 in floating point.
        if sampling.time(sampling.count) <= sampling.end {
            sampling.count += 1;
        }
        Ok(sampling)
    }

    /// Number of samples, at least 1.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// When a sample is taken, counted from the start of the run.
    pub fn time(&self, sample: u64) -> Ticks {
        ticks(sample as f64 / self.sample_hz)
    }
}

/// Precision of recorded poses and velocities.
pub trait Real: Copy + Default + nalgebra::RealField {}

impl Real for f64 {}
impl Real for f32 {}

/// The contacts that carried a force, sample after sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactSamples {
    /// Number of contacts in each sample.
    pub count: Vec<usize>,
    /// The contacts; their forces are means over the substep before the sample.
    pub contacts: Vec<ContactForce>,
}

impl ContactSamples {
    fn push(&mut self, flock: &Flock) {
        let earlier = self.contacts.len();
        let contacts = flock.contacts().into_iter();
        self.contacts
            .extend(contacts.filter(|contact| contact.force > 0.0));
        self.count.push(self.contacts.len() - earlier);
    }
}

/// The samples of a run, row after row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording<T> {
    /// Times in s.
    pub time_s: Vec<f64>,
    /// The phase that starts or holds at each time.
    pub phase: Vec<Phase>,
    /// Whether each time lies in the analysis window.
    pub in_analysis_window: Vec<bool>,
    /// Poses [cm, cm, rad] of all boats, sample after sample.
    pub pose: Vec<T>,
    /// Velocities [cm/s, cm/s, rad/s] of all boats, sample after sample.
    pub velocity: Vec<T>,
    /// Rudder commands of the leaders, sample after sample. If commands are held, these are the commands before the sample.
    /// If the steering law steers, these are its commands at the recorded poses.
    pub rudder: Vec<f64>,
    /// Recorded quantities of the normal boats; NaN in a flock without normal boats.
    pub order: Vec<Recorded>,
    /// Contacts, if they are recorded.
    pub contacts: Option<ContactSamples>,
}

impl<T: Real> Recording<T> {
    /// Recordings beyond this many bytes (16 GiB) are taken for a mistake.
    pub const MOST_BYTES: u64 = 16 << 30;

    /// An empty recording with reserved memory for a run.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if the run needs more than [`Self::MOST_BYTES`], or more than the free memory.
    pub fn with_capacity_for(sampling: &Sampling, parameters: &FlockParameters) -> Result<Self> {
        let samples = sampling.count();
        let bytes_of_poses_and_velocities = 6 * parameters.n_boats as u64 * size_of::<T>() as u64;
        let bytes_of_rudders = parameters.n_leaders * size_of::<f64>();
        let bytes_of_time_and_order = size_of::<f64>() + size_of::<Recorded>();
        let bytes_of_phase_and_window = size_of::<Phase>() + size_of::<bool>();
        let other_bytes =
            (bytes_of_time_and_order + bytes_of_phase_and_window + bytes_of_rudders) as u64;
        let bytes = samples.saturating_mul(bytes_of_poses_and_velocities + other_bytes);
        let mut recording = Self::default();
        let fits = bytes <= Self::MOST_BYTES && recording.reserve(samples, parameters).is_some();
        let run = format!("{samples} samples of {} boats", parameters.n_boats);
        let accepted = format!(
            "a recording of {bytes} bytes does not fit; at most {} bytes, and no more than the free memory: record a \
             shorter run, at a lower rate or in float32",
            Self::MOST_BYTES
        );
        FlockError::unless(fits, "duration_s * sample_hz", run, accepted)?;
        Ok(recording)
    }

    /// Reserves memory for samples; `None` if there is too little.
    fn reserve(&mut self, samples: u64, parameters: &FlockParameters) -> Option<()> {
        let samples = usize::try_from(samples).ok()?;
        let numbers = samples.checked_mul(parameters.n_boats)?.checked_mul(3)?;
        let rudders = samples.checked_mul(parameters.n_leaders)?;
        self.rudder.try_reserve_exact(rudders).ok()?;
        self.time_s.try_reserve_exact(samples).ok()?;
        self.phase.try_reserve_exact(samples).ok()?;
        self.in_analysis_window.try_reserve_exact(samples).ok()?;
        self.order.try_reserve_exact(samples).ok()?;
        self.pose.try_reserve_exact(numbers).ok()?;
        self.velocity.try_reserve_exact(numbers).ok()
    }

    /// Adds a sample of a flock in its present state. `rudder` holds the leaders' commands; `None`: they follow the
    /// steering law.
    pub fn push(&mut self, flock: &Flock, rudder: Option<&[f64]>) {
        self.time_s.push(flock.time_s());
        self.phase.push(flock.phase().phase);
        self.in_analysis_window
            .push(flock.schedule().in_analysis_window(flock.time()));
        for pose in flock.poses() {
            let numbers = [pose.position.x, pose.position.y, pose.heading];
            self.pose.extend(numbers.map(nalgebra::convert::<_, T>));
        }
        for velocity in flock.velocities() {
            let numbers = [velocity.linear.x, velocity.linear.y, velocity.angular];
            self.velocity.extend(numbers.map(nalgebra::convert::<_, T>));
        }
        let leaders = 0..flock.parameters().n_leaders;
        match rudder {
            Some(rudder) => self.rudder.extend(rudder),
            None => self
                .rudder
                .extend(leaders.map(|leader| flock.steering_law(leader))),
        }
        self.order.push(
            flock
                .recorded(Flock::WITHOUT_LEADERS)
                .unwrap_or([f64::NAN; RECORDED]),
        );
        if let Some(contacts) = &mut self.contacts {
            contacts.push(flock);
        }
    }
}

/// Reason for a pause of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pause {
    /// The requested amount of work is done; the run can continue at any time.
    Work,
    /// A control step starts: [`Recorder::steer`] may set other rudder commands.
    Control,
    /// The last sample is taken.
    End,
}

/// Rudder commands that are held between control steps.
#[derive(Debug, Clone)]
struct Control {
    hz: f64,
    /// Number of control steps that have started.
    started_steps: u64,
    rudder: Vec<f64>,
}

impl Control {
    /// When the next control step starts, counted from the start of the run; `None` without leaders.
    fn next_start(&self) -> Option<Ticks> {
        let has_leaders = !self.rudder.is_empty();
        has_leaders.then(|| ticks(self.started_steps as f64 / self.hz))
    }
}

/// A run of a flock, with its changes and its control steps, that is recorded.
#[derive(Debug, Clone)]
pub struct Recorder<T> {
    flock: Flock,
    sampling: Sampling,
    /// The flock's time at the start of the run.
    start: Ticks,
    samples_taken: u64,
    /// The changes to come, with their times since the start of the run.
    changes: VecDeque<(Ticks, Change)>,
    control: Option<Control>,
    recording: Recording<T>,
}

impl<T: Real> Recorder<T> {
    /// A run that starts from a flock's present state, under the steering law. Nothing is recorded yet.
    ///
    /// # Errors
    /// As for [`Recording::with_capacity_for`], and for a run that would end later than any flock may.
    pub fn new(flock: Flock, sampling: Sampling) -> Result<Self> {
        flock.end_of(seconds(sampling.time(sampling.count() - 1)))?;
        Ok(Self {
            recording: Recording::with_capacity_for(&sampling, flock.parameters())?,
            start: flock.time(),
            samples_taken: 0,
            changes: VecDeque::new(),
            control: None,
            flock,
            sampling,
        })
    }

    /// Records contacts as well.
    #[must_use]
    pub fn with_contacts(mut self) -> Self {
        self.recording.contacts = Some(ContactSamples::default());
        self
    }

    /// Adds changes to the run, each with its time since the start of the run. A change comes after a sample at the same
    /// time. Changes later than the last sample have no effect; they are accepted because a ramp may end with the run.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a change after the end of the run, or of the number of boats or leaders, and if all
    /// changes come too late for any sample.
    pub fn with_changes(mut self, mut changes: Vec<(Ticks, Change)>) -> Result<Self> {
        let numbers = |parameters: &FlockParameters| (parameters.n_boats, parameters.n_leaders);
        let keeps_numbers = |change: &Change| match change {
            Change::Target(_) => true,
            Change::Parameters(new) => numbers(new) == numbers(self.flock.parameters()),
        };
        let all_keep_numbers = changes.iter().all(|(_, change)| keeps_numbers(change));
        let (refused, accepted) = ("other n_boats or n_leaders", "those of the run's start");
        FlockError::unless(all_keep_numbers, "schedule", refused, accepted)?;
        changes.sort_by_key(|&(time, _)| time);
        if let (Some(&(first, _)), Some(&(last, _))) = (changes.first(), changes.last()) {
            let last_sample = self.sampling.time(self.sampling.count() - 1);
            let first_is_sampled = first < last_sample;
            let last_is_in_run = last <= self.sampling.end;
            let refused = if first_is_sampled { last } else { first };
            let accepted = format!(
                "changes before the last sample, at {} s",
                seconds(last_sample)
            );
            let change = format!("a change at {} s", seconds(refused));
            FlockError::unless(
                first_is_sampled && last_is_in_run,
                "schedule",
                change,
                accepted,
            )?;
        }
        self.changes = changes.into();
        Ok(self)
    }

    /// Holds rudder commands between control steps. They are 0 until [`Self::steer`] is called.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a rate out of range.
    pub fn with_control(mut self, control_hz: f64) -> Result<Self> {
        let is_rate = control_hz > 0.0 && control_hz <= Sampling::FASTEST_HZ;
        let accepted = "a positive rate of at most 1e6 control steps a second";
        FlockError::unless(is_rate, "control_hz", control_hz, accepted)?;
        self.control = Some(Control {
            hz: control_hz,
            started_steps: 0,
            rudder: vec![0.0; self.flock.parameters().n_leaders],
        });
        Ok(self)
    }

    /// The flock as it is now.
    pub fn flock(&self) -> &Flock {
        &self.flock
    }

    /// The rudder commands that are held; empty if the steering law steers.
    pub fn rudder(&self) -> &[f64] {
        self.control
            .as_ref()
            .map_or(&[], |control| &control.rudder[..])
    }

    /// Holds these rudder commands from now on, if the run has control steps.
    ///
    /// # Errors
    /// As for [`Flock::check_rudder`].
    pub fn steer(&mut self, rudder: Vec<f64>) -> Result<()> {
        self.flock.check_rudder(Some(&rudder))?;
        if let Some(control) = &mut self.control {
            control.rudder = rudder;
        }
        Ok(())
    }

    /// Continues until about `boat_substeps` (substeps times boats) are done, a control step starts, or the run ends.
    /// Pauses do not change the run.
    ///
    /// # Errors
    /// As for [`Flock::advance_to`] and [`Flock::change`].
    pub fn run(&mut self, keep_going: KeepGoing, boat_substeps: u64) -> Result<Pause> {
        let mut work_left = boat_substeps;
        loop {
            let now = self.flock.time() - self.start;
            self.sample_and_change(now)?;
            if let Some(control) = &mut self.control
                && control.next_start().is_some_and(|start| start <= now)
            {
                control.started_steps += 1;
                return Ok(Pause::Control);
            }
            if self.samples_taken == self.sampling.count() {
                return Ok(Pause::End);
            }
            if work_left == 0 {
                return Ok(Pause::Work);
            }
            let steering = match &self.control {
                Some(control) => Steering::Held(&control.rudder),
                None => Steering::Law,
            };
            let substeps_before = self.flock.statistics().substeps;
            let next_event = self.start + self.next_event();
            let stop = self.flock.stop_towards(next_event, work_left);
            self.flock.advance_to(keep_going, stop, steering)?;
            let substeps = self.flock.statistics().substeps - substeps_before;
            work_left = work_left.saturating_sub(substeps * self.flock.parameters().n_boats as u64);
        }
    }

    /// Takes the sample that is due, then applies the changes that are due.
    fn sample_and_change(&mut self, now: Ticks) -> Result<()> {
        let is_due = self.samples_taken < self.sampling.count()
            && self.sampling.time(self.samples_taken) == now;
        if is_due {
            let rudder = self.control.as_ref().map(|control| &control.rudder[..]);
            self.recording.push(&self.flock, rudder);
            self.samples_taken += 1;
        }
        while let Some((_, change)) = self.changes.pop_front_if(|(time, _)| *time <= now) {
            self.flock.change(&change)?;
        }
        Ok(())
    }

    /// When the next sample, change or control step comes, counted from the start of the run.
    fn next_event(&self) -> Ticks {
        let mut next = self.sampling.time(self.samples_taken);
        if let Some(&(time, _)) = self.changes.front() {
            next = next.min(time);
        }
        if let Some(start) = self.control.as_ref().and_then(Control::next_start) {
            next = next.min(start);
        }
        next
    }

    /// Time in s since the start of the run.
    pub fn elapsed_s(&self) -> f64 {
        seconds(self.flock.time() - self.start)
    }

    /// The recording.
    pub fn into_recording(self) -> Recording<T> {
        self.recording
    }
}
