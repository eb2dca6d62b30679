//! States by name: a missing field or number takes its default, and an error names an unknown one. So a build that has
//! more parameters, options, reward terms, blocks or quantities can still read the states of an older build.

use crate::sealed_bytes::refused;
use serde::de::{DeserializeOwned, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

/// A struct stored as its fields by name.
pub(crate) trait ByName: Default {
    /// The struct's name in error messages.
    const NAME: &'static str;

    /// Sets the field `name` to the next of the `values`; returns false if the struct has no field of that name.
    fn read_field<'de, A: MapAccess<'de>>(
        &mut self,
        name: &str,
        values: &mut A,
    ) -> Result<bool, A::Error>;
}

/// Visits a map of fields and makes a struct of them.
struct FieldsVisitor<T>(PhantomData<T>);

impl<'de, T: ByName> Visitor<'de> for FieldsVisitor<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "the fields of {}", T::NAME)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut values: A) -> Result<T, A::Error> {
        let mut state = T::default();
        while let Some(name) = values.next_key::<String>()? {
            if !state.read_field(&name, &mut values)? {
                return Err(unknown_name(&name, T::NAME));
            }
        }
        Ok(state)
    }
}

/// Deserializes a struct from its fields by name.
pub(crate) fn fields<'de, T: ByName, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_map(FieldsVisitor(PhantomData))
}

/// Serializes pairs of a name and a value as a map.
pub(crate) fn write<S: Serializer, T: Serialize>(
    values: impl IntoIterator<Item = (&'static str, T)>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(values)
}

/// Reads values that [`write`] wrote, and passes each with its name to `set`.
///
/// `set` returns false for a name that it does not know, which is an error. `table` names the values in its message.
pub(crate) fn read<'de, D: Deserializer<'de>, T: DeserializeOwned>(
    deserializer: D,
    table: &str,
    mut set: impl FnMut(&str, T) -> bool,
) -> Result<(), D::Error> {
    struct ValuesVisitor<T>(PhantomData<T>);
    impl<'de, T: DeserializeOwned> Visitor<'de> for ValuesVisitor<T> {
        type Value = Vec<(String, T)>;

        fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
            formatter.write_str("values by name")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut values: A) -> Result<Self::Value, A::Error> {
            let mut entries = Vec::new();
            while let Some(entry) = values.next_entry()? {
                entries.push(entry);
            }
            Ok(entries)
        }
    }
    let entries: Vec<(String, T)> = deserializer.deserialize_map(ValuesVisitor(PhantomData))?;
    for (name, value) in entries {
        if !set(&name, value) {
            return Err(unknown_name(&name, table));
        }
    }
    Ok(())
}

/// The error for a stored name that this build does not know; `table` says what kind of name.
fn unknown_name<E: serde::de::Error>(name: &str, table: &str) -> E {
    refused(format!(
        "this version of flockenv does not know {name:?} among {table}"
    ))
}
