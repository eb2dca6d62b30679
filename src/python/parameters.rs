//! `flockenv.FlockParameters` to and from the core's: fields are read as attributes of the same name,
//! so any object that has them will do. Range checks stay in [`FlockParameters::check`].

use super::arguments::{real, text, truth, whole, wrong_type};
use crate::parameters::{FlockParameters, Noise, Pool, Preset, Scheme, Solver, Target};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySequence, PyString};

/// A field of the parameters, as Python holds it.
trait Field: Sized {
    fn read(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self>;
    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>>;
}

macro_rules! fields {
    ($($name:ident)+) => {
        impl<'py> FromPyObject<'_, 'py> for FlockParameters {
            type Error = PyErr;

            fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
                Ok(Self { $($name: read_attribute(&object, stringify!($name))?,)+ })
            }
        }

        /// Every field by name, in the order of documentation.
        pub fn to_dict<'py>(
            py: Python<'py>,
            parameters: &FlockParameters,
        ) -> PyResult<Bound<'py, PyDict>> {
            let fields = PyDict::new(py);
            $(fields.set_item(stringify!($name), parameters.$name.write(py)?)?;)+
            Ok(fields)
        }
    };
}

fields! {
    n_boats n_leaders pool boat_radius_cm boat_shape gyration_radius_cm speed_cm_s reverse_speed_cm_s
    c0 c1 c2 c3 c4 fw_s nop1_s bw_s nop2_s leaders_reverse target scheme noise solver dt_s
    overlap_tolerance_cm relinearizations turning_bias speed_spread_cm_s current_gain
    current_cap_cm_s
}

fn read_attribute<T: Field>(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<T> {
    let value = object.getattr_opt(name)?;
    let value = value.ok_or_else(|| wrong_type(object, "parameters", "FlockParameters"))?;
    Field::read(&value, name)
}

/// The parameters as a `flockenv.FlockParameters`.
pub fn to_python<'py>(
    py: Python<'py>,
    parameters: &FlockParameters,
) -> PyResult<Bound<'py, PyAny>> {
    let class = py
        .import("flockenv.parameters")?
        .getattr("FlockParameters")?;
    class.call((), Some(&to_dict(py, parameters)?))
}

/// The fields of a preset.
#[pyfunction]
pub fn preset_fields<'py>(
    py: Python<'py>,
    name: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let preset: Preset = text(name, "preset")?.parse()?;
    to_dict(py, &FlockParameters::preset(preset))
}

/// The names of the presets.
#[pyfunction]
pub fn preset_names() -> Vec<&'static str> {
    Preset::ALL.iter().map(|preset| preset.name()).collect()
}

/// Where each field of a preset comes from.
#[pyfunction]
pub fn preset_sources<'py>(
    py: Python<'py>,
    name: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let preset: Preset = text(name, "preset")?.parse()?;
    let sources = PyDict::new(py);
    for field in to_dict(py, &FlockParameters::preset(preset))?.keys() {
        let name: String = field.extract()?;
        sources.set_item(field, preset.source(&name))?;
    }
    Ok(sources)
}

/// Checks an object's fields and returns them as plain Python values.
#[pyfunction]
pub fn checked_fields<'py>(
    py: Python<'py>,
    parameters: FlockParameters,
) -> PyResult<Bound<'py, PyDict>> {
    parameters.check()?;
    to_dict(py, &parameters)
}

/// The critical noise of a preset in a pool, or `None` where it has not been measured.
#[pyfunction]
pub fn critical_bw_s(preset: &str, pool: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    Ok(preset
        .parse::<Preset>()?
        .critical_bw_s(&Pool::read(pool, "pool")?))
}

/// Radii of a pool in cm, outer and inner, whether it has a name or not.
#[pyfunction]
pub fn pool_radii_cm(pool: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let pool = Pool::read(pool, "pool")?;
    Ok((pool.outer_radius_cm, pool.inner_radius_cm))
}

impl Field for usize {
    fn read(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self> {
        // Saturates on 32-bit targets, far beyond what any count may be.
        whole(value, name).map(|number| Self::try_from(number).unwrap_or(Self::MAX))
    }

    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.into_bound_py_any(py)
    }
}

impl Field for f64 {
    fn read(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self> {
        real(value, name)
    }

    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.into_bound_py_any(py)
    }
}

impl Field for bool {
    fn read(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self> {
        truth(value, name)
    }

    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.into_bound_py_any(py)
    }
}

/// A pool is its name, or (outer_radius_cm, inner_radius_cm) if it has none.
impl Field for Pool {
    fn read(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self> {
        let accepted = "a pool's name or (outer_radius_cm, inner_radius_cm)";
        if value.cast::<PyString>().is_ok() {
            return Ok(Self::named(&text(value, name)?)?);
        }
        let radii = value.cast::<PySequence>();
        let radii = radii.map_err(|_| wrong_type(value, name, accepted))?;
        if radii.len()? != 2 {
            return Err(wrong_type(value, name, accepted));
        }
        Ok(Self {
            outer_radius_cm: real(&radii.get_item(0)?, name)?,
            inner_radius_cm: real(&radii.get_item(1)?, name)?,
        })
    }

    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match self.name() {
            Some(name) => name.into_bound_py_any(py),
            None => (self.outer_radius_cm, self.inner_radius_cm).into_bound_py_any(py),
        }
    }
}

macro_rules! named_fields {
    ($($type:ty),+) => {
        $(impl Field for $type {
            fn read(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self> {
                Ok(text(value, name)?.parse()?)
            }

            fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.name().into_bound_py_any(py)
            }
        })+
    };
}

named_fields!(Target, Scheme, Noise, Solver);
