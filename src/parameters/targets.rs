//! Targets of leaders: one direction for all, or one for each.

use super::Target;
use super::value::{Kind, Setting, Value, text_of, wrong_kind};
use crate::error::{FlockError, Result};

/// The most targets of a list that a message shows.
const MOST_SHOWN: usize = 16;

/// The targets of a flock's leaders.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Targets {
    /// One for all leaders.
    One(Target),
    /// One per leader.
    Each(Vec<Target>),
}

impl Targets {
    /// The target of a leader. For normal boats it is the reference direction.
    pub fn of(&self, leader: usize) -> Target {
        match self {
            Self::One(target) => *target,
            Self::Each(targets) => targets
                .get(leader)
                .copied()
                .unwrap_or_else(|| self.reference()),
        }
    }

    /// The reference direction of the whole flock: leader 0's target.
    pub fn reference(&self) -> Target {
        match self {
            Self::One(target) => *target,
            Self::Each(targets) => targets.first().copied().unwrap_or(Target::Clockwise),
        }
    }

    /// Mean sign of the targets of the first `leaders` leaders: +1 if all are clockwise, −1 if all are counter-clockwise.
    pub fn mean_sign(&self, leaders: usize) -> f64 {
        match self {
            Self::One(target) => target.sign(),
            Self::Each(_) => {
                let signs = (0..leaders).map(|leader| self.of(leader).sign());
                signs.sum::<f64>() / leaders.max(1) as f64
            }
        }
    }

    /// Whether two leaders have opposite targets.
    pub fn are_opposed(&self) -> bool {
        match self {
            Self::One(_) => false,
            Self::Each(targets) => targets.iter().any(|target| *target != targets[0]),
        }
    }

    /// Checks that a list has one target per leader.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self, n_leaders: usize) -> Result<()> {
        match self {
            Self::Each(targets) if targets.len() != n_leaders || n_leaders == 0 => {
                let accepted = match n_leaders {
                    0 => "\"cw\" or \"ccw\": a flock without leaders has no list of targets"
                        .to_owned(),
                    n => format!("as many targets as leaders: n_leaders = {n}"),
                };
                Err(FlockError::parameter("target", self, accepted))
            }
            _ => Ok(()),
        }
    }
}

impl From<Target> for Targets {
    fn from(target: Target) -> Self {
        Self::One(target)
    }
}

impl Setting for Targets {
    const KIND: Kind = Kind::Choices(Target::names);

    fn value(&self) -> Value {
        match self {
            Self::One(target) => target.value(),
            Self::Each(targets) => Value::List(targets.iter().map(Setting::value).collect()),
        }
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match value {
            Value::Name(text) => text.parse().map(Self::One),
            Value::List(names) => {
                let targets = names.iter().map(|target| text_of(name, target)?.parse());
                targets.collect::<Result<_>>().map(Self::Each)
            }
            _ => wrong_kind(name, "a string or a list of strings"),
        }
    }
}

impl std::fmt::Display for Targets {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::One(target) => formatter.write_str(target.name()),
            Self::Each(targets) => {
                let names: Vec<_> = targets.iter().map(|target| target.name()).collect();
                match names.get(..MOST_SHOWN) {
                    Some(first_names) if names.len() > MOST_SHOWN => {
                        write!(
                            formatter,
                            "[{}, … {} in all]",
                            first_names.join(", "),
                            names.len()
                        )
                    }
                    _ => write!(formatter, "[{}]", names.join(", ")),
                }
            }
        }
    }
}
