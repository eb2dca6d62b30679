//! Choices that users make by name.

/// Declares an enum whose variants have public names, with parsing that lists what there is. A choice may
/// need a feature of the crate.
macro_rules! named_choice {
    ($(#[$meta:meta])* $visibility:vis enum $type:ident ($field:literal) {
        $($(#[doc = $doc:literal])+ $variant:ident = $name:literal $(if $feature:literal)?,)+
    }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        $visibility enum $type { $($(#[cfg(feature = $feature)])? $(#[doc = $doc])+ $variant,)+ }

        impl $type {
            /// Every choice, in the order of documentation.
            pub const ALL: &'static [Self] = &[$($(#[cfg(feature = $feature)])? Self::$variant,)+];

            /// What it is, for documentation.
            pub fn doc(self) -> &'static str {
                match self { $($(#[cfg(feature = $feature)])? Self::$variant => concat!($($doc),+),)+ }.trim_ascii_start()
            }

            /// The public name.
            pub fn name(self) -> &'static str {
                match self { $($(#[cfg(feature = $feature)])? Self::$variant => $name,)+ }
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::error::FlockError;

            fn from_str(text: &str) -> $crate::error::Result<Self> {
                Self::ALL.iter().copied().find(|choice| choice.name() == text).ok_or_else(|| {
                    let names: Vec<_> = Self::ALL.iter().map(|c| format!("{:?}", c.name())).collect();
                    $crate::error::FlockError::parameter(
                        $field,
                        format!("{text:?}"),
                        format!("one of {}", names.join(", ")),
                    )
                })
            }
        }
    };
}

pub(crate) use named_choice;
