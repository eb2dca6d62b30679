//! Settings of an episode that are either fixed or drawn from the flock's seed.

use crate::error::{FlockError, Result};
use crate::parameters::{Kind, Range, Setting, Target, Targets, Value, wrong_kind};

/// A number that is fixed, or drawn for each episode.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Drawn {
    /// The same in every episode.
    Fixed(f64),
    /// Drawn uniformly from a range, from low to high.
    Uniform(f64, f64),
}

impl Drawn {
    /// The number for an episode. `fraction` in [0, 1) selects a point of the range.
    pub fn at(self, fraction: f64) -> f64 {
        match self {
            Self::Fixed(number) => number,
            Self::Uniform(low, high) => low + fraction * (high - low),
        }
    }

    /// Checks the ends of a range. A fixed number is checked elsewhere, as a parameter of the flock.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for the field `name`.
    pub(super) fn check(self, name: &'static str) -> Result<()> {
        match self {
            Self::Uniform(low, high) => {
                let is_range = 0.0 <= low && low <= high && high <= Range::LARGE;
                let accepted = "a range (low, high) with 0 <= low <= high <= 1e6";
                FlockError::unless(is_range, name, self.value(), accepted)
            }
            Self::Fixed(_) => Ok(()),
        }
    }
}

impl Setting for Drawn {
    const KIND: Kind = Kind::Real;

    fn value(&self) -> Value {
        match *self {
            Self::Fixed(number) => Value::Real(number),
            Self::Uniform(low, high) => Value::reals([low, high]),
        }
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match (value.number(), value.pair()) {
            (Some(number), _) => Ok(Self::Fixed(number)),
            (_, Some((low, high))) => Ok(Self::Uniform(low, high)),
            _ => wrong_kind(name, "a number or a range (low, high)"),
        }
    }
}

/// Choice of an episode's target directions.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum TargetChoice {
    /// The same targets during the whole episode.
    Fixed(Targets),
    /// One of the two directions, drawn for the episode.
    Random,
    /// Counter-clockwise, clockwise, counter-clockwise, clockwise, a quarter of the episode each
    /// (figure 7).
    Alternate,
}

impl TargetChoice {
    /// Checks that a list has one target per leader.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self, n_leaders: usize) -> Result<()> {
        match self {
            Self::Fixed(targets) => targets.check(n_leaders),
            Self::Random | Self::Alternate => Ok(()),
        }
    }
}

impl Default for TargetChoice {
    fn default() -> Self {
        Self::Fixed(Targets::One(Target::Clockwise))
    }
}

impl Setting for TargetChoice {
    const KIND: Kind = Kind::Choices(|| ["cw", "ccw", "random", "alternate"].to_vec());

    fn value(&self) -> Value {
        match self {
            Self::Fixed(targets) => targets.value(),
            Self::Random => "random".into(),
            Self::Alternate => "alternate".into(),
        }
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match value {
            Value::Name(text) if text == "random" => return Ok(Self::Random),
            Value::Name(text) if text == "alternate" => return Ok(Self::Alternate),
            _ => {}
        }
        match Targets::from_value(name, value) {
            Ok(targets) => Ok(Self::Fixed(targets)),
            Err(FlockError::Parameter { .. }) => {
                Err(FlockError::parameter(name, value, accepted_targets(value)))
            }
            Err(other) => Err(other),
        }
    }
}

/// The accepted targets, for the message that refuses a value.
fn accepted_targets(value: &Value) -> &'static str {
    match value {
        Value::List(_) => {
            "a list of \"cw\" and \"ccw\", one per leader; \"random\" and \"alternate\" hold for all \
             leaders and stand alone"
        }
        _ => {
            "one of \"cw\", \"ccw\", \"random\", \"alternate\", or a list of \"cw\" and \"ccw\", one per \
             leader"
        }
    }
}
