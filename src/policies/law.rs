//! The laws that leaders can follow.

use super::LeaningLaw;
use crate::boat::{Course, DampedLaw, steering_law};
use crate::error::{FlockError, Result};

/// A law that leaders can follow, each by what it sees.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// The paper's law, eq. (10).
    Paper,
    /// The damped law with these gains; the tuned law is the one with the gains tuned in the pool.
    Damped(DampedLaw),
    /// The damped law about a heading that leans outward of the target's tangent, by what the leader sees.
    Leaning(Box<LeaningLaw>),
}

impl Law {
    /// The names of laws: those of [`Self::named`].
    pub const NAMES: [&'static str; 4] = ["paper's law", "damped law", "tuned law", "learned"];

    /// The law of a name. Two of them are others in each pool, which is given by its name, if it has one.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for other names, and pools in which a law has not been tuned or learned.
    pub fn named(name: &str, pool: Option<&str>) -> Result<Self> {
        match name {
            "paper's law" => Ok(Self::Paper),
            "damped law" => Ok(Self::Damped(DampedLaw::default())),
            "tuned law" => DampedLaw::tuned("law", name, pool).map(Self::Damped),
            "learned" => LeaningLaw::learned(pool).map(|law| Self::Leaning(Box::new(law))),
            _ => {
                let accepted = format!("one of {}", Self::NAMES.join(", "));
                Err(FlockError::parameter("law", name, accepted))
            }
        }
    }

    /// Names and values of its gains.
    pub fn gains(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Paper => Vec::new(),
            Self::Damped(law) => law.gains().to_vec(),
            Self::Leaning(law) => law.gains.gains().to_vec(),
        }
    }

    /// A leaning law as a JSON text.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for other laws, and as for [`LeaningLaw::to_json`].
    pub fn to_json(&self) -> Result<String> {
        let accepted = "a leaning law: only those are stored";
        let refuse = || FlockError::parameter("law", "without weights", accepted);
        self.leaning().ok_or_else(refuse)?.to_json()
    }

    /// Checks its numbers.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Paper => Ok(()),
            Self::Damped(law) => law.check(),
            Self::Leaning(law) => law.check(),
        }
    }

    /// The leaning law, which looks at lean features, if it is one.
    pub(super) fn leaning(&self) -> Option<&LeaningLaw> {
        match self {
            Self::Leaning(law) => Some(law),
            Self::Paper | Self::Damped(_) => None,
        }
    }

    /// The rudder on a course, which is about a heading that leans where the law does: in [−1, 1], with the precision of
    /// actions.
    pub(super) fn rudder(&self, course: &Course) -> f64 {
        let rudder = match self {
            Self::Paper => steering_law(course.misalignment),
            Self::Damped(law) => law.rudder(course),
            Self::Leaning(law) => law.gains.rudder(course),
        };
        f64::from(rudder as f32)
    }
}
