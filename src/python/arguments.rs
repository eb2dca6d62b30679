//! Python arguments as Rust values. Every refusal names the argument and shows what was given: a value
//! out of range is a `ParameterError`, a value of the wrong type or dtype a `TypeError`.

use super::error::refusal;
use crate::error::FlockError;
use crate::parameters::Targets;
use numpy::{
    PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyInt, PyList, PySequence, PyString, PyTuple};

/// A whole number that fits 64 bits, from anything with `__index__` but a bool.
pub(crate) fn whole(object: &Bound<'_, PyAny>, name: &str) -> PyResult<u64> {
    let accepted = "a whole number of at least 0, below 2^64";
    if object.extract::<bool>().is_ok() {
        return Err(wrong_type(object, name, "an integer"));
    }
    object.extract::<u64>().map_err(|error| {
        let out_of_range = error.is_instance_of::<PyOverflowError>(object.py());
        if out_of_range || object.cast::<PyFloat>().is_ok() {
            not_accepted(name, object, accepted)
        } else {
            wrong_type(object, name, "an integer")
        }
    })
}

/// A whole number of at least 0.
pub(crate) fn count(object: &Bound<'_, PyAny>, name: &str) -> PyResult<usize> {
    // Saturates on 32-bit targets, far beyond what any count may be.
    Ok(usize::try_from(whole(object, name)?).unwrap_or(usize::MAX))
}

/// A real number, from anything with `__float__` but a bool.
pub(crate) fn real(object: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    if object.extract::<bool>().is_ok() {
        return Err(wrong_type(object, name, "a number"));
    }
    object.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<PyOverflowError>(object.py()) {
            not_accepted(name, object, "a number that fits a float")
        } else {
            wrong_type(object, name, "a number")
        }
    })
}

/// A bool of Python or NumPy.
pub(crate) fn truth(object: &Bound<'_, PyAny>, name: &str) -> PyResult<bool> {
    let given = object.extract::<bool>();
    given.map_err(|_| wrong_type(object, name, "True or False"))
}

/// A string.
pub(crate) fn text(object: &Bound<'_, PyAny>, name: &str) -> PyResult<String> {
    let given = object.extract::<String>();
    given.map_err(|_| wrong_type(object, name, "a string"))
}

/// A string, or a list or tuple of strings.
pub(crate) enum Texts {
    One(String),
    Each(Vec<String>),
}

/// A string, or a list or tuple of strings.
pub(crate) fn texts(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Texts> {
    if object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>() {
        let items = object.try_iter()?.map(|item| text(&item?, name));
        return items.collect::<PyResult<_>>().map(Texts::Each);
    }
    let one = object.extract::<String>();
    one.map(Texts::One)
        .map_err(|_| wrong_type(object, name, "a string or a list of strings"))
}

/// A target, or a list with one per leader.
pub(crate) fn targets(object: &Bound<'_, PyAny>) -> PyResult<Targets> {
    Ok(match texts(object, "target")? {
        Texts::One(name) => Targets::One(name.parse()?),
        Texts::Each(names) if names.is_empty() => {
            let accepted = "\"cw\", \"ccw\", or a list with one of them per leader";
            return Err(FlockError::parameter("target", "[]", accepted).into());
        }
        Texts::Each(names) => {
            let targets = names.iter().map(|name| name.parse());
            Targets::Each(targets.collect::<crate::error::Result<_>>()?)
        }
    })
}

/// The shape of whatever has one: arrays of any library.
fn array_shape(object: &Bound<'_, PyAny>) -> Option<Vec<usize>> {
    object.getattr("shape").ok()?.extract().ok()
}

/// The length of what stacks to an array: sequences other than strings.
fn sequence_length(object: &Bound<'_, PyAny>) -> Option<usize> {
    let text = object.is_instance_of::<PyString>() || object.is_instance_of::<PyBytes>();
    let is_sequence = !text && object.cast::<PySequence>().is_ok();
    is_sequence.then(|| object.len().ok()).flatten()
}

/// The shape that the first items of an array-like suggest, to so many axes.
fn outer_shape(object: &Bound<'_, PyAny>, axes: usize) -> Vec<usize> {
    if let Some(shape) = array_shape(object) {
        return shape;
    }
    let Some(length) = sequence_length(object).filter(|_| axes > 0) else {
        return Vec::new();
    };
    let first = object.get_item(0);
    let inner = first.map_or_else(|_| Vec::new(), |first| outer_shape(&first, axes - 1));
    [vec![length], inner].concat()
}

/// Refuses an array-like whose first item is no real number.
fn check_kind(object: &Bound<'_, PyAny>, name: &str, axes: usize) -> PyResult<()> {
    if array_shape(object).is_some() {
        let kind = object
            .getattr("dtype")
            .and_then(|dtype| dtype.getattr("kind"));
        let kind = kind.and_then(|kind| kind.extract::<char>());
        return match kind {
            Ok('f' | 'i' | 'u') | Err(_) => Ok(()),
            Ok(_) => Err(wrong_dtype(name, object.getattr("dtype")?)),
        };
    }
    match sequence_length(object) {
        Some(length) if length > 0 && axes > 0 => check_kind(&object.get_item(0)?, name, axes - 1),
        Some(_) => Ok(()),
        None => real(object, name).map(|_| ()),
    }
}

fn wrong_dtype(name: &str, dtype: impl std::fmt::Display) -> PyErr {
    PyTypeError::new_err(format!(
        "{name} must be an array of real numbers, not of dtype {dtype}"
    ))
}

/// The numbers of an array-like of a given shape, row by row, and whether all are integers. Sequences are read item
/// by item: NumPy would copy them before their shape is known, and a short tuple of views or a `range` may claim more
/// numbers than there is memory.
struct Numbers {
    values: Vec<f64>,
    are_whole: bool,
}

impl Numbers {
    fn of(object: &Bound<'_, PyAny>, name: &str, expected: &[usize]) -> PyResult<Self> {
        let mut numbers = Self {
            values: Vec::with_capacity(expected.iter().product()),
            are_whole: true,
        };
        if numbers.read(object, name, expected)? {
            return Ok(numbers);
        }
        check_kind(object, name, MOST_AXES)?;
        let found = outer_shape(object, MOST_AXES);
        Err(wrong_shape(name, shape_text(&found), &shape_text(expected)))
    }

    /// Reads a part of that shape; false if it has another one.
    fn read(&mut self, part: &Bound<'_, PyAny>, name: &str, shape: &[usize]) -> PyResult<bool> {
        if let Some(found) = array_shape(part) {
            return Ok(found == shape && self.read_array(part, name)?);
        }
        match (sequence_length(part), shape) {
            (None, []) => self.read_number(part, name),
            (None, _) if part.extract::<f64>().is_ok() => Ok(false),
            (None, _) => Err(wrong_type(part, name, "an array of real numbers")),
            (Some(length), [first, rest @ ..]) if length == *first => {
                for place in 0..length {
                    if !self.read(&part.get_item(place)?, name, rest)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            (Some(_), _) => Ok(false),
        }
    }

    fn read_number(&mut self, number: &Bound<'_, PyAny>, name: &str) -> PyResult<bool> {
        self.are_whole &= number.is_instance_of::<PyInt>();
        self.values.push(real(number, name)?);
        Ok(true)
    }

    fn read_array(&mut self, array: &Bound<'_, PyAny>, name: &str) -> PyResult<bool> {
        let py = array.py();
        let asarray = numpy::get_array_module(py)?.getattr("asarray")?;
        let array = asarray.call1((array,))?.cast_into::<PyUntypedArray>()?;
        let dtype = array.dtype();
        if !matches!(dtype.kind(), b'f' | b'i' | b'u') {
            return Err(wrong_dtype(name, dtype));
        }
        self.are_whole &= dtype.kind() != b'f';
        let array = array.call_method1("astype", (numpy::dtype::<f64>(py),))?;
        let array = array.cast::<PyArrayDyn<f64>>()?.readonly();
        self.values.extend(array.as_array());
        Ok(true)
    }
}

/// How deep NumPy stacks sequences.
const MOST_AXES: usize = 64;

/// The numbers of an array-like of a given shape, row by row.
pub(crate) fn floats(
    object: &Bound<'_, PyAny>,
    name: &str,
    expected: &[usize],
) -> PyResult<Vec<f64>> {
    Ok(Numbers::of(object, name, expected)?.values)
}

/// Actions of a given shape, one number per leader: rudders, or numbers of levels if there are such. A rudder of 1.0
/// is not level 1, so that levels must be integers. Messages call the actions by `name`.
#[pyfunction]
#[pyo3(signature = (actions, shape, levels, name="actions"))]
pub(crate) fn flat_actions<'py>(
    actions: &Bound<'py, PyAny>,
    shape: Vec<usize>,
    levels: Option<usize>,
    name: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let numbers = Numbers::of(actions, name, &shape)?;
    match levels {
        Some(levels) if !numbers.are_whole => Err(refusal(format!(
            "{name} must be integers, whole numbers from 0 to {} that name levels of the rudder",
            levels.saturating_sub(1)
        ))),
        _ => Ok(PyArray1::from_vec(actions.py(), numbers.values)),
    }
}

/// The error of an array of another shape.
pub(crate) fn wrong_shape(name: &str, found: String, expected: &str) -> PyErr {
    refusal(format!("{name} has shape {found}, expected {expected}"))
}

/// The error of a value that is out of range.
pub(crate) fn not_accepted(name: &str, value: &Bound<'_, PyAny>, accepted: &str) -> PyErr {
    refusal(format!(
        "{name} = {} is not accepted: {accepted}",
        shown(value)
    ))
}

fn shape_text(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("{shape:?}").replace('[', "(").replace(']', ")"),
    }
}

/// The `TypeError` for an argument.
pub(crate) fn wrong_type(object: &Bound<'_, PyAny>, name: &str, accepted: &str) -> PyErr {
    let kind = object.get_type();
    let kind = kind
        .name()
        .map_or_else(|_| "?".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!(
        "{name} must be {accepted}, not {} of type {kind}",
        shown(object)
    ))
}

/// What a message shows of a value: its repr, cut at a length that fits a line.
pub(crate) fn shown(object: &Bound<'_, PyAny>) -> String {
    const LONGEST: usize = 80;
    // A repr may fail: that of an int of more than 4300 digits does.
    let full = object.repr().map_or_else(
        |_| "a value that cannot be printed".to_owned(),
        |repr| repr.to_string_lossy().into_owned(),
    );
    if full.chars().count() <= LONGEST {
        return full;
    }
    full.chars().take(LONGEST).chain("…".chars()).collect()
}

/// Refuses a series of another length than those it belongs to.
pub(crate) fn same_length(name: &str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(wrong_shape(
        name,
        shape_text(&[found]),
        &shape_text(&[expected]),
    ))
}
