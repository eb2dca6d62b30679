//! Observations outside environments: the table, a flock observed, laws evaluated.

use super::arguments::{count, floats};
use super::flock::PyFlock;
use super::value::layout_from;
use crate::environment::RudderSettings;
use crate::environment::observation::{
    BOAT, Entry, OBSERVATION_VERSION, ObservationLayout, flock_feature_entries, observe_flock,
    state_entries,
};
use crate::error::FlockError;
use crate::flock::Flock;
use crate::parameters::FlockParameters;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

/// Version of an observation with these blocks, the newest where none are given.
#[pyfunction]
#[pyo3(signature = (blocks=None))]
pub(crate) fn observation_version(blocks: Option<&Bound<'_, PyAny>>) -> PyResult<u32> {
    blocks.map_or(Ok(OBSERVATION_VERSION), |blocks| {
        Ok(layout_from(blocks, false)?.version())
    })
}

/// A row of a table: the fields of `flockenv.envs.observation.Entry`.
#[derive(IntoPyObject)]
pub(crate) struct Row {
    block: &'static str,
    place: usize,
    name: &'static str,
    unit: &'static str,
    scale: &'static str,
    low: f64,
    high: f64,
    mirrored: bool,
    meaning: &'static str,
}

fn row((block, place, entry): (&'static str, usize, Entry)) -> Row {
    Row {
        block,
        place,
        name: entry.name,
        unit: entry.unit,
        scale: entry.scale.description(),
        low: entry.low,
        high: entry.high,
        mirrored: entry.mirrored,
        meaning: entry.meaning,
    }
}

/// Every entry of an observation with these blocks, in order.
#[pyfunction]
pub(crate) fn observation_table(blocks: &Bound<'_, PyAny>) -> PyResult<Vec<Row>> {
    let entries = layout_from(blocks, false)?.entries().into_iter();
    Ok(entries
        .map(|(block, place, entry)| row((block.name(), place, entry)))
        .collect())
}

/// Every entry of the global state of so many boats, in order.
#[pyfunction]
pub(crate) fn state_table(n_boats: &Bound<'_, PyAny>) -> PyResult<Vec<Row>> {
    let n_boats = count(n_boats, "n_boats")?;
    if n_boats > FlockParameters::MOST_BOATS {
        let accepted = format!("0 to {}", FlockParameters::MOST_BOATS);
        return Err(FlockError::parameter("n_boats", n_boats, accepted).into());
    }
    let entries = state_entries(n_boats).into_iter().enumerate();
    let each = entries.map(|(place, entry)| match place / BOAT.len() {
        boat if boat < n_boats => ("boat", boat, entry),
        _ => ("clock", 0, entry),
    });
    Ok(each.map(row).collect())
}

/// Every feature of a whole flock, in order.
#[pyfunction]
pub(crate) fn flock_feature_table() -> Vec<Row> {
    let entries = flock_feature_entries().into_iter();
    entries
        .map(|(block, entry)| row((block, 0, entry)))
        .collect()
}

/// What the leaders of a flock observe now: (k, size) float32. `rudder`: as the rudders stand.
#[pyfunction]
#[pyo3(signature = (flock, blocks, mirror_to_target=false, rudder=None))]
pub(crate) fn observe<'py>(
    py: Python<'py>,
    flock: &PyFlock,
    blocks: &Bound<'py, PyAny>,
    mirror_to_target: bool,
    rudder: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let flock = flock.read()?;
    let leaders = [flock.parameters().n_leaders];
    let rudder = rudder.map(|rudder| floats(rudder, "rudder", &leaders));
    let rudder = rudder.transpose()?;
    flock.check_rudder(rudder.as_deref())?;
    let layout = layout_from(blocks, mirror_to_target)?;
    observed(py, &flock, layout, rudder.as_deref().unwrap_or_default())
}

/// What the leaders of a flock observe, given the rudders as they stand.
pub(crate) fn observed<'py>(
    py: Python<'py>,
    flock: &Flock,
    layout: ObservationLayout,
    rudders: &[f64],
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let shape = [flock.parameters().n_leaders, layout.size()];
    PyArray1::from_vec(py, observe_flock(flock, layout, rudders)?).reshape(shape)
}

/// The rudders that numbers of levels stand for, of so many that an environment may have; or the other way round, the
/// numbers of the levels nearest to rudders.
#[pyfunction]
pub(crate) fn rudders_of_levels<'py>(
    py: Python<'py>,
    numbers: PyReadonlyArray1<'py, f64>,
    rudder_levels: &Bound<'py, PyAny>,
    are_rudders: bool,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let settings = RudderSettings {
        levels: Some(count(rudder_levels, "rudder_levels")?),
        ..RudderSettings::default()
    };
    settings.check()?;
    let mut numbers = numbers.to_vec()?;
    for number in &mut numbers {
        if !are_rudders {
            settings.check_action(*number)?;
            *number = settings.command(*number);
        } else if (-1.0..=1.0).contains(number) {
            *number = settings.action(*number);
        } else {
            return Err(FlockError::parameter("rudder", number, "numbers in [-1, 1]").into());
        }
    }
    Ok(PyArray1::from_vec(py, numbers))
}
