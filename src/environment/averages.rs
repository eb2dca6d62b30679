//! Averages of the table's quantities over an episode.

use crate::analysis::quantities::{Boats, SUMMARIZED, summarized, summarized_values};
use crate::parameters::Target;
use serde::{Deserialize, Serialize};

/// Sums of the summarized quantities, or their means.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
}
