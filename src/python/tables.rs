//! Tables of presets and of physics, and values that are computed from options without a flock.

use super::value::argument;
use crate::clock::whole_steps;
use crate::environment::EnvSettings;
use crate::error::Result;
use crate::parameters::{FlockParameters, Physics, Pool, Preset, Value};
use pyo3::prelude::*;

/// The source of each field of a preset, by name.
#[pyfunction]
pub(super) fn preset_sources(preset: &Bound<'_, PyAny>) -> PyResult<Value> {
    let preset: Preset = argument(preset, "preset")?;
    let fields = FlockParameters::FIELDS.iter();
    Ok(fields
        .map(|field| (field.name, preset.source(field.name)))
        .collect())
}

/// The fields that a choice of physics sets, by name.
#[pyfunction]
pub(super) fn physics_fields(physics: &Bound<'_, PyAny>) -> PyResult<Value> {
    let stepping = argument::<Physics>(physics, "physics")?.stepping();
    let fields = stepping.map(|(dt_s, tolerance_cm)| {
        [
            ("dt_s", Value::from(dt_s)),
            ("tolerance_cm", tolerance_cm.into()),
        ]
    });
    Ok(fields.into_iter().flatten().collect())
}

/// The critical noise of a preset in a pool: bw_s in s, or `None` if it has not been measured.
#[pyfunction]
pub(super) fn critical_bw_s(
    preset: &Bound<'_, PyAny>,
    pool: &Bound<'_, PyAny>,
) -> PyResult<Option<f64>> {
    let preset: Preset = argument(preset, "preset")?;
    Ok(preset.critical_bw_s(&argument(pool, "pool")?))
}

/// Outer and inner radius in cm of a pool, from its name or from its two radii.
#[pyfunction]
pub(super) fn pool_radii_cm(pool: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let pool: Pool = argument(pool, "pool")?;
    Ok((pool.outer_radius_cm, pool.inner_radius_cm))
}

/// Number of decisions in `hold_s` seconds at `rate_hz` decisions per second; an error unless it is a whole number.
#[pyfunction]
pub(super) fn decisions_in(hold_s: &Bound<'_, PyAny>, rate_hz: f64) -> PyResult<u32> {
    let hold_s = argument(hold_s, "hold_s")?;
    Ok(whole_steps("hold_s", hold_s, rate_hz, "decisions")?)
}

/// The rudders of the levels with these indices, in an environment with this number of rudder levels.
#[pyfunction]
pub(super) fn rudders_of_levels(levels: Vec<f64>, rudder_levels: usize) -> Result<Vec<f64>> {
    let settings = EnvSettings {
        rudder_levels: Some(rudder_levels),
        ..EnvSettings::default()
    };
    let mut fields = EnvSettings::FIELDS.iter();
    fields.try_for_each(|field| field.check(&settings))?;
    let rudder = |&level: &f64| {
        let is_level = settings.check_action(level);
        is_level.map(|()| settings.command(level))
    };
    levels.iter().map(rudder).collect()
}
