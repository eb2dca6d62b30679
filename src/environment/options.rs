//! The options of environments, declared once: name, where the setting is, and what it means. The bindings, their
//! defaults and the documentation follow from this table.

use super::observation::{Block, ObservationLayout};
use super::{ActionMode, Autoreset, EnvSettings, RewardTerm, RewardWeights, TERMS, TargetChoice};
use crate::error::{FlockError, Result};

/// An option's value as it is given and shown outside.
#[derive(Debug, Clone, PartialEq)]
pub enum OptionValue {
    /// A real number.
    Real(f64),
    /// A real number or none.
    OptionalReal(Option<f64>),
    /// A range from low to high or none.
    OptionalRange(Option<(f64, f64)>),
    /// A whole number.
    Count(usize),
    /// A whole number or none.
    OptionalCount(Option<usize>),
    /// Yes or no.
    Flag(bool),
    /// One of several names.
    Name(String),
    /// Blocks of the observation: how often each occurs.
    Blocks(Vec<(Block, usize)>),
    /// Weights of the reward's terms; those left out weigh nothing.
    Weights(Vec<(RewardTerm, f64)>),
    /// A name for each leader.
    Names(Vec<String>),
}

/// What is declared of an option.
#[derive(Debug, Clone, Copy)]
pub struct EnvOption {
    /// Its name.
    pub name: &'static str,
    /// What it means, with its unit.
    pub doc: &'static str,
    /// The value in some settings.
    pub get: fn(&EnvSettings) -> OptionValue,
    /// Puts a value, of the kind that `get` returns, into settings. It is not checked yet.
    pub set: fn(&mut EnvSettings, OptionValue) -> Result<()>,
}

/// A type that settings have.
trait OptionType: Sized {
    fn shown(&self) -> OptionValue;
    fn read(&mut self, value: OptionValue) -> Result<()>;
}

macro_rules! option_types {
    ($($type:ty: $kind:ident;)+) => {
        $(impl OptionType for $type {
            fn shown(&self) -> OptionValue {
                OptionValue::$kind(*self)
            }

            fn read(&mut self, value: OptionValue) -> Result<()> {
                match value {
                    OptionValue::$kind(value) => *self = value,
                    _ => return wrong_kind(),
                }
                Ok(())
            }
        })+
    };
}

option_types! {
    f64: Real;
    Option<f64>: OptionalReal;
    Option<(f64, f64)>: OptionalRange;
    usize: Count;
    Option<usize>: OptionalCount;
    bool: Flag;
}

macro_rules! named_types {
    ($($type:ty),+) => {
        $(impl OptionType for $type {
            fn shown(&self) -> OptionValue {
                OptionValue::Name(self.name().to_owned())
            }

            fn read(&mut self, value: OptionValue) -> Result<()> {
                match value {
                    OptionValue::Name(name) => *self = name.parse()?,
                    _ => return wrong_kind(),
                }
                Ok(())
            }
        })+
    };
}

named_types!(Autoreset, ActionMode);

impl OptionType for TargetChoice {
    fn shown(&self) -> OptionValue {
        match self {
            Self::Each(targets) => {
                let names = targets.iter().map(|target| target.name().to_owned());
                OptionValue::Names(names.collect())
            }
            named => OptionValue::Name(named.name().unwrap_or_default().to_owned()),
        }
    }

    fn read(&mut self, value: OptionValue) -> Result<()> {
        *self = match value {
            OptionValue::Name(name) => Self::named(&name)?,
            OptionValue::Names(names) => Self::each(&names)?,
            _ => return wrong_kind(),
        };
        Ok(())
    }
}

impl OptionType for ObservationLayout {
    fn shown(&self) -> OptionValue {
        let blocks = Block::ALL.iter();
        OptionValue::Blocks(blocks.map(|&block| (block, self.repeats(block))).collect())
    }

    fn read(&mut self, value: OptionValue) -> Result<()> {
        match value {
            OptionValue::Blocks(blocks) => {
                for (block, repeats) in blocks {
                    self.repeat(block, repeats);
                }
            }
            _ => return wrong_kind(),
        }
        Ok(())
    }
}

impl OptionType for RewardWeights {
    fn shown(&self) -> OptionValue {
        let weights = RewardTerm::ALL.iter().copied().zip(self.0);
        OptionValue::Weights(weights.filter(|(_, weight)| *weight != 0.0).collect())
    }

    fn read(&mut self, value: OptionValue) -> Result<()> {
        match value {
            OptionValue::Weights(weights) => {
                self.0 = [0.0; TERMS];
                for (term, weight) in weights {
                    self.0[term as usize] = weight;
                }
            }
            _ => return wrong_kind(),
        }
        Ok(())
    }
}

fn wrong_kind() -> Result<()> {
    Err(FlockError::parameter(
        "option",
        "a value",
        "one of its own kind",
    ))
}

macro_rules! declare_options {
    ($($(#[doc = $doc:literal])+ $name:ident: $($path:ident).+;)+) => {
        /// Every option of environments, in the order of documentation.
        pub const OPTIONS: &[EnvOption] = &[$(EnvOption {
            name: stringify!($name),
            doc: concat!($($doc),+),
            get: |settings| settings.$($path).+.shown(),
            set: |settings, value| settings.$($path).+.read(value),
        },)+];
    };
}

declare_options! {
    /// "cw", "ccw", "random" (drawn for each episode) or "alternate" (ccw, cw, ccw, cw, a quarter of the episode each); or a list of "cw" and "ccw", one per leader
    target: episode.target;
    /// length of an episode in s, rounded to whole control steps; None: 480, and 960 where targets alternate
    episode_s: episode.episode_s;
    /// control steps per second
    control_hz: episode.control_hz;
    /// what an action in [-1, 1] stands for: "rudder"; "heading", the angle outward of the target's tangent over pi, to which the damped law steers; or "lean", that angle over 1.2 rad, to which the pool's tuned law steers, so that 0 is that law
    action_mode: action.mode;
    /// time in s from one decision to the next, a whole number of control steps, through which a step holds its action; None: one control step
    decision_period_s: action.decision_period_s;
    /// range (low, high) that bw_s is drawn from, uniformly, for each episode; None: the parameters' own bw_s
    bw_range_s: episode.bw_range_s;
    /// blocks that differ from the default layout, such as `{'order': False, 'neighbors': 4}`
    observation: observation;
    /// reflect observation, state and action where the target is ccw, so that both directions are one task
    mirror_to_target: observation.mirror_to_target;
    /// chance that the camera loses a boat in a frame and shows where it was before
    dropout_rate: camera.dropout_rate;
    /// frames that the leaders' picture is late, 0 or 1
    delay_frames: camera.delay_frames;
    /// weights of the reward's terms; terms that are not named weigh nothing
    reward: reward;
    /// time T in s: a control step's reward counts for its length over T, so that sums over T are means, of order one; None: each counts in full
    reward_horizon_s: reward_horizon_s;
    /// number of levels of the discrete action, 2 to 1001; None: continuous
    rudder_levels: rudder.levels;
    /// time constant of the rudder servo in s
    rudder_lag_s: rudder.lag_s;
    /// fastest change of the rudder in 1/s; None: any
    rudder_rate_per_s: rudder.rate_per_s;
    /// what happens at an episode's end in the vector environment: "next_step", "same_step" or "disabled"
    autoreset_mode: autoreset;
}
