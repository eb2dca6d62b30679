//! The task that leaders are trained on: episodes, observations, rewards, many flocks at once.

mod action;
mod batch;
mod credit;
mod drawn;
mod episode;
mod flock_env;
pub mod observation;
mod reset;
mod reward;
mod schedule;
mod servo;
mod settings;
mod statistics;

pub use action::{ActionMode, LARGEST_LEAN};
pub use batch::{BatchRows, EnvBatch};
pub use drawn::{Drawn, TargetChoice};
pub use episode::Episode;
pub use flock_env::FlockEnv;
pub use reset::{ResetRequest, Start, Upcoming};
pub use reward::{Reward, RewardTerm, RewardTerms, RewardWeights, TERMS, Weights};
pub use schedule::{EpisodeSchedule, EpisodeSeeds};
pub use servo::Servo;
pub use settings::{Autoreset, EnvSettings};
pub use statistics::{Averages, EpisodeSummary, ORDERED_WITHIN, TOWARDS_TARGET};
