//! Observations outside environments: the table, a flock observed, laws evaluated.

use super::arguments::{floats, real, text};
use super::flock::PyFlock;
use super::settings::{count, layout_from};
use crate::boat::{Law, TUNED_LAWS};
use crate::environment::RudderSettings;
use crate::environment::observation::{
    BOAT, Entry, FlockView, OBSERVATION_VERSION, ObservationLayout, ObservedLaw, Observer,
    flock_feature_entries, state_entries,
};
use crate::error::FlockError;
use crate::flock::Flock;
use crate::parameters::FlockParameters;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Version of an observation with these blocks, the newest where none are given.
#[pyfunction]
#[pyo3(signature = (blocks=None))]
pub(crate) fn observation_version(blocks: Option<&Bound<'_, PyAny>>) -> PyResult<u32> {
    Ok(match blocks {
        Some(blocks) => layout_from(blocks, false)?.version(),
        None => OBSERVATION_VERSION,
    })
}

/// (block, count in block, name, unit, scale, low, high, mirrored, meaning).
type Row = (
    &'static str,
    usize,
    &'static str,
    &'static str,
    &'static str,
    f64,
    f64,
    bool,
    &'static str,
);

fn row(block: &'static str, count: usize, entry: Entry) -> Row {
    (
        block,
        count,
        entry.name,
        entry.unit,
        entry.scale.description(),
        entry.low,
        entry.high,
        entry.mirrored,
        entry.meaning,
    )
}

/// Every entry of an observation with these blocks, in order.
#[pyfunction]
pub(crate) fn observation_table(blocks: &Bound<'_, PyAny>) -> PyResult<Vec<Row>> {
    let entries = layout_from(blocks, false)?.entries();
    Ok(entries
        .into_iter()
        .map(|(block, count, entry)| row(block.name(), count, entry))
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
    let boats = n_boats * BOAT.len();
    Ok(entries
        .map(|(place, entry)| {
            if place < boats {
                row("boat", place / BOAT.len(), entry)
            } else {
                row("clock", 0, entry)
            }
        })
        .collect())
}

/// Every feature of a whole flock, in order.
#[pyfunction]
pub(crate) fn flock_feature_table() -> Vec<Row> {
    let entries = flock_feature_entries().into_iter();
    entries.map(|(block, entry)| row(block, 0, entry)).collect()
}

/// A law, a pool, and names and values of the law's gains.
type Tuned = (&'static str, &'static str, Vec<(&'static str, f64)>);

/// The gains tuned for each law and pool.
#[pyfunction]
pub(crate) fn tuned_gains() -> Vec<Tuned> {
    let tuned = TUNED_LAWS.iter();
    tuned
        .map(|(name, pool, law)| (*name, *pool, law.gains()))
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
    let leaders = flock.parameters().n_leaders;
    let rudder = rudder.map(|rudder| floats(rudder, "rudder", &[leaders]));
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
    let parameters = flock.parameters();
    let leaders = parameters.n_leaders;
    let order = flock.order_parameters(false);
    let order = if layout.order {
        Some(order?)
    } else {
        order.ok()
    };
    let view = FlockView {
        poses: flock.poses(),
        hulls: flock.hulls(),
        velocities: flock.velocities(),
        leaders,
        phase: flock.phase(),
        bw_s: parameters.bw_s,
        targets: &parameters.target,
        rudders,
        order: order.as_ref(),
    };
    let array = PyArray2::zeros(py, [leaders, layout.size()], false);
    Observer::new(layout, parameters)?.observe(&view, array.readwrite().as_slice_mut()?);
    Ok(array)
}

/// A law as it reads observations of one layout.
#[pyclass(name = "ObservedLaw", module = "flockenv._core", frozen)]
pub struct PyObservedLaw(ObservedLaw);

#[pymethods]
impl PyObservedLaw {
    /// A law by name, with its gains.
    #[new]
    #[pyo3(signature = (name, gains, blocks, mirror_to_target=false))]
    fn new(
        name: &Bound<'_, PyAny>,
        gains: &Bound<'_, PyDict>,
        blocks: &Bound<'_, PyAny>,
        mirror_to_target: bool,
    ) -> PyResult<Self> {
        let gain = |name: &'static str| -> PyResult<f64> {
            let value = gains.get_item(name)?;
            value.map_or(Ok(f64::NAN), |value| real(&value, name))
        };
        let law = match text(name, "law")?.as_str() {
            "steering" => Law::Steering,
            "sign_corrected" => Law::SignCorrected {
                gain: gain("gain")?,
            },
            "damped" => Law::Damped {
                gain: gain("gain")?,
                backward_gain: gain("backward_gain")?,
                damping: gain("damping")?,
            },
            other => {
                let accepted = "\"steering\", \"sign_corrected\" or \"damped\"";
                return Err(FlockError::parameter("law", format!("{other:?}"), accepted).into());
            }
        };
        let layout = layout_from(blocks, mirror_to_target)?;
        Ok(Self(ObservedLaw::new(law, &layout)?))
    }

    /// How many numbers an observation has.
    #[getter]
    fn observation_size(&self) -> usize {
        self.0.observation_size()
    }

    /// Rudders for observations (rows, size), or for a flat row of whole observations.
    fn rudders<'py>(
        &self,
        py: Python<'py>,
        observations: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let rudders = self.of_rows(&observations)?;
        Ok(PyArray1::from_iter(py, rudders.iter().map(|&s| s as f32)))
    }
}

impl PyObservedLaw {
    fn of_rows(&self, observations: &PyReadonlyArray2<'_, f32>) -> PyResult<Vec<f64>> {
        let size = self.0.observation_size();
        let width = observations.as_array().ncols();
        if width == 0 || !width.is_multiple_of(size) {
            return Err(FlockError::Shape {
                field: "observation",
                found: format!("(..., {width})"),
                expected: format!("(..., {size}), the size of the law's own layout"),
            }
            .into());
        }
        let numbers = observations.as_slice()?;
        if numbers.iter().any(|number| number.is_nan()) {
            return Err(FlockError::parameter("observation", f64::NAN, "numbers").into());
        }
        let rows = numbers.chunks_exact(size);
        Ok(rows.map(|observation| self.0.rudder(observation)).collect())
    }
}

fn with_levels(rudder_levels: &Bound<'_, PyAny>) -> PyResult<RudderSettings> {
    let settings = RudderSettings {
        levels: Some(count(rudder_levels, "rudder_levels")?),
        ..RudderSettings::default()
    };
    settings.check()?;
    Ok(settings)
}

/// The rudders that numbers of levels stand for, of so many that an environment may have.
#[pyfunction]
pub(crate) fn level_rudders<'py>(
    py: Python<'py>,
    levels: PyReadonlyArray1<'py, i64>,
    rudder_levels: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let settings = with_levels(rudder_levels)?;
    let actions = levels.as_array().mapv(|level| level as f64);
    for &action in &actions {
        settings.check_action(action)?;
    }
    let rudders = actions.iter().map(|&action| settings.command(action));
    Ok(PyArray1::from_iter(py, rudders))
}

/// Numbers of the levels nearest to rudders, of so many that an environment may have.
#[pyfunction]
pub(crate) fn nearest_levels<'py>(
    py: Python<'py>,
    rudders: PyReadonlyArray1<'py, f64>,
    rudder_levels: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let settings = with_levels(rudder_levels)?;
    let rudders = rudders.as_array();
    if let Some(rudder) = rudders.iter().find(|s| !(-1.0..=1.0).contains(*s)) {
        return Err(FlockError::parameter("rudder", rudder, "numbers in [-1, 1]").into());
    }
    let nearest = rudders.iter().map(|&s| settings.action(s) as i64);
    Ok(PyArray1::from_iter(py, nearest))
}
