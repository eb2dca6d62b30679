//! Options of a reset, and the initial flock of an episode.

use super::{Drawn, EnvSettings, EpisodeSchedule, TargetChoice};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::flock::{Flock, LATEST, State};
use crate::parameters::FlockParameters;

/// Start of an episode.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Start {
    /// At rest, placed at random from the episode's seed.
    #[default]
    Random,
    /// A state that the user gives.
    State(State),
    /// A flock's snapshot, with its backward duration.
    Snapshot {
        /// The snapshot.
        bytes: Vec<u8>,
        /// Seed of new noise; `None`: the noise of the snapshot continues.
        noise_seed: Option<u64>,
    },
}

/// Options of a reset.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResetRequest {
    /// A new seed of the environment; `None` continues with its next episode.
    pub seed: Option<u64>,
    /// Target of this episode; `None`: that of the settings.
    pub target: Option<TargetChoice>,
    /// Length of the backward phase in this episode in s; `None`: that of the settings.
    pub bw_s: Option<Drawn>,
    /// Initial state of the episode.
    pub start: Start,
}

/// Settings of future episodes, which a reset can override.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Upcoming {
    /// Target of these episodes; `None`: that of the settings.
    pub target: Option<TargetChoice>,
    /// Length of their backward phase in s; `None`: that of the settings.
    pub bw_s: Option<Drawn>,
}

impl Upcoming {
    /// The environment's settings, overridden by these for future episodes.
    pub fn settings(&self, settings: &EnvSettings) -> EnvSettings {
        EnvSettings {
            target: self.target.as_ref().unwrap_or(&settings.target).clone(),
            bw_s: self.bw_s.or(settings.bw_s),
            // The default length depends on the target, so another target must not change it.
            episode_s: Some(settings.duration_s()),
            ..settings.clone()
        }
    }
}

impl ResetRequest {
    /// This request, with a missing target or backward duration taken from `upcoming`.
    #[must_use]
    pub(super) fn completed_by(&self, upcoming: &Upcoming) -> Self {
        let mut request = self.clone();
        request.target = request.target.or_else(|| upcoming.target.clone());
        request.bw_s = request.bw_s.or(upcoming.bw_s);
        request
    }

    /// The schedule and the initial flock of the episode that the request describes.
    ///
    /// # Errors
    /// [`FlockError`] for targets, states and snapshots that do not fit the environment, and for flocks that cannot be
    /// placed.
    pub fn build(
        &self,
        settings: &EnvSettings,
        parameters: &FlockParameters,
        flock_seed: u64,
        keep_going: KeepGoing,
    ) -> Result<(EpisodeSchedule, Flock)> {
        let target = self.target.as_ref().unwrap_or(&settings.target);
        target.check(parameters.n_leaders)?;
        let (schedule, fraction) = EpisodeSchedule::new(settings, target, flock_seed);
        self.bw_s.map_or(Ok(()), |bw_s| bw_s.check("bw_s"))?;
        let bw_s = self.bw_s.or(settings.bw_s);
        let episode_parameters = FlockParameters {
            bw_s: bw_s.map_or(parameters.bw_s, |bw_s| bw_s.at(fraction)),
            ..parameters.clone()
        };
        let mut flock = match &self.start {
            // A snapshot has its own backward duration.
            Start::Snapshot { bytes, noise_seed } => Flock::from_snapshot(bytes, *noise_seed)?,
            Start::Random => Flock::new_while(keep_going, episode_parameters, flock_seed)?,
            Start::State(state) => Flock::from_state(episode_parameters, flock_seed, state)?,
        };
        check_flock(&flock, parameters)?;
        let end = flock.time() + settings.time_of(schedule.steps);
        let accepted = "a time that leaves a whole episode before 1e9 s";
        FlockError::unless(end <= LATEST, "time_s", flock.time_s(), accepted)?;
        flock.set_target(schedule.targets())?;
        Ok((schedule, flock))
    }
}

/// Refuses a stored flock whose parameters, other than target and `bw_s`, differ from the environment's.
pub(super) fn check_flock(flock: &Flock, parameters: &FlockParameters) -> Result<()> {
    let flock_parameters = FlockParameters {
        target: parameters.target.clone(),
        bw_s: parameters.bw_s,
        ..flock.parameters().clone()
    };
    let reason = "the snapshot's flock has other parameters than the environment; only target and bw_s may differ";
    FlockError::unless_fitting(flock_parameters == *parameters, reason)
}
