//! Values of parameters and options in the form that users write and read, and the types that convert to
//! them.

use crate::error::{FlockError, Result};
use std::fmt;

/// A value in the form that users write and read.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// No value.
    None,
    /// True or false.
    Flag(bool),
    /// A whole number.
    Count(usize),
    /// A real number.
    Real(f64),
    /// A name.
    Name(String),
    /// Several values.
    List(Vec<Self>),
    /// Values by name.
    Map(Vec<(String, Self)>),
    /// A value of a type that no field has.
    Other,
}

impl Value {
    /// A list of real numbers.
    pub(crate) fn reals(numbers: impl IntoIterator<Item = f64>) -> Self {
        Self::List(numbers.into_iter().map(Self::Real).collect())
    }

    /// The value as a number; `None` for other kinds.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Count(count) => Some(*count as f64),
            Self::Real(real) => Some(*real),
            _ => None,
        }
    }

    /// The value as two numbers; `None` unless it is a list of two numbers.
    pub(crate) fn pair(&self) -> Option<(f64, f64)> {
        match self {
            Self::List(values) => match &values[..] {
                [first, second] => Some((first.number()?, second.number()?)),
                _ => None,
            },
            _ => None,
        }
    }
}

/// Declares the types that convert to [`Value`].
macro_rules! value_from {
    ($($argument:ident: $type:ty => $value:expr;)+) => {
        $(impl From<$type> for Value {
            fn from($argument: $type) -> Self {
                $value
            }
        })+
    };
}

value_from! {
    flag: bool => Self::Flag(flag);
    count: usize => Self::Count(count);
    count: u32 => Self::Count(count as usize);
    count: u64 => Self::Count(count as usize);
    real: f64 => Self::Real(real);
    name: &str => Self::Name(name.to_owned());
    name: String => Self::Name(name);
    range: (f64, f64) => Self::reals([range.0, range.1]);
}

impl<T: Into<Self>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::None, T::into)
    }
}

impl<T: Into<Self>> FromIterator<(&'static str, T)> for Value {
    fn from_iter<I: IntoIterator<Item = (&'static str, T)>>(values: I) -> Self {
        let values = values.into_iter();
        Self::Map(
            values
                .map(|(name, value)| (name.to_owned(), value.into()))
                .collect(),
        )
    }
}

/// Some fields of a struct by their names: pairs that [`Value`] collects.
macro_rules! named_fields {
    ($struct:expr; $($name:ident)+) => {
        [$((stringify!($name), $crate::parameters::Value::from($struct.$name))),+]
    };
}

pub(crate) use named_fields;

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => formatter.write_str("none"),
            Self::Flag(flag) => flag.fmt(formatter),
            Self::Count(count) => count.fmt(formatter),
            Self::Real(real) => real.fmt(formatter),
            Self::Name(name) => write!(formatter, "{name:?}"),
            Self::List(values) => {
                let values: Vec<_> = values.iter().map(Self::to_string).collect();
                write!(formatter, "({})", values.join(", "))
            }
            Self::Map(values) => {
                let values = values
                    .iter()
                    .map(|(name, value)| format!("{name}: {value}"));
                write!(formatter, "{{{}}}", values.collect::<Vec<_>>().join(", "))
            }
            Self::Other => formatter.write_str("something else"),
        }
    }
}

/// Kind of a field's value.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A whole number of at least 0.
    Count,
    /// A real number.
    Real,
    /// True or false.
    Flag,
    /// One of these names.
    Choice(fn() -> Vec<&'static str>),
    /// A pool's name, or its outer and inner radius.
    Pool,
    /// One of these names, or a list with one of them per leader.
    Choices(fn() -> Vec<&'static str>),
    /// Rows of real numbers, with the names of the columns.
    Rows(&'static [&'static str]),
    /// A value for each of some of these names.
    Map(fn() -> Vec<&'static str>),
}

/// A type of fields.
pub(crate) trait Setting: Sized {
    /// Kind of the values.
    const KIND: Kind;

    /// The value as users see it.
    fn value(&self) -> Value;

    /// Converts the value of the field `name`, without checking it against the field's range.
    ///
    /// # Errors
    /// [`FlockError::Kind`] for a value of another kind, [`FlockError::Parameter`] for an unknown choice.
    fn from_value(name: &'static str, value: &Value) -> Result<Self>;
}

/// The error for a field's value of the wrong kind.
pub(crate) fn wrong_kind<T>(field: &'static str, accepted: impl Into<String>) -> Result<T> {
    let accepted = accepted.into();
    Err(FlockError::Kind { field, accepted })
}

/// A field's value as a name.
///
/// # Errors
/// [`FlockError::Kind`] for anything else.
pub(crate) fn text_of<'a>(name: &'static str, value: &'a Value) -> Result<&'a str> {
    match value {
        Value::Name(text) => Ok(text),
        _ => wrong_kind(name, "a string"),
    }
}

impl Setting for usize {
    const KIND: Kind = Kind::Count;

    fn value(&self) -> Value {
        Value::Count(*self)
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match value {
            Value::Count(count) => Ok(*count),
            // Arithmetic and tables may return the whole number 8 as 8.0. The cast is exact: the bound rounds to 2^64.
            Value::Real(real) if real.fract() == 0.0 && (0.0..Self::MAX as f64).contains(real) => {
                Ok(*real as Self)
            }
            Value::Real(real) => {
                let accepted = "a whole number of at least 0, below 2^64";
                Err(FlockError::parameter(name, real, accepted))
            }
            _ => wrong_kind(name, "an integer"),
        }
    }
}

impl Setting for f64 {
    const KIND: Kind = Kind::Real;

    fn value(&self) -> Value {
        Value::Real(*self)
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        let number = value.number();
        number.map_or_else(|| wrong_kind(name, "a number"), Ok)
    }
}

impl Setting for bool {
    const KIND: Kind = Kind::Flag;

    fn value(&self) -> Value {
        Value::Flag(*self)
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match value {
            Value::Flag(flag) => Ok(*flag),
            _ => wrong_kind(name, "True or False"),
        }
    }
}

impl<T: Setting> Setting for Option<T> {
    const KIND: Kind = T::KIND;

    fn value(&self) -> Value {
        self.as_ref().map_or(Value::None, T::value)
    }

    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        match value {
            Value::None => Ok(None),
            some => T::from_value(name, some).map(Some),
        }
    }
}
