//! Choices that users make by name.

/// Declares an enum whose variants have public names; the parser's error lists the names. A row that ends with
/// `if "feature"` exists only with this feature of the crate.
macro_rules! named_choice {
    ($(#[$meta:meta])* $visibility:vis enum $type:ident ($field:literal) {
        $($(#[doc = $doc:literal])+ $variant:ident = $name:literal $(if $feature:literal)?,)+
    }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $visibility enum $type { $($(#[cfg(feature = $feature)])? $(#[doc = $doc])+ $variant,)+ }

        impl $type {
            /// Every choice, in the order of documentation.
            pub const ALL: &'static [Self] = &[$($(#[cfg(feature = $feature)])? Self::$variant,)+];

            /// The public names of all choices.
            pub fn names() -> Vec<&'static str> {
                Self::ALL.iter().map(|choice| choice.name()).collect()
            }

            /// The meaning of the choice, for documentation.
            pub fn doc(self) -> &'static str {
                match self { $($(#[cfg(feature = $feature)])? Self::$variant => concat!($($doc),+),)+ }.trim_ascii_start()
            }

            /// The public name of the choice.
            pub const fn name(self) -> &'static str {
                match self { $($(#[cfg(feature = $feature)])? Self::$variant => $name,)+ }
            }
        }

        impl $crate::parameters::Setting for $type {
            const KIND: $crate::parameters::Kind = $crate::parameters::Kind::Choice(Self::names);

            fn value(&self) -> $crate::parameters::Value {
                Self::name(*self).into()
            }

            fn from_value(name: &'static str, value: &$crate::parameters::Value) -> $crate::error::Result<Self> {
                $crate::parameters::text_of(name, value)?.parse()
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
                serializer.serialize_str(Self::name(*self))
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
                let name = <String as serde::Deserialize>::deserialize(deserializer)?;
                name.parse().map_err(|error: $crate::error::FlockError| {
                    $crate::sealed_bytes::refused(error.to_string())
                })
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::error::FlockError;

            fn from_str(text: &str) -> $crate::error::Result<Self> {
                Self::ALL.iter().copied().find(|choice| choice.name() == text).ok_or_else(|| {
                    let names: Vec<_> = Self::names().iter().map(|name| format!("{name:?}")).collect();
                    let accepted = format!("one of {}", names.join(", "));
                    $crate::error::FlockError::parameter($field, format!("{text:?}"), accepted)
                })
            }
        }
    };
}

pub(crate) use named_choice;
