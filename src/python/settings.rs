//! Options of environments, as a dictionary of plain values, to and from the core's settings.

use super::arguments::{real, text, truth, whole, wrong_type};
use crate::environment::observation::ObservationLayout;
use crate::environment::{EnvSettings, RewardTerm, RewardWeights, TERMS};
use crate::error::FlockError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

/// Settings from the options that are given; the others have their defaults.
pub fn settings_from(options: &Bound<'_, PyDict>) -> PyResult<EnvSettings> {
    let mut settings = EnvSettings::default();
    for (name, value) in options {
        set(&mut settings, &text(&name, "option")?, &value)?;
    }
    Ok(settings)
}

fn set(settings: &mut EnvSettings, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let (episode, rudder) = (&mut settings.episode, &mut settings.rudder);
    match name {
        "target" => episode.target = text(value, "target")?.parse()?,
        "episode_s" => episode.episode_s = optional(value, |v| real(v, "episode_s"))?,
        "control_hz" => episode.control_hz = real(value, "control_hz")?,
        "bw_range_s" => episode.bw_range_s = optional(value, bw_range)?,
        "observation" => read_blocks(&mut settings.observation, value)?,
        "mirror_to_target" => {
            settings.observation.mirror_to_target = truth(value, "mirror_to_target")?;
        }
        "dropout_rate" => settings.camera.dropout_rate = real(value, "dropout_rate")?,
        "delay_frames" => settings.camera.delay_frames = count(value, "delay_frames")?,
        "reward" => settings.reward = weights_from(value)?,
        "rudder_levels" => rudder.levels = optional(value, |v| count(v, "rudder_levels"))?,
        "rudder_lag_s" => rudder.lag_s = real(value, "rudder_lag_s")?,
        "rudder_rate_per_s" => {
            rudder.rate_per_s = optional(value, |v| real(v, "rudder_rate_per_s"))?;
        }
        "autoreset_mode" => settings.autoreset = text(value, "autoreset_mode")?.parse()?,
        _ => return Err(unknown("option", name, "an option of environments")),
    }
    Ok(())
}

/// The settings as the dictionary that they would be read from.
pub fn settings_to_dict<'py>(
    py: Python<'py>,
    settings: &EnvSettings,
) -> PyResult<Bound<'py, PyDict>> {
    let (episode, rudder) = (&settings.episode, &settings.rudder);
    let dict = PyDict::new(py);
    dict.set_item("target", episode.target.name())?;
    dict.set_item("episode_s", episode.episode_s)?;
    dict.set_item("control_hz", episode.control_hz)?;
    dict.set_item("bw_range_s", episode.bw_range_s)?;
    dict.set_item("observation", blocks_to_dict(py, &settings.observation)?)?;
    dict.set_item("mirror_to_target", settings.observation.mirror_to_target)?;
    dict.set_item("dropout_rate", settings.camera.dropout_rate)?;
    dict.set_item("delay_frames", settings.camera.delay_frames)?;
    dict.set_item("reward", weights_to_dict(py, &settings.reward)?)?;
    dict.set_item("rudder_levels", rudder.levels)?;
    dict.set_item("rudder_lag_s", rudder.lag_s)?;
    dict.set_item("rudder_rate_per_s", rudder.rate_per_s)?;
    dict.set_item("autoreset_mode", settings.autoreset.name())?;
    Ok(dict)
}

/// A layout from its blocks and whether it is mirrored.
pub fn layout_from(blocks: &Bound<'_, PyAny>, mirror: bool) -> PyResult<ObservationLayout> {
    let mut layout = ObservationLayout {
        mirror_to_target: mirror,
        ..ObservationLayout::default()
    };
    read_blocks(&mut layout, blocks)?;
    layout.check()?;
    Ok(layout)
}

fn read_blocks(layout: &mut ObservationLayout, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let blocks = value.cast::<PyDict>();
    let blocks = blocks.map_err(|_| wrong_type(value, "observation", "a dictionary of blocks"))?;
    for (name, value) in blocks {
        match text(&name, "observation")?.as_str() {
            "own" => layout.own = truth(&value, "observation own")?,
            "phase" => layout.phase = truth(&value, "observation phase")?,
            "target" => layout.target = truth(&value, "observation target")?,
            "neighbors" => layout.neighbors = count(&value, "observation neighbors")?,
            "order" => layout.order = truth(&value, "observation order")?,
            other => return Err(unknown("observation", other, "a block of the observation")),
        }
    }
    Ok(())
}

fn blocks_to_dict<'py>(
    py: Python<'py>,
    layout: &ObservationLayout,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("own", layout.own)?;
    dict.set_item("phase", layout.phase)?;
    dict.set_item("target", layout.target)?;
    dict.set_item("neighbors", layout.neighbors)?;
    dict.set_item("order", layout.order)?;
    Ok(dict)
}

/// Weights by the names of their terms; terms without one weigh nothing.
fn weights_from(value: &Bound<'_, PyAny>) -> PyResult<RewardWeights> {
    let given = value.cast::<PyDict>();
    let given = given.map_err(|_| wrong_type(value, "reward", "a dictionary of weights"))?;
    let mut weights = RewardWeights([0.0; TERMS]);
    for (name, value) in given {
        let term: RewardTerm = text(&name, "reward")?.parse()?;
        weights.0[term as usize] = real(&value, "reward")?;
    }
    Ok(weights)
}

fn weights_to_dict<'py>(py: Python<'py>, weights: &RewardWeights) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (term, weight) in RewardTerm::ALL.iter().zip(weights.0) {
        if weight != 0.0 {
            dict.set_item(term.name(), weight)?;
        }
    }
    Ok(dict)
}

fn bw_range(value: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let pair = value.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
    let pair = pair.ok_or_else(|| wrong_type(value, "bw_s", "a number or a range (low, high)"))?;
    Ok((
        real(&pair.get_item(0)?, "bw_s")?,
        real(&pair.get_item(1)?, "bw_s")?,
    ))
}

/// A whole number of at least 0.
pub fn count(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<usize> {
    // Saturates on 32-bit targets, far beyond what any count may be.
    Ok(usize::try_from(whole(value, name)?).unwrap_or(usize::MAX))
}

fn optional<T>(
    value: &Bound<'_, PyAny>,
    read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
) -> PyResult<Option<T>> {
    if value.is_none() {
        Ok(None)
    } else {
        read(value).map(Some)
    }
}

fn unknown(field: &'static str, name: &str, accepted: &str) -> PyErr {
    FlockError::parameter(field, format!("{name:?}"), accepted).into()
}

/// The options of environments with their defaults.
#[pyfunction]
pub fn env_defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    settings_to_dict(py, &EnvSettings::default())
}

/// The terms of the reward: (name, description).
#[pyfunction]
pub fn reward_terms() -> Vec<(&'static str, &'static str)> {
    let terms = RewardTerm::ALL.iter();
    terms
        .map(|term| (term.name(), term.description()))
        .collect()
}

/// Names as Python strings, to build dictionaries with.
pub fn term_names(py: Python<'_>) -> Vec<Bound<'_, PyString>> {
    let terms = RewardTerm::ALL.iter();
    terms.map(|term| PyString::new(py, term.name())).collect()
}
