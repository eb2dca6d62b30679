//! Python arguments as Rust values. Every refusal names the argument and shows what was given: a value
//! out of range is a `ParameterError`, a value of the wrong type or dtype a `TypeError`.

use crate::error::FlockError;
use crate::parameters::Targets;
use numpy::{
    PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyList, PySequence, PyString, PyTuple};

/// Arguments that know their name, for signatures.
macro_rules! named_arguments {
    ($($(#[$meta:meta])* $type:ident($inner:ty) = $read:ident($name:literal);)+) => {
        $($(#[$meta])*
        pub(crate) struct $type(pub(crate) $inner);

        impl<'py> FromPyObject<'_, 'py> for $type {
            type Error = PyErr;

            fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
                $read(&object, $name).map(Self)
            }
        })+
    };
}

named_arguments! {
    /// A seed of the random streams.
    Seed(u64) = whole("seed");
    /// Into how many threads work is shared out.
    Threads(u64) = whole("threads");
    /// How long to advance, in s.
    Seconds(f64) = real("seconds");
    /// A point in time, in s.
    TimeS(f64) = real("time_s");
    /// How long a run lasts, in s.
    DurationS(f64) = real("duration_s");
    /// Samples per second.
    SampleHz(f64) = real("sample_hz");
    /// How long one target holds, in s.
    PeriodS(f64) = real("period_s");
    /// How long a deviation from a policy is held, in s.
    HoldS(f64) = real("hold_s");
    /// Motor cycles from one decision to the next.
    DecisionPeriodCycles(f64) = real("decision_period_cycles");
    /// Control steps per second.
    ControlHz(f64) = real("control_hz");
}

/// A whole number that fits 64 bits, from anything with `__index__` but a bool.
pub(crate) fn whole(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<u64> {
    let accepted = "a whole number of at least 0, below 2^64";
    if object.extract::<bool>().is_ok() {
        return Err(wrong_type(object, name, "an integer"));
    }
    object.extract::<u64>().map_err(|error| {
        let out_of_range = error.is_instance_of::<PyOverflowError>(object.py());
        if out_of_range || object.cast::<PyFloat>().is_ok() {
            FlockError::parameter(name, shown(object), accepted).into()
        } else {
            wrong_type(object, name, "an integer")
        }
    })
}

/// A real number, from anything with `__float__` but a bool.
pub(crate) fn real(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<f64> {
    if object.extract::<bool>().is_ok() {
        return Err(wrong_type(object, name, "a number"));
    }
    object.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<PyOverflowError>(object.py()) {
            FlockError::parameter(name, shown(object), "a number that fits a float").into()
        } else {
            wrong_type(object, name, "a number")
        }
    })
}

/// A bool of Python or NumPy.
pub(crate) fn truth(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<bool> {
    let given = object.extract::<bool>();
    given.map_err(|_| wrong_type(object, name, "True or False"))
}

/// A string.
pub(crate) fn text(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<String> {
    let given = object.extract::<String>();
    given.map_err(|_| wrong_type(object, name, "a string"))
}

/// A list or a tuple of strings; `None` for anything that is neither.
pub(crate) fn texts(
    object: &Bound<'_, PyAny>,
    name: &'static str,
) -> PyResult<Option<Vec<String>>> {
    if !object.is_instance_of::<PyList>() && !object.is_instance_of::<PyTuple>() {
        return Ok(None);
    }
    let items = object.try_iter()?.map(|item| text(&item?, name));
    items.collect::<PyResult<_>>().map(Some)
}

/// A string of its own, where a list of strings could have been given.
pub(crate) fn lone_text(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<String> {
    let given = object.extract::<String>();
    given.map_err(|_| wrong_type(object, name, "a string or a list of strings"))
}

/// A target, or a list with one per leader.
pub(crate) fn targets(object: &Bound<'_, PyAny>) -> PyResult<Targets> {
    Ok(match texts(object, "target")? {
        None => Targets::One(lone_text(object, "target")?.parse()?),
        Some(names) if names.is_empty() => {
            let accepted = "\"cw\", \"ccw\", or a list with one of them per leader";
            return Err(FlockError::parameter("target", "[]", accepted).into());
        }
        Some(names) => {
            let targets = names.iter().map(|name| name.parse());
            Targets::Each(targets.collect::<crate::error::Result<_>>()?)
        }
    })
}

/// What an argument may claim beyond its expected size before its dtype is checked.
const HARMLESS: usize = 1 << 16;
/// How deep NumPy stacks sequences.
const DEEPEST: usize = 64;

/// The shape that an array-like suggests, if it would stack to far more numbers than expected. NumPy
/// copies nested sequences before it shows their shape, and a short tuple of broadcast views or a
/// `range` may claim more than there is memory.
#[pyfunction]
pub(crate) fn oversized_shape(values: &Bound<'_, PyAny>, expected: Vec<usize>) -> Option<String> {
    let most = expected.iter().product::<usize>().max(HARMLESS);
    let oversized = claimed(values, most, DEEPEST) > most;
    oversized.then(|| shape_text(&outer_shape(values)))
}

/// How many numbers an array-like would stack to, counted until there are more than `most`.
fn claimed(object: &Bound<'_, PyAny>, most: usize, depth: usize) -> usize {
    if let Some(shape) = array_shape(object) {
        return shape.into_iter().fold(1, usize::saturating_mul);
    }
    let Some(length) = sequence_length(object).filter(|_| depth > 0) else {
        return 1;
    };
    if length > most {
        return length;
    }
    let mut total = 0_usize;
    for place in 0..length {
        let Ok(item) = object.get_item(place) else {
            break;
        };
        total = total.saturating_add(claimed(&item, most, depth - 1));
        if total > most {
            break;
        }
    }
    total
}

/// The shape that the first items of an array-like suggest.
fn outer_shape(object: &Bound<'_, PyAny>) -> Vec<usize> {
    let mut shape = Vec::new();
    let mut item = object.clone();
    while shape.len() < DEEPEST {
        if let Some(inner) = array_shape(&item) {
            shape.extend(inner);
            break;
        }
        let Some(length) = sequence_length(&item) else {
            break;
        };
        shape.push(length);
        match item.get_item(0) {
            Ok(first) => item = first,
            Err(_) => break,
        }
    }
    shape
}

/// The shape of whatever has one: arrays of any library.
fn array_shape(object: &Bound<'_, PyAny>) -> Option<Vec<usize>> {
    object.getattr("shape").ok()?.extract().ok()
}

/// The length of what NumPy stacks: sequences other than strings and mappings.
fn sequence_length(object: &Bound<'_, PyAny>) -> Option<usize> {
    let text = object.is_instance_of::<PyString>() || object.is_instance_of::<PyBytes>();
    let is_sequence = !text && object.cast::<PySequence>().is_ok();
    is_sequence.then(|| object.len().ok()).flatten()
}

/// The numbers of an array-like of a given shape, row by row. Its size is checked before anything is
/// copied.
pub(crate) fn floats(
    object: &Bound<'_, PyAny>,
    name: &'static str,
    expected: &[usize],
) -> PyResult<Vec<f64>> {
    let py = object.py();
    if let Some(found) = oversized_shape(object, expected.to_vec()) {
        return Err(wrong_shape(name, found, expected));
    }
    let array = numpy::get_array_module(py)?
        .call_method1("asarray", (object,))
        .map_err(|error| refuse_ragged(object, name, error))?;
    let array = array.cast::<PyUntypedArray>()?;
    if !matches!(array.dtype().kind(), b'f' | b'i' | b'u') {
        let message = format!(
            "{name} must be an array of real numbers, not of dtype {}",
            array.dtype()
        );
        return Err(PyTypeError::new_err(message));
    }
    if array.shape() != expected {
        return Err(wrong_shape(name, shape_text(array.shape()), expected));
    }
    let array = array.call_method1("astype", (numpy::dtype::<f64>(py),))?;
    let array = array.cast::<PyArrayDyn<f64>>()?.readonly();
    Ok(array.as_array().iter().copied().collect())
}

fn wrong_shape(field: &'static str, found: String, expected: &[usize]) -> PyErr {
    let expected = shape_text(expected);
    FlockError::Shape {
        field,
        found,
        expected,
    }
    .into()
}

fn refuse_ragged(object: &Bound<'_, PyAny>, name: &'static str, error: PyErr) -> PyErr {
    if error.is_instance_of::<PyValueError>(object.py()) {
        return FlockError::parameter(name, shown(object), "a rectangular array of numbers").into();
    }
    error
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
pub(crate) fn same_length(field: &'static str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(FlockError::Shape {
        field,
        found: shape_text(&[found]),
        expected: shape_text(&[expected]),
    }
    .into())
}
