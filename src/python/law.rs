//! Laws of leaders: by name, by gains or from JSON, and evaluated from observations.

use super::error::parameter_error;
use super::observation::layout_from;
use crate::boat::DampedLaw;
use crate::error::{FlockError, Result};
use crate::policies::{Law, LeaningLaw, ObservedLaw};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// A law that leaders follow.
#[pyclass(name = "Law", module = "flockenv._core", frozen, eq)]
#[derive(PartialEq)]
pub struct PyLaw(pub(super) Law);

#[pymethods]
impl PyLaw {
    /// The law with this name. Laws that differ between pools need the name of the pool.
    #[staticmethod]
    #[pyo3(signature = (name, pool=None))]
    fn named(name: &str, pool: Option<&str>) -> Result<Self> {
        Law::named(name, pool).map(Self)
    }

    /// The damped law with these gains.
    #[staticmethod]
    fn damped(gain: f64, backward_gain: f64, damping: f64) -> Result<Self> {
        let law = DampedLaw {
            gain,
            backward_gain,
            damping,
        };
        law.check()?;
        Ok(Self(Law::Damped(law)))
    }

    /// The leaning law of a JSON text.
    #[staticmethod]
    fn from_json(text: &str) -> Result<Self> {
        LeaningLaw::from_json(text).map(|law| Self(Law::Leaning(Box::new(law))))
    }

    /// A leaning law as a JSON text.
    fn to_json(&self) -> Result<String> {
        self.0.to_json()
    }

    /// Names and values of the law's gains.
    #[getter]
    fn gains(&self) -> Vec<(&'static str, f64)> {
        self.0.gains()
    }
}

/// A law for observations of one layout.
#[pyclass(name = "ObservedLaw", module = "flockenv._core", frozen)]
pub struct PyObservedLaw(ObservedLaw);

#[pymethods]
impl PyObservedLaw {
    #[new]
    #[pyo3(signature = (law, blocks, mirror_to_target=false))]
    fn new(law: &PyLaw, blocks: &Bound<'_, PyAny>, mirror_to_target: bool) -> PyResult<Self> {
        let layout = layout_from(blocks, mirror_to_target)?;
        Ok(Self(ObservedLaw::new(law.0.clone(), &layout)?))
    }

    /// Actions for observations (rows, size): float32, one per row.
    fn actions<'py>(
        &self,
        py: Python<'py>,
        observations: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let size = self.0.observation_size();
        let width = observations.as_array().ncols();
        if width != size {
            let expected = format!("(..., {size}), the size of the law's own layout");
            let message = format!("observation has shape (..., {width}), expected {expected}");
            return Err(parameter_error(message));
        }
        let numbers = observations.as_slice()?;
        let are_numbers = !numbers.iter().any(|number| number.is_nan());
        FlockError::unless(are_numbers, "observation", f64::NAN, "numbers")?;
        let rows = numbers.chunks_exact(size);
        let actions = rows.map(|observation| self.0.action(observation) as f32);
        Ok(PyArray1::from_iter(py, actions))
    }
}
