//! Values of parameters and options from Python, and to it.

use super::arguments::{Texts, count, floats, not_accepted, real, text, texts, truth, wrong_type};
use crate::environment::observation::{Block, ObservationLayout};
use crate::environment::{EnvSettings, OPTIONS, OptionValue, RewardTerm};
use crate::error::FlockError;
use crate::parameters::{Field, Kind, MOST_OBSTACLES, Value};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySequence, PyString, PyTuple};

/// The value of a field of the parameters.
pub(super) fn field_from(value: &Bound<'_, PyAny>, field: &'static Field) -> PyResult<Value> {
    let name = field.name;
    Ok(match field.kind {
        Kind::Count => Value::Count(count(value, name)?),
        Kind::Real => Value::Real(real(value, name)?),
        Kind::Flag => Value::Flag(truth(value, name)?),
        Kind::Choice(_) => Value::Name(text(value, name)?),
        Kind::Choices(_) => match texts(value, name)? {
            Texts::One(name) => Value::Name(name),
            Texts::Each(names) => Value::Names(names),
        },
        Kind::Pool => pool_from(value)?,
        Kind::Rows(columns) => rows_from(value, name, columns)?,
    })
}

/// A pool is its name, or (outer_radius_cm, inner_radius_cm) if it has none.
pub(super) fn pool_from(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    let accepted = "a pool's name or (outer_radius_cm, inner_radius_cm)";
    if value.cast::<PyString>().is_ok() {
        return Ok(Value::Name(text(value, "pool")?));
    }
    let (outer, inner) = pair_from(value, "pool", accepted)?;
    Ok(Value::Radii(outer, inner))
}

fn pair_from(value: &Bound<'_, PyAny>, name: &'static str, accepted: &str) -> PyResult<(f64, f64)> {
    let pair = value.cast::<PySequence>().ok();
    let pair = pair.filter(|pair| pair.len().is_ok_and(|length| length == 2));
    let pair = pair.ok_or_else(|| wrong_type(value, name, accepted))?;
    Ok((
        real(&pair.get_item(0)?, name)?,
        real(&pair.get_item(1)?, name)?,
    ))
}

/// Rows of numbers: any sequence of sequences, or an array (rows, columns).
fn rows_from(value: &Bound<'_, PyAny>, name: &'static str, columns: &[&str]) -> PyResult<Value> {
    let accepted = format!("rows of ({})", columns.join(", "));
    let is_text = value.cast::<PyString>().is_ok() || value.cast::<PyDict>().is_ok();
    let rows = if is_text { None } else { value.len().ok() };
    let rows = rows.ok_or_else(|| wrong_type(value, name, &accepted))?;
    if rows == 0 {
        return Ok(Value::Rows(Vec::new()));
    }
    // Before anything is copied.
    if rows > MOST_OBSTACLES {
        let found = format!("{rows} rows");
        return Err(FlockError::parameter(name, found, "at most 1000 rows").into());
    }
    let first = value.get_item(0);
    if first.is_ok_and(|first| first.extract::<f64>().is_ok()) {
        return Err(not_accepted(name, value, &accepted));
    }
    let numbers = floats(value, name, &[rows, columns.len()])?;
    let rows = numbers.chunks_exact(columns.len()).map(<[f64]>::to_vec);
    Ok(Value::Rows(rows.collect()))
}

/// What Python code gets for a value of the parameters.
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

/// Settings from the options that are given; the others have their defaults.
pub(super) fn settings_from(options: &Bound<'_, PyDict>) -> PyResult<EnvSettings> {
    let mut settings = EnvSettings::default();
    for (name, value) in options {
        let option = OPTIONS
            .iter()
            .find(|option| name.eq(option.name).is_ok_and(|same| same));
        let option =
            option.ok_or_else(|| not_accepted("option", &name, "an option of environments"))?;
        let value = option_from(&value, option.name, &(option.get)(&settings))?;
        (option.set)(&mut settings, value)?;
    }
    Ok(settings)
}

/// A value of the kind that an option has.
fn option_from(
    value: &Bound<'_, PyAny>,
    name: &'static str,
    like: &OptionValue,
) -> PyResult<OptionValue> {
    let given = Some(value).filter(|value| !value.is_none());
    let optional_real = || given.map(|value| real(value, name)).transpose();
    let optional_count = || given.map(|value| count(value, name)).transpose();
    let range = || {
        let accepted = "a number or a range (low, high)";
        given
            .map(|value| pair_from(value, "bw_s", accepted))
            .transpose()
    };
    Ok(match like {
        OptionValue::Real(_) => OptionValue::Real(real(value, name)?),
        OptionValue::OptionalReal(_) => OptionValue::OptionalReal(optional_real()?),
        OptionValue::OptionalRange(_) => OptionValue::OptionalRange(range()?),
        OptionValue::Count(_) => OptionValue::Count(count(value, name)?),
        OptionValue::OptionalCount(_) => OptionValue::OptionalCount(optional_count()?),
        OptionValue::Flag(_) => OptionValue::Flag(truth(value, name)?),
        OptionValue::Name(_) | OptionValue::Names(_) => match texts(value, name)? {
            Texts::One(name) => OptionValue::Name(name),
            Texts::Each(names) => OptionValue::Names(names),
        },
        OptionValue::Blocks(_) => OptionValue::Blocks(blocks_from(value)?),
        OptionValue::Weights(_) => OptionValue::Weights(weights_from(value)?),
    })
}

/// The settings as the dictionary that they would be read from.
pub(super) fn options_dict<'py>(
    py: Python<'py>,
    settings: &EnvSettings,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for option in OPTIONS {
        dict.set_item(option.name, option_written((option.get)(settings), py)?)?;
    }
    Ok(dict)
}

fn option_written(value: OptionValue, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let dict = PyDict::new(py);
    match value {
        OptionValue::Real(real) => return real.into_bound_py_any(py),
        OptionValue::OptionalReal(real) => return real.into_bound_py_any(py),
        OptionValue::OptionalRange(range) => return range.into_bound_py_any(py),
        OptionValue::Count(count) => return count.into_bound_py_any(py),
        OptionValue::OptionalCount(count) => return count.into_bound_py_any(py),
        OptionValue::Flag(flag) => return flag.into_bound_py_any(py),
        OptionValue::Name(name) => return name.into_bound_py_any(py),
        OptionValue::Names(names) => return Ok(PyTuple::new(py, names)?.into_any()),
        OptionValue::Blocks(blocks) => {
            for (block, repeats) in blocks {
                if block.is_counted() {
                    dict.set_item(block.name(), repeats)?;
                } else {
                    dict.set_item(block.name(), repeats > 0)?;
                }
            }
        }
        OptionValue::Weights(weights) => {
            for (term, weight) in weights {
                dict.set_item(term.name(), weight)?;
            }
        }
    }
    Ok(dict.into_any())
}

/// A layout from its blocks and whether it is mirrored.
pub(super) fn layout_from(blocks: &Bound<'_, PyAny>, mirror: bool) -> PyResult<ObservationLayout> {
    let mut layout = ObservationLayout::default();
    layout.mirror_to_target = mirror;
    for (block, repeats) in blocks_from(blocks)? {
        layout.repeat(block, repeats);
    }
    layout.check()?;
    Ok(layout)
}

fn blocks_from(value: &Bound<'_, PyAny>) -> PyResult<Vec<(Block, usize)>> {
    let given = value.cast::<PyDict>();
    let given = given.map_err(|_| wrong_type(value, "observation", "a dictionary of blocks"))?;
    let each = given.iter().map(|(name, value)| {
        let block: Block = text(&name, "observation")?.parse()?;
        let name = block.option();
        let repeats = if block.is_counted() {
            count(&value, name)?
        } else {
            usize::from(truth(&value, name)?)
        };
        Ok((block, repeats))
    });
    each.collect()
}

/// Weights by the names of their terms; terms without one weigh nothing.
fn weights_from(value: &Bound<'_, PyAny>) -> PyResult<Vec<(RewardTerm, f64)>> {
    let given = value.cast::<PyDict>();
    let given = given.map_err(|_| wrong_type(value, "reward", "a dictionary of weights"))?;
    let each = given.iter().map(|(name, value)| {
        let term: RewardTerm = text(&name, "reward")?.parse()?;
        Ok((term, real(&value, "reward")?))
    });
    each.collect()
}
