//! What the core declares of environments: options, actions, terms of the reward.

use super::arguments::real;
use super::value::options_dict;
use crate::clock::whole_steps;
use crate::environment::{ActionMode, ActionSettings, EnvSettings, OPTIONS, RewardTerm};
use crate::parameters::FlockParameters;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The options of environments with their defaults.
#[pyfunction]
pub(crate) fn env_defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    options_dict(py, &EnvSettings::default())
}

/// What each option of environments means, by name.
#[pyfunction]
pub(crate) fn env_meanings(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let meanings = PyDict::new(py);
    for option in OPTIONS {
        meanings.set_item(option.name, option.doc.trim())?;
    }
    Ok(meanings)
}

/// How many steps of a rate a time in s has, which must be a whole number: messages call the time by `name`, one of
/// those that users give, and its steps by `steps`.
#[pyfunction]
pub(crate) fn whole_steps_in(name: &str, time_s: &Bound<'_, PyAny>, rate_hz: f64) -> PyResult<u32> {
    let (name, steps) = match name {
        "hold_s" => ("hold_s", "decisions"),
        _ => ("period_s", "samples"),
    };
    Ok(whole_steps(name, real(time_s, name)?, rate_hz, steps)?)
}

/// The decision period in s nearest to a number of motor cycles.
#[pyfunction]
pub(crate) fn decision_period_of_cycles(
    cycles: &Bound<'_, PyAny>,
    parameters: FlockParameters,
    control_hz: &Bound<'_, PyAny>,
) -> PyResult<f64> {
    let cycles = real(cycles, "decision_period_cycles")?;
    let control_hz = real(control_hz, "control_hz")?;
    Ok(ActionSettings::period_of_cycles(
        cycles,
        &parameters,
        control_hz,
    )?)
}

/// What an action may stand for.
#[pyfunction]
pub(crate) fn action_modes() -> Vec<&'static str> {
    ActionMode::ALL.iter().map(|mode| mode.name()).collect()
}

/// The terms of the reward: (name, description).
#[pyfunction]
pub(crate) fn reward_terms() -> Vec<(&'static str, &'static str)> {
    let terms = RewardTerm::ALL.iter();
    terms.map(|term| (term.name(), term.doc())).collect()
}
