//! What is declared of a parameter: its kind, unit, range, source and meaning, and how its value looks outside.

use super::{Noise, Pool, Scheme, Solver, Target, Targets};
use crate::error::{FlockError, Result};
use std::fmt;

/// What is declared of a field of [`super::FlockParameters`].
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// What kind of value it has.
    pub kind: Kind,
    /// Its unit; empty for pure numbers and choices.
    pub unit: &'static str,
    /// Which values are accepted.
    pub range: Range,
    /// Where the default comes from: a table, section or equation of the paper, or "chosen".
    pub source: &'static str,
    /// What it is, with its sign, and where the paper has it.
    pub doc: &'static str,
}

/// Which kind of value a field has.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A whole number of at least 0.
    Count,
    /// A real number.
    Real,
    /// Yes or no.
    Flag,
    /// One of these names.
    Choice(fn() -> Vec<&'static str>),
    /// A pool's name, or its outer and inner radius.
    Pool,
    /// One of these names, or a list with one of them per leader.
    Choices(fn() -> Vec<&'static str>),
    /// Rows of real numbers with these names.
    Rows(&'static [&'static str]),
}

/// Which values of a field are accepted.
#[derive(Debug, Clone, Copy)]
pub enum Range {
    /// Whatever its type can hold.
    Any,
    /// Above 0, at most [`Range::LARGE`].
    Positive,
    /// At least 0, at most [`Range::LARGE`].
    NonNegative,
    /// From a number to another, and in words.
    Within(f64, f64, &'static str),
    /// What other fields allow, in words.
    Dependent(&'static str),
}

impl Range {
    /// Lengths, speeds and rates beyond this (1e6 cm = 10 km) are taken for a mistake.
    pub const LARGE: f64 = 1e6;

    fn bounds(self) -> Option<(f64, f64)> {
        match self {
            Self::Any | Self::Dependent(_) => None,
            Self::Positive => Some((f64::MIN_POSITIVE, Self::LARGE)),
            Self::NonNegative => Some((0.0, Self::LARGE)),
            Self::Within(low, high, _) => Some((low, high)),
        }
    }

    /// In words; empty where everything is accepted.
    pub fn accepted(self) -> &'static str {
        match self {
            Self::Any => "",
            Self::Positive => "a positive number, at most 1e6",
            Self::NonNegative => "a finite number of at least 0, at most 1e6",
            Self::Within(_, _, words) | Self::Dependent(words) => words,
        }
    }
}

impl Field {
    /// Checks a value against the declared range.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub(super) fn check(&self, value: Value) -> Result<()> {
        let number = match value {
            Value::Count(count) => count as f64,
            Value::Real(real) => real,
            _ => return Ok(()),
        };
        match self.range.bounds() {
            // A NaN lies in no range.
            Some((low, high)) if !(low..=high).contains(&number) => Err(FlockError::parameter(
                self.name,
                value,
                self.range.accepted(),
            )),
            _ => Ok(()),
        }
    }
}

/// A field's value as it is given and shown outside.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A whole number.
    Count(usize),
    /// A real number.
    Real(f64),
    /// Yes or no.
    Flag(bool),
    /// A name.
    Name(String),
    /// Outer and inner radius of a pool without a name, in cm.
    Radii(f64, f64),
    /// Names, one per leader.
    Names(Vec<String>),
    /// Rows of real numbers.
    Rows(Vec<Vec<f64>>),
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => count.fmt(formatter),
            Self::Real(real) => real.fmt(formatter),
            Self::Flag(flag) => flag.fmt(formatter),
            Self::Name(name) => name.fmt(formatter),
            Self::Radii(outer, inner) => write!(formatter, "({outer}, {inner})"),
            Self::Names(names) => write!(formatter, "[{}]", names.join(", ")),
            Self::Rows(rows) => write!(formatter, "{rows:?}"),
        }
    }
}

/// A type that fields have.
pub(super) trait FieldType: Sized {
    /// Its kind of value.
    const KIND: Kind;
    /// As it is shown outside.
    fn value(&self) -> Value;
    /// From a value of its kind.
    fn from_value(value: Value) -> Result<Self>;
}

pub(super) fn wrong_kind<T>(value: &Value) -> Result<T> {
    Err(FlockError::parameter(
        "value",
        value,
        "a value of the field's kind",
    ))
}

impl FieldType for usize {
    const KIND: Kind = Kind::Count;

    fn value(&self) -> Value {
        Value::Count(*self)
    }

    fn from_value(value: Value) -> Result<Self> {
        match value {
            Value::Count(count) => Ok(count),
            other => wrong_kind(&other),
        }
    }
}

impl FieldType for f64 {
    const KIND: Kind = Kind::Real;

    fn value(&self) -> Value {
        Value::Real(*self)
    }

    fn from_value(value: Value) -> Result<Self> {
        match value {
            Value::Real(real) => Ok(real),
            other => wrong_kind(&other),
        }
    }
}

impl FieldType for bool {
    const KIND: Kind = Kind::Flag;

    fn value(&self) -> Value {
        Value::Flag(*self)
    }

    fn from_value(value: Value) -> Result<Self> {
        match value {
            Value::Flag(flag) => Ok(flag),
            other => wrong_kind(&other),
        }
    }
}

impl FieldType for Pool {
    const KIND: Kind = Kind::Pool;

    fn value(&self) -> Value {
        self.name().map_or(
            Value::Radii(self.outer_radius_cm, self.inner_radius_cm),
            |name| Value::Name(name.to_owned()),
        )
    }

    fn from_value(value: Value) -> Result<Self> {
        match value {
            Value::Name(name) => Self::named(&name),
            Value::Radii(outer_radius_cm, inner_radius_cm) => Ok(Self {
                outer_radius_cm,
                inner_radius_cm,
            }),
            other => wrong_kind(&other),
        }
    }
}

macro_rules! choices {
    ($($type:ty),+) => {
        $(impl FieldType for $type {
            const KIND: Kind =
                Kind::Choice(|| Self::ALL.iter().map(|choice| choice.name()).collect());

            fn value(&self) -> Value {
                Value::Name(self.name().to_owned())
            }

            fn from_value(value: Value) -> Result<Self> {
                match value {
                    Value::Name(name) => name.parse(),
                    other => wrong_kind(&other),
                }
            }
        })+
    };
}

choices!(Scheme, Noise, Solver);

impl From<&Targets> for Value {
    fn from(targets: &Targets) -> Self {
        match targets {
            Targets::One(target) => Self::Name(target.name().to_owned()),
            Targets::Each(targets) => {
                let names = targets.iter().map(|target| target.name().to_owned());
                Self::Names(names.collect())
            }
        }
    }
}

impl FieldType for Targets {
    const KIND: Kind = Kind::Choices(|| Target::ALL.iter().map(|target| target.name()).collect());

    fn value(&self) -> Value {
        self.into()
    }

    fn from_value(value: Value) -> Result<Self> {
        match value {
            Value::Name(name) => Ok(Self::One(name.parse()?)),
            Value::Names(names) => {
                let targets = names.iter().map(|name| name.parse());
                Ok(Self::Each(targets.collect::<Result<_>>()?))
            }
            other => wrong_kind(&other),
        }
    }
}
