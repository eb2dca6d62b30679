//! Values of parameters, options and arguments, from Python and to Python. Every error names the field and shows the
//! value. A value out of range is a `ParameterError`, one of the wrong type a `TypeError`.

use crate::error::FlockError;
use crate::parameters::{Field, FlockParameters, Setting, Value};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBytes, PyDict, PyFloat, PyInt, PySequence, PyString, PyTuple};

/// The most items of a list, such as targets of leaders or rows of obstacles, and of a list in it: longer lists are
/// not copied.
const MOST_ITEMS: [usize; 2] = [FlockParameters::MOST_BOATS, 16];

/// A value from a Python object.
pub(super) fn value_from(object: &Bound<'_, PyAny>) -> Value {
    nested_value(object, &MOST_ITEMS)
}

fn nested_value(object: &Bound<'_, PyAny>, most_items: &[usize]) -> Value {
    if object.is_none() {
        Value::None
    } else if let Ok(float) = object.cast::<PyFloat>() {
        Value::Real(float.value())
    } else if let Ok(flag) = object.extract() {
        Value::Flag(flag)
    } else if let Ok(count) = object.extract() {
        Value::Count(count)
    } else if !is_complex(object)
        && let Ok(real) = object.extract()
    {
        Value::Real(real)
    } else if let Ok(name) = object.extract() {
        Value::Name(name)
    } else if let Ok(dict) = object.cast::<PyDict>() {
        let values = dict
            .iter()
            .map(|(name, value)| Some((name.extract().ok()?, nested_value(&value, most_items))));
        values
            .collect::<Option<_>>()
            .map_or(Value::Other, Value::Map)
    } else {
        list_from(object, most_items).map_or(Value::Other, Value::List)
    }
}

/// Whether it is NumPy's complex number: extracting a float would drop the imaginary part.
fn is_complex(object: &Bound<'_, PyAny>) -> bool {
    let kind = object
        .getattr("dtype")
        .and_then(|dtype| dtype.getattr("kind"));
    kind.is_ok_and(|kind| kind.eq("c").unwrap_or(false))
}

fn list_from(object: &Bound<'_, PyAny>, most_items: &[usize]) -> Option<Vec<Value>> {
    let (most, inner) = most_items.split_first()?;
    let length = sequence_length(object).filter(|length| length <= most)?;
    let items = (0..length).map(|index| object.get_item(index).ok());
    items
        .map(|item| Some(nested_value(&item?, inner)))
        .collect()
}

/// The length of a sequence that is not a string, or of an array of any library.
pub(super) fn sequence_length(object: &Bound<'_, PyAny>) -> Option<usize> {
    let text = object.is_instance_of::<PyString>() || object.is_instance_of::<PyBytes>();
    let is_sequence = object.cast::<PySequence>().is_ok() || object.hasattr("shape").ok()?;
    (is_sequence && !text).then(|| object.len().ok()).flatten()
}

/// Converts a value to a Python object.
impl<'py> IntoPyObject<'py> for Value {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match self {
            Self::None | Self::Other => Ok(py.None().into_bound(py)),
            Self::Flag(flag) => flag.into_bound_py_any(py),
            Self::Count(count) => count.into_bound_py_any(py),
            Self::Real(real) => real.into_bound_py_any(py),
            Self::Name(name) => name.into_bound_py_any(py),
            Self::List(values) => Ok(PyTuple::new(py, values)?.into_any()),
            Self::Map(values) => Ok(values.into_py_dict(py)?.into_any()),
        }
    }
}

/// The value of the argument `name`.
pub(super) fn argument<T: Setting>(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<T> {
    let value = value_from(object);
    T::from_value(name, &value).map_err(|error| refused(error, &value, object))
}

/// A seed.
pub(super) fn seed_from(object: &Bound<'_, PyAny>) -> PyResult<u64> {
    Ok(argument::<usize>(object, "seed")? as u64)
}

/// A seed of other noise, or `None`.
pub(super) fn noise_seed_from(object: &Bound<'_, PyAny>) -> PyResult<Option<u64>> {
    Ok(argument::<Option<usize>>(object, "noise_seed")?.map(|seed| seed as u64))
}

/// The error of a field's conversion, with the value from Python.
fn refused(error: FlockError, value: &Value, object: &Bound<'_, PyAny>) -> PyErr {
    match error {
        FlockError::Kind { field, accepted } => {
            let is_long = sequence_length(object).is_some_and(|length| length > MOST_ITEMS[0]);
            match value {
                // An int within 64 bits would have a value.
                Value::Other if object.is_instance_of::<PyInt>() => {
                    return not_accepted(field, object, "a number that fits 64 bits");
                }
                Value::Other if is_long => {
                    return not_accepted(field, object, "at most 100000 items");
                }
                _ => {}
            }
            wrong_type(object, field, &accepted)
        }
        other => other.into(),
    }
}

fn set<S>(of: &mut S, field: &Field<S>, object: &Bound<'_, PyAny>) -> PyResult<()> {
    let value = value_from(object);
    let outcome = (field.set)(of, &value);
    outcome.map_err(|error| refused(error, &value, object))
}

/// Sets fields to the values of a dictionary, without checking them.
pub(super) fn set_given<S>(
    of: &mut S,
    fields: &[Field<S>],
    values: &Bound<'_, PyDict>,
) -> PyResult<()> {
    for (name, value) in values {
        let is_meant = |field: &&Field<S>| name.eq(field.name).is_ok_and(|same| same);
        let field = fields.iter().find(is_meant);
        let field = field.ok_or_else(|| not_accepted("option", &name, "a known option"))?;
        set(of, field, &value)?;
    }
    Ok(())
}

/// The error for a value that is out of range.
fn not_accepted(name: &'static str, value: &Bound<'_, PyAny>, accepted: &str) -> PyErr {
    FlockError::parameter(name, short_repr(value), accepted).into()
}

/// The `TypeError` for an argument.
pub(super) fn wrong_type(object: &Bound<'_, PyAny>, name: &str, accepted: &str) -> PyErr {
    let kind = object.get_type().name();
    let kind = kind.map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let found = short_repr(object);
    PyTypeError::new_err(format!(
        "{name} must be {accepted}, not {found} of type {kind}"
    ))
}

/// Repr of a value for messages, cut to fit a line.
fn short_repr(object: &Bound<'_, PyAny>) -> String {
    const LONGEST: usize = 80;
    // A repr may fail; for an int of more than 4300 digits it does.
    let full = object.repr().map_or_else(
        |_| "a value that cannot be printed".to_owned(),
        |repr| repr.to_string_lossy().into_owned(),
    );
    if full.chars().count() <= LONGEST {
        return full;
    }
    full.chars().take(LONGEST).chain("…".chars()).collect()
}
