//! Everything about an environment that is not the flock's own parameters.

use super::observation::{CameraSettings, ObservationLayout};
use super::{EpisodeSettings, RewardWeights, RudderSettings};
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

/// The settings of an environment. States of format 1 hold them in this order; what was added since is left out of
/// it by `#[serde(skip)]`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
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
        self.observation.check()?;
        self.camera.check()?;
        self.rudder.check()?;
        if self.observation.order && parameters.n_leaders == parameters.n_boats {
            return Err(FlockError::parameter(
                "observation order",
                true,
                "order parameters are of the normal boats and need n_boats > n_leaders",
            ));
        }
        self.reward.check(parameters)
    }
}
