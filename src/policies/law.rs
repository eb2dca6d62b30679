//! The laws that leaders can follow.

use super::LeaningLaw;
use crate::boat::{Course, DampedLaw, steering_law};
use crate::error::{FlockError, Result};
use crate::parameters::{Value, named_choice};

named_choice! {
    /// What leaders follow, by the name that commands, recordings, pictures and pages have for it.
    pub enum LawName ("law") {
        /// The paper's law, eq. (10), at every substep, from the flock itself.
        EverySubstep = "paper's law at every substep",
        /// The paper's law at every decision, from what a leader observes, as all that follow.
        Paper = "paper's law",
        /// The damped law with its default gains.
        Damped = "damped law",
        /// The damped law with the gains tuned in the pool.
        Tuned = "tuned law",
        /// The pretrained leaders of the pool.
        Learned = "learned",
    }
}

impl LawName {
    /// The color that it has in every picture: one of Okabe and Ito's, which every kind of eye distinguishes; `None`: the
    /// next that is free.
    pub fn color(self) -> Option<&'static str> {
        match self {
            Self::Paper => Some("#0072b2"),
            Self::Tuned => Some("#e69f00"),
            Self::Learned => Some("#009e73"),
            Self::EverySubstep | Self::Damped => None,
        }
    }

    /// Whether it is another law in each pool.
    pub fn is_of_pool(self) -> bool {
        match self {
            Self::Tuned | Self::Learned => true,
            Self::EverySubstep | Self::Paper | Self::Damped => false,
        }
    }

    /// What is declared of it by name.
    pub fn named(self) -> Value {
        let (name, doc) = (self.name(), self.doc());
        let (color, is_of_pool) = (self.color(), self.is_of_pool());
        let each = [
            ("name", Value::from(name)),
            ("doc", doc.into()),
            ("color", color.into()),
            ("is_of_pool", is_of_pool.into()),
        ];
        each.into_iter().collect()
    }
}

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
    /// The law of a name. Two of them are others in each pool, which is given by its name, if it has one.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for other names, for the law at every substep, which a flock follows by itself, and for
    /// pools in which a law has not been tuned or learned.
    pub fn named(name: &str, pool: Option<&str>) -> Result<Self> {
        match name.parse()? {
            LawName::EverySubstep => {
                let accepted = "a law that reads observations";
                Err(FlockError::parameter("law", name, accepted))
            }
            LawName::Paper => Ok(Self::Paper),
            LawName::Damped => Ok(Self::Damped(DampedLaw::default())),
            LawName::Tuned => DampedLaw::tuned("law", name, pool).map(Self::Damped),
            LawName::Learned => LeaningLaw::learned(pool).map(|law| Self::Leaning(Box::new(law))),
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
