//! Everything about an environment that is not the flock's own parameters.

use super::observation::{Block, CameraSettings, ObservationLayout, Observer};
use super::{ActionSettings, EpisodeSettings, RewardWeights, RudderSettings};
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, named_choice};

named_choice! {
    /// What happens when an episode has ended.
    pub enum Autoreset ("autoreset_mode") {
        /// The next step starts a new episode and ignores its action.
        NextStep = "next_step",
        /// The same step starts a new episode; the last observation is kept aside.
        SameStep = "same_step",
        /// Nothing: the user resets.
        Disabled = "disabled",
    }
}

/// The settings of an environment.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EnvSettings {
    /// Episodes.
    pub episode: EpisodeSettings,
    /// What is observed.
    pub observation: ObservationLayout,
    /// What the camera does to it.
    pub camera: CameraSettings,
    /// What is rewarded.
    pub reward: RewardWeights,
    /// How actions become rudders.
    pub rudder: RudderSettings,
    /// What happens at an episode's end.
    pub autoreset: Autoreset,
    /// What actions stand for, and how long they are held.
    pub action: ActionSettings,
    /// Time in s over which rewards are means; `None`: one control step.
    pub reward_horizon_s: Option<f64>,
}

impl Default for EnvSettings {
    fn default() -> Self {
        Self {
            episode: EpisodeSettings::default(),
            observation: ObservationLayout::default(),
            camera: CameraSettings::default(),
            reward: RewardWeights::default(),
            rudder: RudderSettings::default(),
            autoreset: Autoreset::NextStep,
            action: ActionSettings::default(),
            reward_horizon_s: None,
        }
    }
}

impl EnvSettings {
    /// Checks the settings for flocks with these checked parameters.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] names the first setting that is not accepted.
    pub fn check(&self, parameters: &FlockParameters) -> Result<()> {
        if parameters.n_leaders == 0 {
            return Err(FlockError::parameter(
                "n_leaders",
                0,
                "at least 1 in an environment; simulate runs flocks without leaders",
            ));
        }
        self.episode.check()?;
        self.episode.target.check(parameters.n_leaders)?;
        self.observation.check()?;
        self.camera.check()?;
        self.rudder.check()?;
        self.action.check(parameters, self.episode.control_hz)?;
        Observer::new(self.observation, parameters)?;
        if let Some(horizon) = self.reward_horizon_s
            && !(horizon > 0.0 && horizon <= 1e6)
        {
            let accepted = "a positive time of at most 1e6 s, or none";
            return Err(FlockError::parameter("reward_horizon_s", horizon, accepted));
        }
        for block in [Block::Order, Block::LeanFeatures] {
            if self.observation.has(block) && parameters.n_leaders == parameters.n_boats {
                return Err(FlockError::parameter(
                    block.option(),
                    true,
                    "order parameters are of the normal boats and need n_boats > n_leaders",
                ));
            }
        }
        self.reward.check(parameters)
    }
    /// Control steps from one decision to the next.
    pub fn period_steps(&self) -> u32 {
        self.action.control_steps(self.episode.control_hz)
    }

    /// What the weighted sum of a control step's terms is multiplied by.
    pub(crate) fn reward_factor(&self) -> f64 {
        self.reward_horizon_s
            .map_or(1.0, |horizon| 1.0 / (self.episode.control_hz * horizon))
    }
}
