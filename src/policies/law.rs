//! The laws that leaders can follow.

use super::LeaningLaw;
use crate::boat::{Course, DampedLaw, steering_law};
use crate::draw::palette::{DAMPED_LAW, LEARNED, PAPER_LAW, Rgb, TUNED_LAW};
use crate::error::{FlockError, Result};
use crate::parameters::Value;

/// A law that leaders steer by. A new law needs a variant here, a row in [`Law::NAMED`], and its rudder in `Law::rudder`.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// The paper's law, eq. (10), at every substep, from the flock itself.
    EverySubstep,
    /// The paper's law at every decision, from the leader's observation. All laws below also use observations.
    Paper,
    /// The damped law with these gains; the tuned law is the one with the gains tuned in the pool.
    Damped(DampedLaw),
    /// The damped law about a heading that leans outward of the target's tangent, from the leader's observation.
    Leaning(Box<LeaningLaw>),
}

/// A law that commands, recordings, pictures and pages use by its name.
#[derive(Debug, Clone, Copy)]
pub struct NamedLaw {
    /// The name.
    pub name: &'static str,
    /// Description for the documentation.
    pub doc: &'static str,
    /// The law's color in every picture; `None`: the next free color.
    pub color: Option<Rgb>,
    origin: Origin,
}

/// Origin of a named law.
#[derive(Debug, Clone, Copy)]
enum Origin {
    /// The same law in every pool.
    Everywhere(fn() -> Law),
    /// Each named pool has its own law.
    OfPool(fn(Option<&str>) -> Result<Law>),
}

impl NamedLaw {
    /// Whether the law differs between pools.
    pub fn is_of_pool(&self) -> bool {
        matches!(self.origin, Origin::OfPool(_))
    }

    /// The law for a flock in the pool with this name; `None`: a pool without a name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for pools in which the law has not been tuned or learned.
    pub fn law(&self, pool: Option<&str>) -> Result<Law> {
        match self.origin {
            Origin::Everywhere(law) => Ok(law()),
            Origin::OfPool(law) => law(pool),
        }
    }

    /// The public fields, and whether the law differs between pools, by name.
    pub fn declaration(&self) -> Value {
        let declared = [
            ("name", Value::from(self.name)),
            ("doc", self.doc.into()),
            ("color", self.color.map(|color| color.to_string()).into()),
            ("is_of_pool", self.is_of_pool().into()),
        ];
        declared.into_iter().collect()
    }
}

impl Law {
    /// The name of the law at every substep.
    pub const EVERY_SUBSTEP: &'static str = "paper's law at every substep";

    /// The laws that have a name, in the order of documentation.
    pub const NAMED: &'static [NamedLaw] = &[
        NamedLaw {
            name: Self::EVERY_SUBSTEP,
            doc: "The paper's law, eq. (10), at every substep, from the flock itself.",
            color: Some(PAPER_LAW),
            origin: Origin::Everywhere(|| Self::EverySubstep),
        },
        NamedLaw {
            name: "paper's law",
            doc: "The paper's law, eq. (10), at every decision, from the leader's observation.",
            color: Some(PAPER_LAW),
            origin: Origin::Everywhere(|| Self::Paper),
        },
        NamedLaw {
            name: "damped law",
            doc: "The damped law with its default gains.",
            color: Some(DAMPED_LAW),
            origin: Origin::Everywhere(|| Self::Damped(DampedLaw::default())),
        },
        NamedLaw {
            name: "tuned law",
            doc: "The damped law with the gains tuned in the pool.",
            color: Some(TUNED_LAW),
            origin: Origin::OfPool(|pool| {
                DampedLaw::tuned("law", "tuned law", pool).map(Self::Damped)
            }),
        },
        NamedLaw {
            name: "learned",
            doc: "The pretrained leaders of the pool.",
            color: Some(LEARNED),
            origin: Origin::OfPool(|pool| {
                LeaningLaw::learned(pool).map(|law| Self::Leaning(Box::new(law)))
            }),
        },
    ];

    /// The law with this name, for a flock in the pool `pool`; `None`: a pool without a name.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for other names, and as for [`NamedLaw::law`].
    pub fn named(name: &str, pool: Option<&str>) -> Result<Self> {
        let law = Self::NAMED.iter().find(|law| law.name == name);
        let names = || {
            let names = Self::NAMED.iter().map(|law| format!("{:?}", law.name));
            format!("one of {}", names.collect::<Vec<_>>().join(", "))
        };
        let unknown = || FlockError::parameter("law", format!("{name:?}"), names());
        law.ok_or_else(unknown)?.law(pool)
    }

    /// Refuses the law at every substep, which cannot be followed from observations.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub(super) fn check_reads_observations(&self) -> Result<()> {
        let reads_observations = *self != Self::EverySubstep;
        let accepted = "a law that reads observations";
        FlockError::unless(reads_observations, "law", Self::EVERY_SUBSTEP, accepted)
    }

    /// Names and values of the gains of the damped law that steers; empty for other laws.
    pub fn gains(&self) -> Vec<(&'static str, f64)> {
        self.damped()
            .map_or_else(Vec::new, |law| law.gains().to_vec())
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

    /// Checks the law's numbers.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if a number is out of range.
    pub fn check(&self) -> Result<()> {
        self.damped().map_or(Ok(()), DampedLaw::check)?;
        self.leaning().map_or(Ok(()), LeaningLaw::check)
    }

    /// The damped law by which this law steers, if any.
    fn damped(&self) -> Option<&DampedLaw> {
        match self {
            Self::Damped(law) => Some(law),
            _ => self.leaning().and_then(|law| law.gains.as_ref()),
        }
    }

    /// This law as a leaning law; `None` for other laws. Only leaning laws read lean features.
    pub(super) fn leaning(&self) -> Option<&LeaningLaw> {
        match self {
            Self::Leaning(law) => Some(law),
            _ => None,
        }
    }

    /// The rudder in [−1, 1] for a course relative to the law's desired heading. It is rounded to 32 bits, as actions are.
    pub(super) fn rudder(&self, course: &Course) -> f64 {
        let rudder = match self {
            Self::EverySubstep | Self::Paper => steering_law(course.misalignment),
            Self::Damped(law) => law.rudder(course),
            // A leaning law without gains chooses rudders itself.
            Self::Leaning(law) => law.gains.map_or(0.0, |gains| gains.rudder(course)),
        };
        f64::from(rudder as f32)
    }
}
