//! The task that leaders are trained on: episodes, observations, rewards, many flocks at once.

mod env_batch;
mod episode;
mod flock_env;
mod reset;
mod reward;
mod rudder;
mod run;
mod settings;
mod totals;

pub use env_batch::{BatchRows, EnvBatch};
pub use episode::{Episode, EpisodeSeeds, EpisodeSettings, TargetChoice};
pub use flock_env::FlockEnv;
pub use reset::{ResetRequest, Start};
pub use reward::{Reward, RewardTerm, RewardTerms, RewardWeights, TERMS};
pub use rudder::{RudderSettings, Servo};
pub use run::Run;
pub use settings::{Autoreset, EnvSettings};
pub use totals::{EpisodeSummary, ORDERED_WITHIN, TOWARDS_TARGET};
