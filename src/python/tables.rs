//! What the core declares of parameters and options, and what follows from it before there is a flock.

use super::value::{fields_dict, given, set_given};
use crate::clock::whole_steps;
use crate::environment::EnvSettings;
use crate::geometry::resized_gyration_radius_cm;
use crate::parameters::{Field, FlockParameters, Kind, Physics, Pool, Preset};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What is declared of a field: (name, type, unit, accepted, meaning).
pub(super) type Declared = (&'static str, String, &'static str, String, &'static str);

/// What is declared of each of some fields.
pub(super) fn declared<S>(fields: &[Field<S>]) -> Vec<Declared> {
    let each = fields.iter().map(|field| {
        let (kind, accepted) = described(field);
        (field.name, kind, field.unit, accepted, field.doc.trim())
    });
    each.collect()
}

/// A field's type and what it accepts, in words.
fn described<S>(field: &Field<S>) -> (String, String) {
    let listed = |names: fn() -> Vec<&'static str>| {
        let names: Vec<_> = names().iter().map(|name| format!("{name:?}")).collect();
        names.join(", ")
    };
    let range = field.range.accepted().to_owned();
    let (kind, accepted) = match field.kind {
        Kind::Count => ("int", range),
        Kind::Real => ("float", range),
        Kind::Flag => ("bool", range),
        Kind::Map(_) => ("dict", range),
        Kind::Choice(names) => ("str", listed(names)),
        Kind::Pool => ("str or (float, float)", range),
        Kind::Choices(names) => {
            let accepted = format!("{}, or a list of them, one per leader", listed(names));
            ("str or (str, ...)", accepted)
        }
        Kind::Rows(columns) => {
            let columns = vec!["float"; columns.len()].join(", ");
            return (format!("tuple of ({columns})"), range);
        }
    };
    (kind.to_owned(), accepted)
}

/// Parameters with some fields changed, checked, as plain Python values: of others, or of a preset by name. A hull of
/// another size has a radius of gyration in the same ratio to that of a hull of even mass, unless it is given.
#[pyfunction]
pub(super) fn changed_fields<'py>(
    py: Python<'py>,
    preset: &Bound<'py, PyAny>,
    changes: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let base: FlockParameters = match preset.getattr_opt("n_boats")? {
        Some(_) => preset.extract()?,
        None => FlockParameters::preset(given(preset, "preset")?),
    };
    let mut changed = base.clone();
    set_given(&mut changed, FlockParameters::FIELDS, changes)?;
    if !changes.contains("gyration_radius_cm")? {
        let (radius_cm, shape) = (changed.boat_radius_cm, changed.boat_shape);
        changed.gyration_radius_cm = resized_gyration_radius_cm(&base, radius_cm, shape);
    }
    changed.check()?;
    fields_dict(py, &changed, FlockParameters::FIELDS)
}

/// Where each field of a preset comes from.
#[pyfunction]
pub(super) fn preset_sources<'py>(
    py: Python<'py>,
    preset: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let preset: Preset = given(preset, "preset")?;
    let sources = PyDict::new(py);
    for field in FlockParameters::FIELDS {
        sources.set_item(field.name, preset.source(field.name))?;
    }
    Ok(sources)
}

/// The fields that a choice of physics sets.
#[pyfunction]
pub(super) fn physics_fields<'py>(
    py: Python<'py>,
    physics: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    if let Some((dt_s, relinearizations)) = given::<Physics>(physics, "physics")?.stepping() {
        fields.set_item("dt_s", dt_s)?;
        fields.set_item("relinearizations", relinearizations)?;
    }
    Ok(fields)
}

/// The critical noise of a preset in a pool, or `None` if it has not been measured.
#[pyfunction]
pub(super) fn critical_bw_s(
    preset: &Bound<'_, PyAny>,
    pool: &Bound<'_, PyAny>,
) -> PyResult<Option<f64>> {
    let preset: Preset = given(preset, "preset")?;
    Ok(preset.critical_bw_s(&given(pool, "pool")?))
}

/// Radii of a pool in cm, outer and inner, whether it has a name or not.
#[pyfunction]
pub(super) fn pool_radii_cm(pool: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let pool: Pool = given(pool, "pool")?;
    Ok((pool.outer_radius_cm, pool.inner_radius_cm))
}

/// The options of environments with their defaults.
#[pyfunction]
pub(super) fn env_defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    fields_dict(py, &EnvSettings::default(), EnvSettings::FIELDS)
}

/// How many steps of a rate a time in s has, which must be a whole number: messages call the time by `name`, one of
/// those that users give, and its steps by `steps`.
#[pyfunction]
pub(super) fn whole_steps_in(name: &str, time_s: &Bound<'_, PyAny>, rate_hz: f64) -> PyResult<u32> {
    let (name, steps) = match name {
        "hold_s" => ("hold_s", "decisions"),
        _ => ("period_s", "samples"),
    };
    Ok(whole_steps(name, given(time_s, name)?, rate_hz, steps)?)
}

/// The rudders that numbers of levels stand for, of so many that an environment may have; or the other way round, the
/// numbers of the levels nearest to rudders.
#[pyfunction]
pub(super) fn rudders_of_levels<'py>(
    py: Python<'py>,
    numbers: PyReadonlyArray1<'py, f64>,
    rudder_levels: &Bound<'py, PyAny>,
    are_rudders: bool,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let settings = EnvSettings {
        rudder_levels: Some(given(rudder_levels, "rudder_levels")?),
        ..EnvSettings::default()
    };
    let converted = settings.converted_levels(numbers.to_vec()?, are_rudders)?;
    Ok(PyArray1::from_vec(py, converted))
}
