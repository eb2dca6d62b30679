//! Observations outside environments: the tables of entries, and the observations of a flock.

use super::arrays::rows_of;
use super::flock::{PyFlock, rudders_from};
use super::value::argument;
use crate::environment::observation::{BOAT, ObservationLayout, observe_flock, state_entries};
use crate::error::FlockError;
use crate::flock::Flock;
use crate::parameters::{FlockParameters, Value};
use numpy::PyArray2;
use pyo3::prelude::*;

/// A checked layout from the blocks that differ from the default layout. With `mirror_to_target`, observations of leaders
/// with a counter-clockwise target are mirrored.
pub(super) fn layout_from(
    blocks: &Bound<'_, PyAny>,
    mirror_to_target: bool,
) -> PyResult<ObservationLayout> {
    let layout: ObservationLayout = argument(blocks, "observation")?;
    layout.check()?;
    Ok(layout.mirrored(mirror_to_target))
}

/// The entries of an observation with these blocks, in order.
#[pyfunction]
pub(super) fn observation_table(blocks: &Bound<'_, PyAny>) -> PyResult<Vec<Value>> {
    let mirror_to_target = false;
    let entries = layout_from(blocks, mirror_to_target)?.entries();
    let entries = entries.into_iter();
    let rows = entries.map(|(block, index, entry)| entry.named(block.name(), index));
    Ok(rows.collect())
}

/// The entries of the global state of a flock with `n_boats` boats, in order.
#[pyfunction]
pub(super) fn state_table(n_boats: &Bound<'_, PyAny>) -> PyResult<Vec<Value>> {
    let n_boats = argument(n_boats, "n_boats")?;
    let most = FlockParameters::MOST_BOATS;
    FlockError::unless(n_boats <= most, "n_boats", n_boats, format!("0 to {most}"))?;
    // The entries of all boats come first, then those of the clock.
    let entries = state_entries(n_boats).into_iter().enumerate();
    let rows = entries.map(|(index, entry)| match index / BOAT.len() {
        boat if boat < n_boats => entry.named("boat", boat),
        _ => entry.named("clock", 0),
    });
    Ok(rows.collect())
}

/// Observations of a flock's leaders, (k, size) float32, given their present rudders.
#[pyfunction]
#[pyo3(signature = (flock, blocks, mirror_to_target=false, rudder=None))]
pub(super) fn observe<'py>(
    py: Python<'py>,
    flock: &PyFlock,
    blocks: &Bound<'py, PyAny>,
    mirror_to_target: bool,
    rudder: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let flock = flock.0.read()?;
    let rudders = rudders_from(rudder, &flock)?.unwrap_or_default();
    let layout = layout_from(blocks, mirror_to_target)?;
    observation_rows(py, &flock, layout, &rudders)
}

/// Observations of a flock's leaders, (k, size) float32, given their present rudders.
pub(super) fn observation_rows<'py>(
    py: Python<'py>,
    flock: &Flock,
    layout: ObservationLayout,
    rudders: &[f64],
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    rows_of(py, observe_flock(flock, layout, rudders)?, layout.size())
}
