//! Declaration of a parameter or an option: its kind, unit, range, source and meaning.

use super::value::{Kind, Value};
use crate::error::{FlockError, Result};

/// Declaration of a field of `S`.
#[derive(Debug)]
pub struct Field<S: 'static> {
    /// The field's name.
    pub name: &'static str,
    /// Kind of the value.
    pub kind: Kind,
    /// Unit of the value; empty for pure numbers and choices.
    pub unit: &'static str,
    /// Accepted values.
    pub range: Range,
    /// Source of the default: a table, section or equation of the paper, or "chosen".
    pub source: &'static str,
    /// Meaning, with its sign and its place in the paper.
    pub doc: &'static str,
    /// Reads the value.
    pub get: fn(&S) -> Value,
    /// Sets the value, without checking it against the range.
    pub set: fn(&mut S, &Value) -> Result<()>,
}

/// Accepted values of a field.
#[derive(Debug, Clone, Copy)]
pub enum Range {
    /// Any value of the field's type.
    Any,
    /// Above 0, at most [`Range::LARGE`].
    Positive,
    /// At least 0, at most [`Range::LARGE`].
    NonNegative,
    /// Least and greatest number, and the range in words.
    Within(f64, f64, &'static str),
    /// A range that depends on other fields, in words.
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

    /// The range in words; empty if everything is accepted.
    pub fn accepted(self) -> &'static str {
        match self {
            Self::Any => "",
            Self::Positive => "a positive number, at most 1e6",
            Self::NonNegative => "a finite number of at least 0, at most 1e6",
            Self::Within(_, _, words) | Self::Dependent(words) => words,
        }
    }
}

impl<S> Field<S> {
    /// Checks the field's value against the declared range.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    pub(crate) fn check(&self, settings: &S) -> Result<()> {
        let value = (self.get)(settings);
        match (value.number(), self.range.bounds()) {
            // A NaN lies in no range.
            (Some(number), Some((low, high))) if !(low..=high).contains(&number) => {
                let accepted = self.range.accepted();
                Err(FlockError::parameter(self.name, value, accepted))
            }
            _ => Ok(()),
        }
    }

    /// Accepted values in words.
    pub fn accepted(&self) -> String {
        let quoted = |names: fn() -> Vec<&'static str>| {
            let names: Vec<_> = names().iter().map(|name| format!("{name:?}")).collect();
            names.join(", ")
        };
        match self.kind {
            Kind::Choice(names) => quoted(names),
            Kind::Choices(names) => format!("{}, or a list of them, one per leader", quoted(names)),
            _ => self.range.accepted().to_owned(),
        }
    }

    /// The declaration as values by name. Its kind is named by a Python type.
    #[cfg(feature = "python")]
    pub(crate) fn declaration(&self) -> Value
    where
        S: Default,
    {
        let kind = match self.kind {
            Kind::Count => "int".to_owned(),
            Kind::Real => "float".to_owned(),
            Kind::Flag => "bool".to_owned(),
            Kind::Map(_) => "dict".to_owned(),
            Kind::Choice(_) => "str".to_owned(),
            Kind::Pool => "str or (float, float)".to_owned(),
            Kind::Choices(_) => "str or (str, ...)".to_owned(),
            Kind::Rows(columns) => {
                format!("tuple of ({})", vec!["float"; columns.len()].join(", "))
            }
        };
        let computed = [
            ("kind", kind.into()),
            ("default", (self.get)(&S::default())),
            ("accepted", self.accepted().into()),
            ("doc", self.doc.trim().into()),
        ];
        let declared = super::named_fields!(self; name unit);
        declared.into_iter().chain(computed).collect()
    }

    /// The values of these fields by name, in the given order.
    #[cfg(feature = "python")]
    pub(crate) fn values(fields: &[Self], settings: &S) -> Value {
        let values = fields
            .iter()
            .map(|field| (field.name, (field.get)(settings)));
        values.collect()
    }
}

/// Declares a struct from rows. A row declares one field: meaning, name, type, default, unit, range, and the source of
/// the default. The table `FIELDS`, the bindings and the documentation follow from the rows.
macro_rules! declare_fields {
    ($(#[$meta:meta])* pub struct $struct:ident;
    $($(#[doc = $doc:literal])+ $name:ident: $type:ty = $default:expr, $unit:literal, $range:expr, $source:literal;)+) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $struct {
            $($(#[doc = $doc])+ pub $name: $type,)+
        }

        impl serde::Serialize for $struct {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
                use serde::ser::SerializeMap;
                let mut fields = serializer.serialize_map(Some(Self::FIELDS.len()))?;
                $(fields.serialize_entry(stringify!($name), &self.$name)?;)+
                fields.end()
            }
        }

        impl<'de> serde::Deserialize<'de> for $struct {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
                $crate::by_name::fields(deserializer)
            }
        }

        impl $crate::by_name::ByName for $struct {
            const NAME: &'static str = stringify!($struct);

            fn read_field<'de, A: serde::de::MapAccess<'de>>(
                &mut self,
                name: &str,
                values: &mut A,
            ) -> std::result::Result<bool, A::Error> {
                match name {
                    $(stringify!($name) => self.$name = values.next_value()?,)+
                    _ => return Ok(false),
                }
                Ok(true)
            }
        }

        impl $struct {
            /// Declaration of each field, in the order of documentation.
            pub const FIELDS: &'static [$crate::parameters::Field<Self>] = &[$($crate::parameters::Field {
                name: stringify!($name),
                kind: <$type as $crate::parameters::Setting>::KIND,
                unit: $unit,
                range: $range,
                source: $source,
                doc: concat!($($doc),+),
                get: |settings| $crate::parameters::Setting::value(&settings.$name),
                set: |settings, value| {
                    settings.$name = $crate::parameters::Setting::from_value(stringify!($name), value)?;
                    Ok(())
                },
            },)+];
        }

        impl Default for $struct {
            fn default() -> Self {
                Self { $($name: $default,)+ }
            }
        }
    };
}

pub(crate) use declare_fields;
