//! Averages of the table's quantities over an episode.

use crate::analysis::quantities::{Boats, SUMMARIZED, summarized, summarized_values};
use crate::parameters::Target;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Sums of the summarized quantities, or their means. Stored by name: what a state of an earlier version does
/// not hold is NaN in that episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averages([f64; SUMMARIZED]);

impl Default for Averages {
    fn default() -> Self {
        Self([0.0; SUMMARIZED])
    }
}

impl Averages {
    /// Adds what the quantities of boats are now.
    pub(crate) fn add(&mut self, boats: &Boats, target: Target) {
        for (sum, value) in self.0.iter_mut().zip(summarized_values(boats, target)) {
            *sum += value;
        }
    }

    /// Sums over a count of steps as means.
    pub(crate) fn over(&self, steps: f64) -> Self {
        Self(self.0.map(|sum| sum / steps))
    }

    /// Names and values, in the order of the table.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        summarized().map(|each| each.name).zip(self.0)
    }

    fn of_named(stored: &[(String, f64)]) -> Self {
        let mut values = [f64::NAN; SUMMARIZED];
        for (value, quantity) in values.iter_mut().zip(summarized()) {
            if let Some((_, known)) = stored.iter().find(|(name, _)| name == quantity.name) {
                *value = *known;
            }
        }
        Self(values)
    }
}

impl Serialize for Averages {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let named: Vec<_> = self.named().collect();
        named.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Averages {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self::of_named(&Vec::deserialize(deserializer)?))
    }
}

/// What states of environments held in place of [`Averages`] up to format 2.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct FirstAverages {
    signed_order: f64,
    psi_o: f64,
}

impl From<FirstAverages> for Averages {
    fn from(first: FirstAverages) -> Self {
        let named = [("signed_order", first.signed_order), ("psi_o", first.psi_o)];
        Self::of_named(&named.map(|(name, value)| (name.to_owned(), value)))
    }
}
