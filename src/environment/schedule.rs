//! The schedule of an episode: its length, its target at each time, and the draws from its seed.

use super::{EnvSettings, TargetChoice};
use crate::parameters::{Target, Targets};
use crate::random::Stream;
use rand::RngExt;
use rand_chacha::rand_core::Rng;

/// One episode: its random draws and its progress.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSchedule {
    /// Seed of the flock: of its start, its noise, the draws of the episode, and the camera.
    pub flock_seed: u64,
    /// Control steps taken.
    pub step: u32,
    /// Control steps until the time limit.
    pub steps: u32,
    /// The targets; if they alternate, those of the first quarter.
    targets: Targets,
    /// Whether the targets change during the episode.
    pub(super) alternates: bool,
}

impl EpisodeSchedule {
    /// Draws an episode, and a number in [0, 1) that chooses its backward duration within a range. Both are always
    /// drawn from the flock's seed, even if unused, so that fixing one does not change the other.
    pub fn new(settings: &EnvSettings, target: &TargetChoice, flock_seed: u64) -> (Self, f64) {
        let mut rng = Stream::EPISODE.rng(flock_seed);
        let share: f64 = rng.random_range(0.0..1.0);
        let drawn = if rng.next_u64() & 1 == 0 {
            Target::Clockwise
        } else {
            Target::CounterClockwise
        };
        let schedule = Self {
            flock_seed,
            step: 0,
            steps: settings.steps(),
            targets: match target {
                TargetChoice::Fixed(targets) => targets.clone(),
                TargetChoice::Random => drawn.into(),
                TargetChoice::Alternate => Target::CounterClockwise.into(),
            },
            alternates: *target == TargetChoice::Alternate,
        };
        (schedule, share)
    }

    /// The targets of the next control step; after the last step, the targets of the last.
    pub fn targets(&self) -> Targets {
        if !self.alternates {
            return self.targets.clone();
        }
        let step = u64::from(self.step.min(self.steps.saturating_sub(1)));
        let is_even = (4 * step / u64::from(self.steps.max(1))).is_multiple_of(2);
        let first = self.targets.reference();
        Targets::One(if is_even { first } else { first.opposite() })
    }

    /// Elapsed fraction of the episode, in [0, 1].
    pub fn elapsed(&self) -> f64 {
        f64::from(self.step) / f64::from(self.steps)
    }
}

/// The seeds of an environment's episodes: the first is the environment's own, and the others follow from it and from
/// the episode's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSeeds {
    seed: u64,
    next: u64,
}

impl EpisodeSeeds {
    /// Episodes of an environment with this seed.
    pub fn new(seed: u64) -> Self {
        Self { seed, next: 0 }
    }

    /// The seed of the next episode's flock.
    pub fn next_seed(&mut self) -> u64 {
        let episode = self.next;
        self.next += 1;
        if episode == 0 {
            return self.seed;
        }
        let mut rng = Stream::EPISODE_SEEDS.rng(self.seed);
        rng.set_stream(episode);
        rng.next_u64()
    }
}
