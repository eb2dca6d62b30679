//! Parameters in stored states: by name, so that a state from before a field was added has its default.

use super::{Field, FlockParameters, Kind, Value};
use crate::error::{FlockError, Result};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

impl FlockParameters {
    /// How many fields version 0.1.0 had: the first ones. Fields that were added since come after them.
    pub const FIRST_FIELDS: usize = 29;

    fn from_named(stored: &[(String, Value)]) -> Result<Self> {
        let is_known = |name: &str| Self::FIELDS.iter().any(|field| field.name == name);
        if let Some((name, _)) = stored.iter().find(|(name, _)| !is_known(name)) {
            let accepted = "fields that this version has";
            return Err(FlockError::parameter("parameters", name, accepted));
        }
        let mut defaults = Self::simulation().values().into_iter();
        Self::from_values(|field| {
            let default = defaults.next().unwrap_or(Value::Flag(false));
            let found = stored.iter().find(|(name, _)| name == field.name);
            Ok(found.map_or(default, |(_, value)| value.clone()))
        })
    }
}

impl Serialize for FlockParameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        // Fields that were added since version 0.1.0 are stored where they differ from their defaults: states
        // without them are the same bytes in every version.
        let defaults = Self::simulation().values();
        let each = Self::FIELDS.iter().zip(self.values()).zip(&defaults);
        let stored = each.enumerate().filter(|(place, ((_, value), default))| {
            *place < Self::FIRST_FIELDS || value != *default
        });
        let named: Vec<_> = stored
            .map(|(_, ((field, value), _))| (field.name, value))
            .collect();
        named.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FlockParameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let named = Vec::deserialize(deserializer)?;
        Self::from_named(&named).map_err(D::Error::custom)
    }
}

/// Parameters as version 0.1.0 stored them: the values of its fields one after another.
#[derive(Debug)]
pub struct FirstParameters(FlockParameters);

impl From<FirstParameters> for FlockParameters {
    fn from(first: FirstParameters) -> Self {
        first.0
    }
}

impl<'de> Deserialize<'de> for FirstParameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_tuple(FlockParameters::FIRST_FIELDS, FirstFields)
    }
}

struct FirstFields;

impl<'de> Visitor<'de> for FirstFields {
    type Value = FirstParameters;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("the parameters of version 0.1.0")
    }

    fn visit_seq<A: SeqAccess<'de>>(
        self,
        mut values: A,
    ) -> std::result::Result<FirstParameters, A::Error> {
        let mut named = Vec::with_capacity(FlockParameters::FIRST_FIELDS);
        for field in &FlockParameters::FIELDS[..FlockParameters::FIRST_FIELDS] {
            let value = first_value(field, &mut values)?;
            let value = value.ok_or_else(|| A::Error::custom("parameters are missing"))?;
            named.push((field.name.to_owned(), value));
        }
        let parameters = FlockParameters::from_named(&named).map_err(A::Error::custom)?;
        Ok(FirstParameters(parameters))
    }
}

fn first_value<'de, A: SeqAccess<'de>>(
    field: &Field,
    values: &mut A,
) -> std::result::Result<Option<Value>, A::Error> {
    Ok(match field.kind {
        Kind::Count => values.next_element()?.map(Value::Count),
        Kind::Real => values.next_element()?.map(Value::Real),
        Kind::Flag => values.next_element()?.map(Value::Flag),
        Kind::Choice(names) | Kind::Choices(names) => values.next_element::<u32>()?.map(|place| {
            let name = names().get(place as usize).copied().unwrap_or_default();
            Value::Name(name.to_owned())
        }),
        Kind::Pool => values
            .next_element()?
            .map(|(outer, inner)| Value::Radii(outer, inner)),
        Kind::Rows(_) => values.next_element()?.map(Value::Rows),
    })
}
