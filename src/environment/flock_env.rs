//! One flock as an environment: one seeded episode after another.

use super::episode::EpisodeState;
use super::observation::{FlockFeatures, ObservationLayout, StateObserver};
use super::{
    Autoreset, EnvSettings, Episode, EpisodeSeeds, EpisodeSummary, ResetRequest, Servo, Upcoming,
};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;

/// Stored state of an environment, with its episode as `E`: owned when read, borrowed when written.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct StoredEnv<E = EpisodeState> {
    seeds: Option<EpisodeSeeds>,
    upcoming: Upcoming,
    episode: Option<E>,
    finished: Option<EpisodeSummary>,
    final_observation: Vec<f32>,
}

/// A flock with its episodes.
#[derive(Debug, Clone)]
pub struct FlockEnv {
    parameters: FlockParameters,
    servo: Servo,
    state_observer: StateObserver,
    features: FlockFeatures,
    /// Seeds of the next episodes; `None` before the first reset.
    seeds: Option<EpisodeSeeds>,
    /// Settings of future episodes.
    upcoming: Upcoming,
    /// The present episode, or the last one if it has ended.
    episode: Option<Episode>,
    /// Summary of the last episode that reached its end.
    finished: Option<EpisodeSummary>,
    final_observation: Vec<f32>,
}

impl FlockEnv {
    /// An environment for checked settings and parameters, which needs a reset before it can be stepped.
    pub fn new(settings: &EnvSettings, parameters: FlockParameters) -> Self {
        Self {
            servo: settings.servo(),
            state_observer: StateObserver::new(&parameters, settings.mirror_to_target),
            features: FlockFeatures::new(&parameters),
            seeds: None,
            upcoming: Upcoming::default(),
            episode: None,
            finished: None,
            final_observation: Vec::new(),
            parameters,
        }
    }

    /// The parameters; an episode may have its own bw_s and target.
    pub fn parameters(&self) -> &FlockParameters {
        &self.parameters
    }

    /// The present episode, or the last one if it has ended; `None` before the first reset.
    pub fn episode(&self) -> Option<&Episode> {
        self.episode.as_ref()
    }

    /// Whether any reset so far had a seed.
    pub fn is_seeded(&self) -> bool {
        self.seeds.is_some()
    }

    /// Summary of the last episode that reached its end.
    pub fn finished(&self) -> Option<&EpisodeSummary> {
        self.finished.as_ref()
    }

    /// The last observations of the last episode that ended under [`Autoreset::SameStep`].
    pub fn final_observation(&self) -> &[f32] {
        &self.final_observation
    }

    /// Settings of future episodes.
    pub fn upcoming(&self) -> &Upcoming {
        &self.upcoming
    }

    /// Sets checked options of future episodes.
    pub(crate) fn set_upcoming(&mut self, upcoming: Upcoming) {
        self.upcoming = upcoming;
    }

    /// Checks options of future episodes.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for options that this flock cannot have.
    pub(crate) fn check_upcoming(&self, settings: &EnvSettings, upcoming: &Upcoming) -> Result<()> {
        // The settings check both ends of a range; the parameters need only one number.
        let shortest_bw_s = upcoming
            .bw_s
            .map_or(self.parameters.bw_s, |bw_s| bw_s.at(0.0));
        let parameters = FlockParameters {
            bw_s: shortest_bw_s,
            ..self.parameters.clone()
        };
        parameters.check()?;
        upcoming.settings(settings).check(&parameters)
    }

    /// Makes the next episode, which [`Self::start`] starts; the environment does not change.
    ///
    /// # Errors
    /// [`FlockError::Episode`] if neither this reset nor an earlier one has a seed, and errors of the request.
    pub(crate) fn prepare(
        &self,
        settings: &EnvSettings,
        request: &ResetRequest,
        keep_going: KeepGoing,
    ) -> Result<(EpisodeSeeds, Episode)> {
        let Some(mut seeds) = request.seed.map(EpisodeSeeds::new).or(self.seeds) else {
            let message = "the first reset of an environment needs a seed";
            return Err(FlockError::Episode(message.to_owned()));
        };
        let flock_seed = seeds.next_seed();
        let request = request.completed_by(&self.upcoming);
        let (schedule, flock) =
            request.build(settings, &self.parameters, flock_seed, keep_going)?;
        Ok((seeds, Episode::new(settings, schedule, flock)?))
    }

    /// Starts a prepared episode, and writes its first observations.
    pub(crate) fn start(&mut self, prepared: (EpisodeSeeds, Episode), observations: &mut [f32]) {
        let (seeds, mut episode) = prepared;
        episode.observe_and_count(observations);
        (self.seeds, self.episode) = (Some(seeds), Some(episode));
    }

    /// Drops the episode. The environment must be reset before its next step.
    pub(crate) fn abandon(&mut self) {
        self.episode = None;
    }

    /// Checks that the environment can be stepped. The step may be one that only starts the next episode.
    ///
    /// # Errors
    /// [`FlockError::Episode`] if the environment has to be reset first.
    pub(crate) fn check_ready(&self, autoreset: Autoreset) -> Result<()> {
        let message = match &self.episode {
            None => "step was called before reset; call reset first",
            Some(episode) if episode.has_ended() && autoreset == Autoreset::Disabled => {
                "step was called after the episode's end; call reset first"
            }
            Some(_) => return Ok(()),
        };
        Err(FlockError::Episode(message.to_owned()))
    }

    /// Takes one decision with checked actions and holds them over the control steps until the next decision. If the
    /// episode has ended, starts the next one instead. Without actions leaders follow the steering law at every substep.
    /// Writes observations and rewards of the leaders; returns whether this step reached the episode's time limit.
    ///
    /// # Errors
    /// [`FlockError::Solver`], [`FlockError::Placement`], [`FlockError::Interrupted`]; the episode is over then.
    pub fn step(
        &mut self,
        keep_going: KeepGoing,
        settings: &EnvSettings,
        actions: Option<&[f64]>,
        observations: &mut [f32],
        rewards: &mut [f64],
    ) -> Result<bool> {
        self.check_ready(settings.autoreset_mode)?;
        if self.episode.as_ref().is_some_and(Episode::has_ended) {
            rewards.fill(0.0);
            self.start_next(keep_going, settings, observations)?;
            return Ok(false);
        }
        let Some(episode) = &mut self.episode else {
            return Ok(false);
        };
        episode.step(keep_going, settings, &self.servo, actions, rewards)?;
        episode.observe_and_count(observations);
        if !episode.has_ended() {
            return Ok(false);
        }
        self.finished = Some(episode.summary());
        if settings.autoreset_mode == Autoreset::SameStep {
            self.final_observation.clear();
            self.final_observation.extend_from_slice(observations);
            self.start_next(keep_going, settings, observations)?;
        }
        Ok(true)
    }

    /// Adds rewards that a user computed, one per leader, to those of the last step.
    pub(crate) fn add_rewards(&mut self, rewards: &[f64]) {
        let Some(episode) = &mut self.episode else {
            return;
        };
        episode.add_user_rewards(rewards);
        if episode.has_ended() {
            self.finished = Some(episode.summary());
        }
    }

    /// Starts the next episode, with the next seed, and writes its first observations.
    fn start_next(
        &mut self,
        keep_going: KeepGoing,
        settings: &EnvSettings,
        observations: &mut [f32],
    ) -> Result<()> {
        let next = self.prepare(settings, &ResetRequest::default(), keep_going)?;
        self.start(next, observations);
        Ok(())
    }

    /// Writes the leaders' present observations, zeros before the first reset.
    pub fn observe(&mut self, out: &mut [f32]) {
        match &mut self.episode {
            Some(episode) => {
                episode.observe(out);
            }
            None => out.fill(0.0),
        }
    }

    /// Writes the leaders' present observations in another layout, zeros before the first reset.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a layout that the flock cannot have.
    pub(crate) fn observe_in(&self, layout: ObservationLayout, out: &mut [f32]) -> Result<()> {
        match &self.episode {
            Some(episode) => episode.observe_in(layout, out),
            None => {
                out.fill(0.0);
                Ok(())
            }
        }
    }

    /// Number of entries of the global state.
    pub fn state_size(&self) -> usize {
        self.state_observer.size()
    }

    /// Writes the global state, zeros before the first reset.
    pub fn observe_state(&self, out: &mut [f32]) {
        match &self.episode {
            Some(episode) => episode.observe_state(&self.state_observer, out),
            None => out.fill(0.0),
        }
    }

    /// Writes the features of the flock for leaders 0, 1, … one after another, each in the frame of its own target;
    /// zeros before the first reset.
    pub fn observe_features(&self, out: &mut [f32]) {
        let Some(episode) = &self.episode else {
            out.fill(0.0);
            return;
        };
        let targets = episode.targets();
        // Without leaders there are no rows.
        let Some((first_row, other_rows)) = out.split_at_mut_checked(FlockFeatures::SIZE) else {
            return;
        };
        episode.observe_features(&self.features, targets.reference(), first_row);
        let other_rows = other_rows.chunks_exact_mut(FlockFeatures::SIZE);
        for (leader, row) in (1..).zip(other_rows) {
            let target = targets.of(leader);
            if target == targets.reference() {
                row.copy_from_slice(first_row);
            } else {
                episode.observe_features(&self.features, target, row);
            }
        }
    }

    /// The environment in its stored form.
    pub(crate) fn stored(&self) -> StoredEnv<&EpisodeState> {
        StoredEnv {
            seeds: self.seeds,
            upcoming: self.upcoming.clone(),
            episode: self.episode.as_ref().map(Episode::state),
            finished: self.finished,
            final_observation: self.final_observation.clone(),
        }
    }

    /// A copy of this environment that continues from a stored state.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if the state does not fit this environment.
    pub(crate) fn restored(&self, settings: &EnvSettings, stored: StoredEnv) -> Result<Self> {
        let episode = stored
            .episode
            .map(|episode| Episode::restored(settings, &self.parameters, episode))
            .transpose()?;
        let observation_size = self.parameters.n_leaders * settings.observation.size();
        // Before the first end of an episode there is no final observation.
        let is_size_right = [0, observation_size].contains(&stored.final_observation.len());
        let is_seed_missing = episode.is_some() && stored.seeds.is_none();
        let fits = is_size_right && !is_seed_missing;
        FlockError::unless_fitting(fits, "the state belongs to another environment")?;
        let mut restored = Self::new(settings, self.parameters.clone());
        restored.check_upcoming(settings, &stored.upcoming)?;
        (restored.seeds, restored.upcoming) = (stored.seeds, stored.upcoming);
        restored.episode = episode;
        restored.finished = stored.finished;
        restored.final_observation = stored.final_observation;
        Ok(restored)
    }
}
