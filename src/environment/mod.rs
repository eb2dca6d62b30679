//! The task that leaders are trained on: episodes, observations, rewards, many flocks at once.

mod action;
mod averages;
mod batch;
mod credit;
mod episode;
mod flock_env;
pub mod observation;
mod options;
mod reset;
mod reward;
mod rudder;
mod schedule;
mod settings;
mod statistics;

pub use action::{ActionMode, ActionSettings, LARGEST_LEAN};
pub use averages::Averages;
pub use batch::{BatchRows, EnvBatch};
pub use episode::Episode;
pub use flock_env::FlockEnv;
pub use options::{EnvOption, OPTIONS, OptionValue};
pub use reset::{ResetRequest, Start};
pub use reward::{Reward, RewardTerm, RewardTerms, RewardWeights, TERMS};
pub use rudder::{RudderSettings, Servo};
pub use schedule::{EpisodeSchedule, EpisodeSeeds, EpisodeSettings, TargetChoice};
pub use settings::{Autoreset, EnvSettings};
pub use statistics::{EpisodeSummary, LeaderSummary, ORDERED_WITHIN, TOWARDS_TARGET};
