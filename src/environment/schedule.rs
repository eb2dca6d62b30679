//! The schedule of an episode: its length, its target at each time, and the draws from its seed.

use super::{EnvSettings, TargetChoice};
use crate::parameters::{Target, Targets};
use crate::random::Stream;
use rand::RngExt;
use rand_chacha::rand_core::Rng;

/// One episode: its random draws and its progress.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSchedule {
    /// Seed of the flock's placement and noise, of the episode's draws, and of the camera.
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
    /// Draws an episode, and a number in [0, 1) that chooses its backward duration within a range. The target and this
    /// number are drawn from the flock's seed even if they are not used, so that fixing one does not change the other.
    pub fn new(settings: &EnvSettings, target: &TargetChoice, flock_seed: u64) -> (Self, f64) {
        let mut rng = Stream::EPISODE.rng(flock_seed);
        let fraction: f64 = rng.random_range(0.0..1.0);
        let drawn_target = if rng.next_u64() & 1 == 0 {
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
                TargetChoice::Random => drawn_target.into(),
                TargetChoice::Alternate => Target::CounterClockwise.into(),
            },
            alternates: *target == TargetChoice::Alternate,
        };
        (schedule, fraction)
    }

    /// The targets of the next control step; after the last step, still its targets.
    pub fn targets(&self) -> Targets {
        if !self.alternates {
            return self.targets.clone();
        }
        let step = u64::from(self.step.min(self.steps.saturating_sub(1)));
        let quarter = 4 * step / u64::from(self.steps.max(1));
        let first_target = self.targets.reference();
        Targets::One(if quarter.is_multiple_of(2) {
            first_target
        } else {
            first_target.opposite()
        })
    }

    /// Elapsed fraction of the episode, in [0, 1].
    pub fn elapsed(&self) -> f64 {
        f64::from(self.step) / f64::from(self.steps)
    }
}

/// The flock seeds of an environment's episodes. The first is the environment's seed; the others are drawn from it and
/// the episode's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSeeds {
    /// Seed of the environment.
    seed: u64,
    /// Number of the next episode, from 0.
    next: u64,
}

impl EpisodeSeeds {
    /// The seeds of an environment with this seed, before its first episode.
    pub fn new(seed: u64) -> Self {
        Self { seed, next: 0 }
    }

    /// Returns the seed of the next episode's flock, and goes on to the episode after it.
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
