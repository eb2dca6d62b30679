//! States by name: a missing field or number takes its default, and an error names an unknown one. So a stored state
//! can still be read after parameters, options, reward terms, blocks and quantities are added.

use crate::sealed_bytes::refused;
use serde::de::{DeserializeOwned, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

/// A struct stored as its fields by name.
pub(crate) trait ByName: Default {
    /// Its name in messages.
    const NAME: &'static str;

    /// Reads the value of a field; returns whether there is a field of that name.
    fn read<'de, A: MapAccess<'de>>(
        &mut self,
        name: &str,
        values: &mut A,
    ) -> Result<bool, A::Error>;
}

struct Fields<T>(PhantomData<T>);

impl<'de, T: ByName> Visitor<'de> for Fields<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "the fields of {}", T::NAME)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut values: A) -> Result<T, A::Error> {
        let mut of = T::default();
        while let Some(name) = values.next_key::<String>()? {
            if !of.read(&name, &mut values)? {
                return Err(unknown(&name, T::NAME));
            }
        }
        Ok(of)
    }
}

/// Deserializes a struct from its fields by name.
pub(crate) fn fields<'de, T: ByName, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    from.deserialize_map(Fields(PhantomData))
}

/// Serializes pairs of a name and a value as a map.
pub(crate) fn write<S: Serializer, T: Serialize>(
    values: impl IntoIterator<Item = (&'static str, T)>,
    to: S,
) -> Result<S::Ok, S::Error> {
    to.collect_map(values)
}

/// Reads values that [`write`] wrote; `put` returns whether it knows the name.
pub(crate) fn read<'de, D: Deserializer<'de>, T: DeserializeOwned>(
    from: D,
    of: &str,
    mut put: impl FnMut(&str, T) -> bool,
) -> Result<(), D::Error> {
    struct Values<T>(PhantomData<T>);
    impl<'de, T: DeserializeOwned> Visitor<'de> for Values<T> {
        type Value = Vec<(String, T)>;

        fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
            formatter.write_str("values by name")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut values: A) -> Result<Self::Value, A::Error> {
            let mut found = Vec::new();
            while let Some(entry) = values.next_entry()? {
                found.push(entry);
            }
            Ok(found)
        }
    }
    let values: Vec<(String, T)> = from.deserialize_map(Values(PhantomData))?;
    let mut values = values.into_iter();
    match values.find_map(|(name, value)| (!put(&name, value)).then_some(name)) {
        Some(name) => Err(unknown(&name, of)),
        None => Ok(()),
    }
}

fn unknown<E: serde::de::Error>(name: &str, of: &str) -> E {
    refused(format!(
        "this version of flockenv does not know {name:?} among {of}"
    ))
}
