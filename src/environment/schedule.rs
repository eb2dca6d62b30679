//! The schedule of an episode: its length, its target at each time, and what a seed fixes.

use crate::clock::{Ticks, ticks};
use crate::error::{FlockError, Result};
use crate::parameters::{Target, Targets};
use crate::random::Stream;
use rand::RngExt;
use rand_chacha::rand_core::Rng;

/// Which direction an episode's target is. States of format 1 hold the variants' places.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum TargetChoice {
    /// Clockwise throughout.
    Clockwise,
    /// Counter-clockwise throughout.
    CounterClockwise,
    /// One of the two, drawn for the episode.
    Random,
    /// Counter-clockwise, clockwise, counter-clockwise, clockwise, a quarter of the episode each
    /// (figure 7).
    Alternate,
    /// One per leader, throughout.
    Each(Vec<Target>),
}

impl TargetChoice {
    /// The choices that have a name.
    const NAMED: [(&'static str, Self); 4] = [
        ("cw", Self::Clockwise),
        ("ccw", Self::CounterClockwise),
        ("random", Self::Random),
        ("alternate", Self::Alternate),
    ];

    /// The choice of that name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] lists the names there are.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::NAMED.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, choice)| choice).ok_or_else(|| {
            let names = Self::NAMED.map(|(known, _)| format!("{known:?}"));
            let accepted = format!(
                "one of {}, or a list of \"cw\" and \"ccw\", one per leader",
                names.join(", ")
            );
            FlockError::parameter("target", format!("{name:?}"), accepted)
        })
    }

    /// The choice of one target per leader.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for what is no direction: what is drawn and what alternates is one for all leaders.
    pub fn each(names: &[String]) -> Result<Self> {
        let target = |name: &String| {
            name.parse().map_err(|_| {
                let accepted = "a list of \"cw\" and \"ccw\", one per leader; \"random\" and \"alternate\" hold for all leaders and stand alone";
                FlockError::parameter("target", format!("{names:?}"), accepted)
            })
        };
        Ok(Self::Each(names.iter().map(target).collect::<Result<_>>()?))
    }

    /// The public name; `None` for a list.
    pub fn name(&self) -> Option<&'static str> {
        let found = Self::NAMED.into_iter().find(|(_, known)| known == self);
        found.map(|(name, _)| name)
    }

    /// Checks that a list has one target per leader.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self, n_leaders: usize) -> Result<()> {
        match self {
            Self::Each(targets) => Targets::Each(targets.clone()).check(n_leaders),
            _ => Ok(()),
        }
    }
}

/// How episodes are made.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
enum EpisodeTarget {
    Constant(Target),
    Alternating,
    Each(Vec<Target>),
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
            target: match &settings.target {
                TargetChoice::Clockwise => EpisodeTarget::Constant(Target::Clockwise),
                TargetChoice::CounterClockwise => EpisodeTarget::Constant(Target::CounterClockwise),
                TargetChoice::Random => EpisodeTarget::Constant(drawn),
                TargetChoice::Alternate => EpisodeTarget::Alternating,
                TargetChoice::Each(targets) => EpisodeTarget::Each(targets.clone()),
            },
        }
    }

    /// The targets of the control step that comes next; after the last one, those of the last.
    pub fn targets(&self) -> Targets {
        match &self.target {
            EpisodeTarget::Constant(target) => Targets::One(*target),
            EpisodeTarget::Alternating => {
                let step = u64::from(self.step.min(self.steps.saturating_sub(1)));
                let is_even = (4 * step / u64::from(self.steps.max(1))).is_multiple_of(2);
                Targets::One(if is_even {
                    Target::CounterClockwise
                } else {
                    Target::Clockwise
                })
            }
            EpisodeTarget::Each(targets) => Targets::Each(targets.clone()),
        }
    }

    /// The reference direction of the same control step: the target of all leaders, or leader 0's.
    pub fn target(&self) -> Target {
        self.targets().reference()
    }

    /// Whether each leader has a target of its own.
    pub(crate) fn has_own_targets(&self) -> bool {
        matches!(self.target, EpisodeTarget::Each(_))
    }

    /// Whether the targets change in the course of the episode.
    pub(crate) fn alternates(&self) -> bool {
        self.target == EpisodeTarget::Alternating
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
