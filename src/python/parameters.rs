//! `flockenv.FlockParameters` to and from the core's: fields are read as attributes of the same name,
//! so any object that has them will do. Which there are, and their range, is declared in the core.

use super::arguments::{floats, lone_text, real, shown, text, texts, truth, wrong_type};
use super::settings::count;
use crate::error::FlockError;
use crate::geometry;
use crate::parameters::{
    Field, FlockParameters, Kind, MOST_OBSTACLES, Physics, Pool, Preset, Value,
};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PySequence, PyString, PyTuple};

impl<'py> FromPyObject<'_, 'py> for FlockParameters {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Self::from_values(|field| {
            let value = object.getattr_opt(field.name)?;
            let value =
                value.ok_or_else(|| wrong_type(&object, "parameters", "FlockParameters"))?;
            read(&value, field)
        })
    }
}

fn read(value: &Bound<'_, PyAny>, field: &'static Field) -> PyResult<Value> {
    let name = field.name;
    Ok(match field.kind {
        Kind::Count => Value::Count(count(value, name)?),
        Kind::Real => Value::Real(real(value, name)?),
        Kind::Flag => Value::Flag(truth(value, name)?),
        Kind::Choice(_) => Value::Name(text(value, name)?),
        Kind::Choices(_) => match texts(value, name)? {
            Some(names) => Value::Names(names),
            None => Value::Name(lone_text(value, name)?),
        },
        Kind::Pool => read_pool(value, name)?,
        Kind::Rows(columns) => read_rows(value, name, columns)?,
    })
}

/// A pool is its name, or (outer_radius_cm, inner_radius_cm) if it has none.
fn read_pool(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Value> {
    let accepted = "a pool's name or (outer_radius_cm, inner_radius_cm)";
    if value.cast::<PyString>().is_ok() {
        return Ok(Value::Name(text(value, name)?));
    }
    let radii = value.cast::<PySequence>();
    let radii = radii.map_err(|_| wrong_type(value, name, accepted))?;
    if radii.len()? != 2 {
        return Err(wrong_type(value, name, accepted));
    }
    Ok(Value::Radii(
        real(&radii.get_item(0)?, name)?,
        real(&radii.get_item(1)?, name)?,
    ))
}

/// Rows of numbers: any sequence of sequences, or an array (rows, columns).
fn read_rows(value: &Bound<'_, PyAny>, name: &'static str, columns: &[&str]) -> PyResult<Value> {
    let accepted = format!("rows of ({})", columns.join(", "));
    let is_text = value.cast::<PyString>().is_ok() || value.cast::<PyDict>().is_ok();
    let rows = if is_text { None } else { value.len().ok() };
    let rows = rows.ok_or_else(|| wrong_type(value, name, &accepted))?;
    if rows == 0 {
        return Ok(Value::Rows(Vec::new()));
    }
    // Before anything is copied.
    if rows > MOST_OBSTACLES {
        return Err(
            FlockError::parameter(name, format!("{rows} rows"), "at most 1000 rows").into(),
        );
    }
    let first = value.get_item(0);
    if first.is_ok_and(|first| first.extract::<f64>().is_ok()) {
        return Err(FlockError::parameter(name, shown(value), accepted).into());
    }
    let numbers = floats(value, name, &[rows, columns.len()])?;
    let rows = numbers.chunks_exact(columns.len()).map(<[f64]>::to_vec);
    Ok(Value::Rows(rows.collect()))
}

fn pool_from(value: &Bound<'_, PyAny>) -> PyResult<Pool> {
    Ok(match read_pool(value, "pool")? {
        Value::Radii(outer_radius_cm, inner_radius_cm) => Pool {
            outer_radius_cm,
            inner_radius_cm,
        },
        name => Pool::named(&name.to_string())?,
    })
}

/// What Python code gets for a value.
pub(super) fn written<'py>(value: &Value, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::Count(count) => count.into_bound_py_any(py),
        Value::Real(real) => real.into_bound_py_any(py),
        Value::Flag(flag) => flag.into_bound_py_any(py),
        Value::Name(name) => name.into_bound_py_any(py),
        Value::Radii(outer, inner) => (outer, inner).into_bound_py_any(py),
        Value::Names(names) => Ok(PyTuple::new(py, names)?.into_any()),
        Value::Rows(rows) => {
            let rows = rows.iter().map(|row| PyTuple::new(py, row));
            let rows = rows.collect::<PyResult<Vec<_>>>()?;
            Ok(PyTuple::new(py, rows)?.into_any())
        }
    }
}

/// Every field by name, in the order of documentation.
pub(crate) fn to_dict<'py>(
    py: Python<'py>,
    parameters: &FlockParameters,
) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    for (field, value) in FlockParameters::FIELDS.iter().zip(parameters.values()) {
        fields.set_item(field.name, written(&value, py)?)?;
    }
    Ok(fields)
}

/// What is declared of each field: (name, type, unit, accepted, meaning).
#[pyfunction]
pub(crate) fn parameter_table() -> Vec<(&'static str, String, &'static str, String, String)> {
    let fields = FlockParameters::FIELDS.iter();
    fields
        .map(|field| {
            let doc = field.doc.trim().to_owned();
            (
                field.name,
                kind_name(field.kind),
                field.unit,
                accepted(field),
                doc,
            )
        })
        .collect()
}

fn kind_name(kind: Kind) -> String {
    let name = match kind {
        Kind::Count => "int",
        Kind::Real => "float",
        Kind::Flag => "bool",
        Kind::Choice(_) => "str",
        Kind::Pool => "str or (float, float)",
        Kind::Choices(_) => "str or (str, ...)",
        Kind::Rows(columns) => {
            return format!("tuple of ({})", vec!["float"; columns.len()].join(", "));
        }
    };
    name.to_owned()
}

fn accepted(field: &Field) -> String {
    let listed = |names: fn() -> Vec<&'static str>| {
        let names: Vec<_> = names().iter().map(|name| format!("{name:?}")).collect();
        names.join(", ")
    };
    match field.kind {
        Kind::Choice(names) => listed(names),
        Kind::Choices(names) => format!("{}, or a list of them, one per leader", listed(names)),
        _ => field.range.accepted().to_owned(),
    }
}

/// The class that parameters are handed out as.
static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// Names the class that parameters are handed out as, once: it takes the fields as keyword arguments.
/// Without one they are handed out as a dict.
#[pyfunction]
pub(crate) fn set_parameters_class(py: Python<'_>, class: Py<PyAny>) {
    CLASS.get_or_init(py, || class);
}

/// The parameters as users know them.
pub(crate) fn to_python<'py>(
    py: Python<'py>,
    parameters: &FlockParameters,
) -> PyResult<Bound<'py, PyAny>> {
    let fields = to_dict(py, parameters)?;
    match CLASS.get(py) {
        Some(class) => class.bind(py).call((), Some(&fields)),
        None => Ok(fields.into_any()),
    }
}

/// The fields of a preset.
#[pyfunction]
pub(crate) fn preset_fields<'py>(
    py: Python<'py>,
    name: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let preset: Preset = text(name, "preset")?.parse()?;
    to_dict(py, &FlockParameters::preset(preset))
}

/// The fields that a choice of physics sets.
#[pyfunction]
pub(crate) fn physics_fields<'py>(
    py: Python<'py>,
    name: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let physics: Physics = text(name, "physics")?.parse()?;
    let fields = PyDict::new(py);
    if let Some((dt_s, relinearizations)) = physics.stepping() {
        fields.set_item("dt_s", dt_s)?;
        fields.set_item("relinearizations", relinearizations)?;
    }
    Ok(fields)
}

/// The names of the presets.
#[pyfunction]
pub(crate) fn preset_names() -> Vec<&'static str> {
    Preset::ALL.iter().map(|preset| preset.name()).collect()
}

/// Where each field of a preset comes from.
#[pyfunction]
pub(crate) fn preset_sources<'py>(
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
pub(crate) fn checked_fields<'py>(
    py: Python<'py>,
    parameters: FlockParameters,
) -> PyResult<Bound<'py, PyDict>> {
    parameters.check()?;
    to_dict(py, &parameters)
}

/// The radius of gyration of parameters with a resized hull, in cm.
#[pyfunction]
pub(crate) fn resized_gyration_radius_cm(
    parameters: FlockParameters,
    boat_radius_cm: &Bound<'_, PyAny>,
    boat_shape: &Bound<'_, PyAny>,
) -> PyResult<f64> {
    let radius = real(boat_radius_cm, "boat_radius_cm")?;
    let shape = real(boat_shape, "boat_shape")?;
    Ok(geometry::resized_gyration_radius_cm(
        &parameters,
        radius,
        shape,
    ))
}

/// The critical noise of a preset in a pool, or `None` where it has not been measured.
#[pyfunction]
pub(crate) fn critical_bw_s(preset: &str, pool: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    Ok(preset.parse::<Preset>()?.critical_bw_s(&pool_from(pool)?))
}

/// Radii of a pool in cm, outer and inner, whether it has a name or not.
#[pyfunction]
pub(crate) fn pool_radii_cm(pool: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let pool = pool_from(pool)?;
    Ok((pool.outer_radius_cm, pool.inner_radius_cm))
}
