//! The checked parameters behind `flockenv.FlockParameters`.

use super::value::{argument, set_fields, wrong_type};
use crate::geometry::{Hull, resized_gyration_radius_cm};
use crate::parameters::{Field, FlockParameters, Value};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Parameters that passed their check.
#[pyclass(name = "Parameters", module = "flockenv._core", frozen)]
pub(super) struct PyParameters(pub(super) FlockParameters);

#[pymethods]
impl PyParameters {
    /// Changes fields of `base`, which is parameters or the name of a preset. If the changes resize the hull and do not set
    /// the radius of gyration, it scales with the hull.
    #[new]
    fn new(base: &Bound<'_, PyAny>, changes: &Bound<'_, PyDict>) -> PyResult<Self> {
        let base = match base.cast::<Self>() {
            Ok(base) => base.get().0.clone(),
            Err(_) => FlockParameters::preset(argument(base, "preset")?),
        };
        let mut changed = base.clone();
        set_fields(&mut changed, FlockParameters::FIELDS, changes)?;
        if !changes.contains("gyration_radius_cm")? {
            let (radius_cm, shape) = (changed.boat_radius_cm, changed.boat_shape);
            changed.gyration_radius_cm = resized_gyration_radius_cm(&base, radius_cm, shape);
        }
        changed.check()?;
        Ok(Self(changed))
    }

    /// The fields by name, as plain Python values.
    #[getter]
    fn values(&self) -> Value {
        Field::values(FlockParameters::FIELDS, &self.0)
    }

    /// Lengths of a hull for pictures, in cm, by name.
    #[getter]
    fn hull_lengths(&self) -> Value {
        Hull::new(&self.0).lengths().into_iter().collect()
    }
}

/// Extracts the parameters that a `flockenv.FlockParameters` holds.
impl<'py> FromPyObject<'_, 'py> for FlockParameters {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let core = object.getattr_opt("_in_core")?;
        let core = core
            .as_ref()
            .and_then(|core| core.cast::<PyParameters>().ok());
        let core = core.ok_or_else(|| wrong_type(&object, "parameters", "FlockParameters"))?;
        Ok(core.get().0.clone())
    }
}
