//! The schedule of an episode: its length, its target at each time, and what a seed fixes.

use crate::clock::{Ticks, ticks};
use crate::error::{FlockError, Result};
use crate::parameters::{Target, named_choice};
use crate::random::Stream;
use rand::RngExt;
use rand_chacha::rand_core::Rng;

named_choice! {
    /// Which direction an episode's target is.
    pub enum TargetChoice ("target") {
        /// Clockwise throughout.
        Clockwise = "cw",
        /// Counter-clockwise throughout.
        CounterClockwise = "ccw",
        /// One of the two, drawn for the episode.
        Random = "random",
        /// Counter-clockwise, clockwise, counter-clockwise, clockwise, a quarter of the episode each
        /// (figure 7).
        Alternate = "alternate",
    }
}

/// How episodes are made.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSettings {
    /// Length in s; `None`: 480 s, and 960 s where targets alternate.
    pub episode_s: Option<f64>,
    /// Control steps per second.
    pub control_hz: f64,
    /// The direction to lead in.
    pub target: TargetChoice,
    /// Range that bw_s is drawn from, uniformly, for each episode; `None`: the parameters' own.
    pub bw_range_s: Option<(f64, f64)>,
}

impl Default for EpisodeSettings {
    fn default() -> Self {
        Self {
            episode_s: None,
            control_hz: 10.0,
            target: TargetChoice::Clockwise,
            bw_range_s: None,
        }
    }
}

impl EpisodeSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self) -> Result<()> {
        if !(0.1..=1000.0).contains(&self.control_hz) {
            let accepted = "0.1 to 1000 control steps per second";
            return Err(FlockError::parameter(
                "control_hz",
                self.control_hz,
                accepted,
            ));
        }
        let duration = self.duration_s();
        let steps = duration * self.control_hz;
        if !(duration <= 1e6 && (0.5..=1e9).contains(&steps)) {
            let accepted = "at least one control step, at most 1e6 s";
            return Err(FlockError::parameter("episode_s", duration, accepted));
        }
        match self.bw_range_s {
            Some((low, high)) if !(0.0 <= low && low <= high && high <= 1e6) => {
                Err(FlockError::parameter(
                    "bw_s",
                    format!("({low}, {high})"),
                    "a range (low, high) with 0 <= low <= high <= 1e6",
                ))
            }
            _ => Ok(()),
        }
    }

    /// Length of an episode in s.
    pub fn duration_s(&self) -> f64 {
        self.episode_s.unwrap_or(match self.target {
            TargetChoice::Alternate => 960.0,
            _ => 480.0,
        })
    }

    /// Length of an episode in control steps.
    pub fn steps(&self) -> u32 {
        (self.duration_s() * self.control_hz).round() as u32
    }

    /// Time from an episode's start to the end of so many control steps, to the nearest tick: where a
    /// period is no whole number of ticks, rounding does not add up.
    pub(crate) fn time_of(&self, steps: u32) -> Ticks {
        ticks(f64::from(steps) / self.control_hz)
    }
}

/// One episode: what was drawn for it and how far it is.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSchedule {
    /// Seed of the flock: of its start, its noise, what is drawn for the episode, and the camera.
    pub flock_seed: u64,
    /// Control steps taken.
    pub step: u32,
    /// Control steps until the time limit.
    pub steps: u32,
    /// Length of the backward phase in s.
    pub bw_s: f64,
    target: EpisodeTarget,
}

/// The target of an episode as a function of its steps.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
enum EpisodeTarget {
    Constant(Target),
    Alternating,
}

impl EpisodeSchedule {
    /// Draws an episode. bw and target are drawn from the flock's seed whether they are used or not, so
    /// that neither depends on the other being fixed.
    pub fn new(settings: &EpisodeSettings, flock_seed: u64, own_bw_s: f64) -> Self {
        let mut rng = Stream::Episode.rng(flock_seed);
        let share: f64 = rng.random_range(0.0..1.0);
        let drawn = if rng.next_u64() & 1 == 0 {
            Target::Clockwise
        } else {
            Target::CounterClockwise
        };
        Self {
            flock_seed,
            step: 0,
            steps: settings.steps(),
            bw_s: settings
                .bw_range_s
                .map_or(own_bw_s, |(low, high)| low + share * (high - low)),
            target: match settings.target {
                TargetChoice::Clockwise => EpisodeTarget::Constant(Target::Clockwise),
                TargetChoice::CounterClockwise => EpisodeTarget::Constant(Target::CounterClockwise),
                TargetChoice::Random => EpisodeTarget::Constant(drawn),
                TargetChoice::Alternate => EpisodeTarget::Alternating,
            },
        }
    }

    /// The target of the control step that comes next; after the last one, that of the last.
    pub fn target(&self) -> Target {
        match self.target {
            EpisodeTarget::Constant(target) => target,
            EpisodeTarget::Alternating => {
                let step = u64::from(self.step.min(self.steps.saturating_sub(1)));
                if (4 * step / u64::from(self.steps.max(1))).is_multiple_of(2) {
                    Target::CounterClockwise
                } else {
                    Target::Clockwise
                }
            }
        }
    }

    /// Part of the episode that is over, in [0, 1].
    pub fn elapsed(&self) -> f64 {
        f64::from(self.step) / f64::from(self.steps)
    }

    /// Whether the time limit is reached.
    pub(crate) fn is_over(&self) -> bool {
        self.step >= self.steps
    }
}

/// The seeds of an environment's episodes: the first is the environment's own, the others follow from it
/// and their number.
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
        let mut rng = Stream::EpisodeSeeds.rng(self.seed);
        rng.set_stream(episode);
        rng.next_u64()
    }
}
