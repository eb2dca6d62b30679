//! `flockenv.FlockParameters` to and from the core's: fields are read as attributes of the same name,
//! so any object that has them will do. Which there are, and their range, is declared in the core.

use super::arguments::{text, wrong_type};
use super::value::{field_from, pool_from, written};
use crate::geometry::resized_gyration_radius_cm;
use crate::parameters::{Field, FlockParameters, Kind, Physics, Pool, Preset, Value};
use pyo3::prelude::*;
use pyo3::types::PyDict;

impl<'py> FromPyObject<'_, 'py> for FlockParameters {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Self::from_values(|field| {
            let value = object.getattr_opt(field.name)?;
            let value =
                value.ok_or_else(|| wrong_type(&object, "parameters", "FlockParameters"))?;
            field_from(&value, field)
        })
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
pub(crate) fn parameter_table() -> Vec<(&'static str, String, &'static str, String, &'static str)> {
    let fields = FlockParameters::FIELDS.iter();
    fields
        .map(|field| {
            let (kind, accepted) = described(field);
            (field.name, kind, field.unit, accepted, field.doc.trim())
        })
        .collect()
}

/// A field's type and what it accepts, in words.
fn described(field: &Field) -> (String, String) {
    let listed = |names: fn() -> Vec<&'static str>| {
        let names: Vec<_> = names().iter().map(|name| format!("{name:?}")).collect();
        names.join(", ")
    };
    let range = field.range.accepted().to_owned();
    let (kind, accepted) = match field.kind {
        Kind::Count => ("int", range),
        Kind::Real => ("float", range),
        Kind::Flag => ("bool", range),
        Kind::Choice(names) => ("str", listed(names)),
        Kind::Pool => ("str or (float, float)", range),
        Kind::Choices(names) => {
            let names = listed(names);
            (
                "str or (str, ...)",
                format!("{names}, or a list of them, one per leader"),
            )
        }
        Kind::Rows(columns) => {
            let columns = vec!["float"; columns.len()].join(", ");
            return (format!("tuple of ({columns})"), range);
        }
    };
    (kind.to_owned(), accepted)
}

fn preset(name: &Bound<'_, PyAny>) -> PyResult<Preset> {
    Ok(text(name, "preset")?.parse()?)
}

/// The names of the presets.
#[pyfunction]
pub(crate) fn preset_names() -> Vec<&'static str> {
    Preset::ALL.iter().map(|preset| preset.name()).collect()
}

/// Parameters with some fields changed, checked, as plain Python values: of others, or of a preset by name. A hull of
/// another size has a radius of gyration in the same ratio to that of a hull of even mass, unless it is given.
#[pyfunction]
pub(crate) fn changed_fields<'py>(
    py: Python<'py>,
    base: &Bound<'py, PyAny>,
    changes: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let base = match base.getattr_opt("n_boats")? {
        Some(_) => base.extract()?,
        None => FlockParameters::preset(preset(base)?),
    };
    let mut own = base.values().into_iter();
    let mut changed = FlockParameters::from_values(|field| {
        let own = own.next().unwrap_or(Value::Flag(false));
        let change = changes.get_item(field.name)?;
        change.map_or(Ok(own), |change| field_from(&change, field))
    })?;
    if !changes.contains("gyration_radius_cm")? {
        let (radius_cm, shape) = (changed.boat_radius_cm, changed.boat_shape);
        changed.gyration_radius_cm = resized_gyration_radius_cm(&base, radius_cm, shape);
    }
    changed.check()?;
    to_dict(py, &changed)
}

/// Where each field of a preset comes from.
#[pyfunction]
pub(crate) fn preset_sources<'py>(
    py: Python<'py>,
    name: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let preset = preset(name)?;
    let sources = PyDict::new(py);
    for field in FlockParameters::FIELDS {
        sources.set_item(field.name, preset.source(field.name))?;
    }
    Ok(sources)
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

fn pool(value: &Bound<'_, PyAny>) -> PyResult<Pool> {
    Ok(match pool_from(value)? {
        Value::Radii(outer_radius_cm, inner_radius_cm) => Pool {
            outer_radius_cm,
            inner_radius_cm,
        },
        name => Pool::named(&name.to_string())?,
    })
}

/// The critical noise of a preset in a pool, or `None` if it has not been measured.
#[pyfunction]
pub(crate) fn critical_bw_s(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    Ok(name.parse::<Preset>()?.critical_bw_s(&pool(value)?))
}

/// Radii of a pool in cm, outer and inner, whether it has a name or not.
#[pyfunction]
pub(crate) fn pool_radii_cm(value: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let pool = pool(value)?;
    Ok((pool.outer_radius_cm, pool.inner_radius_cm))
}
