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

/// Contacts that carried a force, sample after sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactSamples {
    /// Number of contacts in each sample.
    pub count: Vec<usize>,
    /// The contacts; their forces are means over the substep before the sample.
    pub contacts: Vec<ContactForce>,
}

impl ContactSamples {
    fn push(&mut self, flock: &Flock) {
        let before = self.contacts.len();
        let contacts = flock.contacts().into_iter();
        self.contacts
            .extend(contacts.filter(|contact| contact.force > 0.0));
        self.count.push(self.contacts.len() - before);
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
    /// Rudder commands of the leaders, sample after sample: the commands held up to each time, or, under the
    /// steering law, its commands at the recorded poses.
    pub rudder: Vec<f64>,
    /// Recorded quantities of the normal boats; all NaN without any.
    pub order: Vec<Recorded>,
    /// Contacts, if they are recorded.
    pub contacts: Option<ContactSamples>,
}

impl<T: Real> Recording<T> {
    /// Recordings beyond this many bytes (16 GiB) are taken for a mistake.
    pub const MOST_BYTES: u64 = 16 << 30;

    /// An empty recording with memory for a run.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if that is more than [`Self::MOST_BYTES`], or more than the memory left.
    pub fn with_capacity_for(sampling: &Sampling, parameters: &FlockParameters) -> Result<Self> {
        let samples = sampling.count();
        let state = 6 * parameters.n_boats as u64 * size_of::<T>() as u64;
        let rudders = parameters.n_leaders * size_of::<f64>();
        let other = (size_of::<Recorded>() + size_of::<f64>() + 2 + rudders) as u64;
        let bytes = samples.saturating_mul(state + other);
        let mut recording = Self::default();
        let fits = bytes <= Self::MOST_BYTES && recording.reserve(samples, parameters).is_some();
        let found = format!("{} samples of {} boats", samples, parameters.n_boats);
        let accepted = format!(
            "a recording of {bytes} bytes does not fit; at most {} bytes, and the memory there is: record a shorter run, \
             at a lower rate or in float32",
            Self::MOST_BYTES
        );
        FlockError::unless(fits, "duration_s * sample_hz", found, accepted)?;
        Ok(recording)
    }

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

    /// Takes a sample of a flock in its present state. `rudder` holds the leaders' commands; with `None` they
    /// follow the steering law.
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
            None => self.rudder.extend(leaders.map(|k| flock.steering_law(k))),
        }
        self.order
            .push(flock.recorded(false).unwrap_or([f64::NAN; RECORDED]));
        if let Some(contacts) = &mut self.contacts {
            contacts.push(flock);
        }
    }
}

/// Reason for a pause of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pause {
    /// The allowed amount of work is done; the run can continue at any time.
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
    control_steps: u64,
    rudder: Vec<f64>,
}

impl Control {
    fn next(&self) -> Ticks {
        ticks(self.control_steps as f64 / self.hz)
    }
}

/// A flock that moves by a schedule while it is recorded.
#[derive(Debug, Clone)]
pub struct Recorder<T> {
    flock: Flock,
    sampling: Sampling,
    start: Ticks,
    samples: u64,
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
            samples: 0,
            changes: VecDeque::new(),
            control: None,
            flock,
            sampling,
        })
    }

    /// Records contacts, too.
    #[must_use]
    pub fn with_contacts(mut self) -> Self {
        self.recording.contacts = Some(ContactSamples::default());
        self
    }

    /// Adds changes to the run. Times count from its start, and each change comes after the sample at its time. A
    /// ramp may end with the run.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a change after the end, and if no sample would show any of the changes.
    pub fn with_changes(mut self, mut changes: Vec<(Ticks, Change)>) -> Result<Self> {
        changes.sort_by_key(|&(time, _)| time);
        if let (Some(&(first, _)), Some(&(last, _))) = (changes.first(), changes.last()) {
            let last_sample = self.sampling.time(self.sampling.count() - 1);
            let refused = if first < last_sample { last } else { first };
            let accepted = format!(
                "changes before the last sample, at {} s",
                seconds(last_sample)
            );
            let found = format!("a change at {} s", seconds(refused));
            let is_shown = first < last_sample && last <= self.sampling.end;
            FlockError::unless(is_shown, "schedule", found, accepted)?;
        }
        self.changes = changes.into();
        Ok(self)
    }

    /// Holds rudders between control steps; they start amidships (0).
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a rate out of range.
    pub fn with_control(mut self, control_hz: f64) -> Result<Self> {
        let is_rate = control_hz > 0.0 && control_hz <= Sampling::FASTEST_HZ;
        let accepted = "a positive rate of at most 1e6 control steps a second";
        FlockError::unless(is_rate, "control_hz", control_hz, accepted)?;
        self.control = Some(Control {
            hz: control_hz,
            control_steps: 0,
            rudder: vec![0.0; self.flock.parameters().n_leaders],
        });
        Ok(self)
    }

    /// The flock as it is now.
    pub fn flock(&self) -> &Flock {
        &self.flock
    }

    /// The rudder commands that are held; none under the steering law.
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

    /// Continues for about this many substeps times boats, to the next control step, or to the end. Pauses do not
    /// change the run.
    ///
    /// # Errors
    /// As for [`Flock::advance_to`] and [`Flock::change`].
    pub fn run(&mut self, keep_going: KeepGoing, boat_substeps: u64) -> Result<Pause> {
        let mut left = boat_substeps;
        loop {
            let now = self.flock.time() - self.start;
            self.sample_and_change(now)?;
            if let Some(control) = &mut self.control
                && control.next() <= now
                && !control.rudder.is_empty()
            {
                control.control_steps += 1;
                return Ok(Pause::Control);
            }
            if self.samples == self.sampling.count() {
                return Ok(Pause::End);
            }
            if left == 0 {
                return Ok(Pause::Work);
            }
            let next = self.start + self.next_event();
            let steering = match &self.control {
                Some(control) => Steering::Held(&control.rudder),
                None => Steering::Law,
            };
            let before = self.flock.statistics().substeps;
            let stop = self.flock.stop_towards(next, left);
            self.flock.advance_to(keep_going, stop, steering)?;
            let substeps = self.flock.statistics().substeps - before;
            left = left.saturating_sub(substeps * self.flock.parameters().n_boats as u64);
        }
    }

    fn sample_and_change(&mut self, now: Ticks) -> Result<()> {
        if self.samples < self.sampling.count() && self.sampling.time(self.samples) == now {
            let held = self.control.as_ref().map(|control| &control.rudder[..]);
            self.recording.push(&self.flock, held);
            self.samples += 1;
        }
        while let Some((_, change)) = self.changes.pop_front_if(|(time, _)| *time <= now) {
            self.flock.change(&change)?;
        }
        Ok(())
    }

    fn next_event(&self) -> Ticks {
        let mut next = self.sampling.time(self.samples);
        if let Some(&(time, _)) = self.changes.front() {
            next = next.min(time);
        }
        if let Some(control) = &self.control
            && !control.rudder.is_empty()
        {
            next = next.min(control.next());
        }
        next
    }

    /// Seconds from the start of the run to where it is now.
    pub fn elapsed_s(&self) -> f64 {
        seconds(self.flock.time() - self.start)
    }

    /// The recording.
    pub fn into_recording(self) -> Recording<T> {
        self.recording
    }
}
