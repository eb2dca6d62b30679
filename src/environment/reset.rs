//! Options of a reset, and the initial flock of an episode.

use super::{Drawn, EnvSettings, EpisodeSchedule, TargetChoice};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::flock::{Flock, LATEST, State};
use crate::parameters::FlockParameters;

/// Start of an episode.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Start {
    /// Placed at random from the episode's seed, at rest.
    #[default]
    Random,
    /// A given state.
    State(State),
    /// A flock's snapshot, with its backward duration.
    Snapshot {
        /// The snapshot.
        bytes: Vec<u8>,
        /// Seed of other noise; `None`: the noise of the snapshot.
        noise_seed: Option<u64>,
    },
}

/// Options of a reset.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResetRequest {
    /// A new seed of the environment; `None` continues with its next episode.
    pub seed: Option<u64>,
    /// Target of this episode; `None`: as the settings say.
    pub target: Option<TargetChoice>,
    /// Length of the backward phase in this episode in s; `None`: as the settings say.
    pub bw_s: Option<Drawn>,
    /// Its start.
    pub start: Start,
}

/// Settings of future episodes, which a reset can override.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Upcoming {
    /// Target of these episodes; `None`: as the settings say.
    pub target: Option<TargetChoice>,
    /// Length of their backward phase in s; `None`: as the settings say.
    pub bw_s: Option<Drawn>,
}

impl Upcoming {
    /// The environment's settings with those of future episodes put in.
    pub fn settings(&self, settings: &EnvSettings) -> EnvSettings {
        EnvSettings {
            target: self.target.as_ref().unwrap_or(&settings.target).clone(),
            bw_s: self.bw_s.or(settings.bw_s),
            // Fixed, since the default length depends on the target.
            episode_s: Some(settings.duration_s()),
            ..settings.clone()
        }
    }
}

impl ResetRequest {
    /// This request, completed by the settings of future episodes.
    #[must_use]
    pub(super) fn completed_by(&self, upcoming: &Upcoming) -> Self {
        let mut request = self.clone();
        request.target = request.target.or_else(|| upcoming.target.clone());
        // A snapshot has its own backward duration.
        request.bw_s = request.bw_s.or(upcoming.bw_s);
        request
    }

    /// The episode and the flock that the request describes.
    ///
    /// # Errors
    /// [`FlockError`] for a request that cannot be met.
    pub fn build(
        &self,
        settings: &EnvSettings,
        parameters: &FlockParameters,
        flock_seed: u64,
        keep_going: KeepGoing,
    ) -> Result<(EpisodeSchedule, Flock)> {
        let target = self.target.as_ref().unwrap_or(&settings.target);
        target.check(parameters.n_leaders)?;
        let (schedule, share) = EpisodeSchedule::new(settings, target, flock_seed);
        self.bw_s.map_or(Ok(()), |bw_s| bw_s.check("bw_s"))?;
        let bw_s = self.bw_s.or(settings.bw_s);
        let own = FlockParameters {
            bw_s: bw_s.map_or(parameters.bw_s, |bw_s| bw_s.at(share)),
            ..parameters.clone()
        };
        let mut flock = match &self.start {
            Start::Snapshot { bytes, noise_seed } => Flock::from_snapshot(bytes, *noise_seed)?,
            Start::Random => Flock::new_while(keep_going, own, flock_seed)?,
            Start::State(state) => Flock::from_state(own, flock_seed, state)?,
        };
        check_flock(&flock, parameters)?;
        let is_early = flock.time() + settings.time_of(schedule.steps) <= LATEST;
        let accepted = "a time that leaves a whole episode before 1e9 s";
        FlockError::unless(is_early, "time_s", flock.time_s(), accepted)?;
        flock.set_target(schedule.targets())?;
        Ok((schedule, flock))
    }
}

/// Refuses a snapshot's flock that does not fit an environment with these parameters.
pub(super) fn check_flock(flock: &Flock, parameters: &FlockParameters) -> Result<()> {
    let same = FlockParameters {
        target: parameters.target.clone(),
        bw_s: parameters.bw_s,
        ..flock.parameters().clone()
    };
    let why = "the snapshot's flock has other parameters than the environment; only target and bw_s may differ";
    FlockError::unless_fitting(same == *parameters, why)
}
