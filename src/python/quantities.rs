//! The table of quantities.

use crate::analysis::quantities::{Formula, QUANTITIES};
use pyo3::prelude::*;

/// An entry of the table of quantities.
///
/// Attributes
/// ----------
/// name, label, symbol, unit : str
///     Its name in recordings and tables, what it is in a few words, symbol and unit (empty for none).
/// meaning, source : str
///     What it is, with its sign; and where it is defined.
/// range : tuple of float, or None
///     Least and greatest value, where there are such.
/// least_boats : int
///     Fewer boats leave it undefined (NaN).
/// is_averaged : bool
///     Whether its mean over a run is shown; the mean of an angle is not.
/// kind : str
///     "recorded": kept with every sample of a recording; "derived": follows from recorded ones and the
///     target direction; "structure": computed from poses on request.
#[pyclass(name = "Quantity", module = "flockenv._core", frozen, get_all)]
pub(crate) struct PyQuantity {
    name: &'static str,
    label: &'static str,
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
    source: &'static str,
    range: Option<(f64, f64)>,
    least_boats: usize,
    is_averaged: bool,
    kind: &'static str,
}

/// The table of quantities.
#[pyfunction]
pub(crate) fn quantities() -> Vec<PyQuantity> {
    let entries = QUANTITIES.iter();
    entries
        .map(|each| PyQuantity {
            name: each.name,
            label: each.label,
            symbol: each.symbol,
            unit: each.unit,
            meaning: each.meaning,
            source: each.source,
            range: each.range,
            least_boats: each.least_boats,
            is_averaged: each.is_averaged,
            kind: match each.formula {
                Formula::Recorded(_) => "recorded",
                Formula::Derived(_) => "derived",
                Formula::Structure(_) => "structure",
            },
        })
        .collect()
}
