//! Options of environments, as a dictionary of plain values, to and from the core's settings. Which there
//! are is declared in the core.

use super::arguments::{
    ControlHz, DecisionPeriodCycles, HoldS, real, text, texts, truth, whole, wrong_type,
};
use crate::clock::whole_steps;
use crate::environment::observation::{Block, ObservationLayout};
use crate::environment::{
    ActionMode, ActionSettings, EnvOption, EnvSettings, OPTIONS, OptionValue, RewardTerm,
};
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

/// Settings from the options that are given; the others have their defaults.
pub(crate) fn settings_from(options: &Bound<'_, PyDict>) -> PyResult<EnvSettings> {
    let mut settings = EnvSettings::default();
    for (name, value) in options {
        let name = text(&name, "option")?;
        let option = OPTIONS.iter().find(|option| option.name == name);
        let option = option.ok_or_else(|| unknown("option", &name, "an option of environments"))?;
        let value = read(&value, option, &settings)?;
        (option.set)(&mut settings, value)?;
    }
    Ok(settings)
}

/// A value of the kind that the option has.
fn read(
    value: &Bound<'_, PyAny>,
    option: &EnvOption,
    settings: &EnvSettings,
) -> PyResult<OptionValue> {
    let name = option.name;
    Ok(match (option.get)(settings) {
        OptionValue::Real(_) => OptionValue::Real(real(value, name)?),
        OptionValue::OptionalReal(_) => {
            OptionValue::OptionalReal(optional(value, |v| real(v, name))?)
        }
        OptionValue::OptionalRange(_) => OptionValue::OptionalRange(optional(value, bw_range)?),
        OptionValue::Count(_) => OptionValue::Count(count(value, name)?),
        OptionValue::OptionalCount(_) => {
            OptionValue::OptionalCount(optional(value, |v| count(v, name))?)
        }
        OptionValue::Flag(_) => OptionValue::Flag(truth(value, name)?),
        OptionValue::Name(_) | OptionValue::Names(_) => match texts(value, name)? {
            Some(names) => OptionValue::Names(names),
            None => OptionValue::Name(text(value, name)?),
        },
        OptionValue::Blocks(_) => OptionValue::Blocks(blocks_from(value)?),
        OptionValue::Weights(_) => OptionValue::Weights(weights_from(value)?),
    })
}

/// The settings as the dictionary that they would be read from.
pub(crate) fn settings_to_dict<'py>(
    py: Python<'py>,
    settings: &EnvSettings,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for option in OPTIONS {
        dict.set_item(option.name, written((option.get)(settings), py)?)?;
    }
    Ok(dict)
}

fn written(value: OptionValue, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    match value {
        OptionValue::Real(real) => real.into_bound_py_any(py),
        OptionValue::OptionalReal(real) => real.into_bound_py_any(py),
        OptionValue::OptionalRange(range) => range.into_bound_py_any(py),
        OptionValue::Count(count) => count.into_bound_py_any(py),
        OptionValue::OptionalCount(count) => count.into_bound_py_any(py),
        OptionValue::Flag(flag) => flag.into_bound_py_any(py),
        OptionValue::Name(name) => name.into_bound_py_any(py),
        OptionValue::Names(names) => Ok(PyTuple::new(py, names)?.into_any()),
        OptionValue::Blocks(blocks) => {
            let dict = PyDict::new(py);
            for (block, repeats) in blocks {
                if block.is_counted() {
                    dict.set_item(block.name(), repeats)?;
                } else {
                    dict.set_item(block.name(), repeats > 0)?;
                }
            }
            Ok(dict.into_any())
        }
        OptionValue::Weights(weights) => {
            let dict = PyDict::new(py);
            for (term, weight) in weights {
                dict.set_item(term.name(), weight)?;
            }
            Ok(dict.into_any())
        }
    }
}

/// A layout from its blocks and whether it is mirrored.
pub(crate) fn layout_from(blocks: &Bound<'_, PyAny>, mirror: bool) -> PyResult<ObservationLayout> {
    let mut layout = ObservationLayout {
        mirror_to_target: mirror,
        ..ObservationLayout::default()
    };
    for (block, repeats) in blocks_from(blocks)? {
        layout.repeat(block, repeats);
    }
    layout.check()?;
    Ok(layout)
}

fn blocks_from(value: &Bound<'_, PyAny>) -> PyResult<Vec<(Block, usize)>> {
    let given = value.cast::<PyDict>();
    let given = given.map_err(|_| wrong_type(value, "observation", "a dictionary of blocks"))?;
    let mut blocks = Vec::with_capacity(given.len());
    for (name, value) in given {
        let block: Block = text(&name, "observation")?.parse()?;
        let name = block.option();
        let repeats = if block.is_counted() {
            count(&value, name)?
        } else {
            usize::from(truth(&value, name)?)
        };
        blocks.push((block, repeats));
    }
    Ok(blocks)
}

/// Weights by the names of their terms; terms without one weigh nothing.
fn weights_from(value: &Bound<'_, PyAny>) -> PyResult<Vec<(RewardTerm, f64)>> {
    let given = value.cast::<PyDict>();
    let given = given.map_err(|_| wrong_type(value, "reward", "a dictionary of weights"))?;
    let weights = given.into_iter();
    weights
        .map(|(name, value)| {
            let term: RewardTerm = text(&name, "reward")?.parse()?;
            Ok((term, real(&value, "reward")?))
        })
        .collect()
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
pub(crate) fn count(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<usize> {
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
pub(crate) fn env_defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    settings_to_dict(py, &EnvSettings::default())
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

/// For how many decisions something is held that is held for a time in s.
#[pyfunction]
pub(crate) fn held_decisions(hold_s: HoldS, decisions_hz: f64) -> Result<u32> {
    whole_steps("hold_s", hold_s.0, decisions_hz, "decisions")
}

/// The decision period in s nearest to a number of motor cycles.
#[pyfunction]
pub(crate) fn decision_period_of_cycles(
    cycles: DecisionPeriodCycles,
    parameters: FlockParameters,
    control_hz: ControlHz,
) -> Result<f64> {
    ActionSettings::period_of_cycles(cycles.0, &parameters, control_hz.0)
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

/// Names as Python strings, to build dictionaries with.
pub(crate) fn term_names(py: Python<'_>) -> Vec<Bound<'_, PyString>> {
    let terms = RewardTerm::ALL.iter();
    terms.map(|term| PyString::new(py, term.name())).collect()
}
