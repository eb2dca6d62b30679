//! Conversion of parameters, options and arguments from Python and to Python. Every error names the field and shows the
//! value. It is a `ParameterError` for a value out of range, and a `TypeError` for a value of the wrong type.

use crate::error::FlockError;
use crate::parameters::{Field, FlockParameters, Setting, Value};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBytes, PyDict, PyFloat, PyInt, PySequence, PyString, PyTuple};

/// The most items of a list, such as targets of leaders or rows of obstacles, and of a list within it. Longer lists are not
/// converted.
const MOST_ITEMS: [usize; 2] = [FlockParameters::MOST_BOATS, 16];

/// A value from a Python object.
pub(super) fn value_from(object: &Bound<'_, PyAny>) -> Value {
    nested_value(object, &MOST_ITEMS)
}

/// A value from a Python object. `most_items` are the most items of a list, of a list within it, and so on.
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

/// Whether an object is a complex number of NumPy: extracting a float from it would drop the imaginary part.
fn is_complex(object: &Bound<'_, PyAny>) -> bool {
    let kind = object
        .getattr("dtype")
        .and_then(|dtype| dtype.getattr("kind"));
    kind.is_ok_and(|kind| kind.eq("c").unwrap_or(false))
}

/// The items of a sequence; `None` for other objects and for sequences that are too long.
fn list_from(object: &Bound<'_, PyAny>, most_items: &[usize]) -> Option<Vec<Value>> {
    let (most_here, most_within) = most_items.split_first()?;
    let length = sequence_length(object).filter(|length| length <= most_here)?;
    let items = (0..length).map(|index| object.get_item(index).ok());
    items
        .map(|item| Some(nested_value(&item?, most_within)))
        .collect()
}

/// The length of a sequence that is not a string, or of an array of any library.
pub(super) fn sequence_length(object: &Bound<'_, PyAny>) -> Option<usize> {
    let is_text = object.is_instance_of::<PyString>() || object.is_instance_of::<PyBytes>();
    let is_sequence = object.cast::<PySequence>().is_ok() || object.hasattr("shape").ok()?;
    if is_text || !is_sequence {
        return None;
    }
    object.len().ok()
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
    T::from_value(name, &value).map_err(|error| conversion_error(error, &value, object))
}

/// A seed.
pub(super) fn seed_from(object: &Bound<'_, PyAny>) -> PyResult<u64> {
    Ok(argument::<usize>(object, "seed")? as u64)
}

/// A seed of the noise, or `None`.
pub(super) fn noise_seed_from(object: &Bound<'_, PyAny>) -> PyResult<Option<u64>> {
    Ok(argument::<Option<usize>>(object, "noise_seed")?.map(|seed| seed as u64))
}

/// The Python exception for a failed conversion of a field. It shows the object as Python does.
fn conversion_error(error: FlockError, value: &Value, object: &Bound<'_, PyAny>) -> PyErr {
    match error {
        FlockError::Kind { field, accepted } => {
            let is_long = sequence_length(object).is_some_and(|length| length > MOST_ITEMS[0]);
            match value {
                // An int of at most 64 bits would have been converted.
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

/// Sets one field of `settings`, without checking the value against the field's range.
fn set_field<S>(settings: &mut S, field: &Field<S>, object: &Bound<'_, PyAny>) -> PyResult<()> {
    let value = value_from(object);
    let outcome = (field.set)(settings, &value);
    outcome.map_err(|error| conversion_error(error, &value, object))
}

/// Sets the fields that a dictionary names, without checking the values against the fields' ranges.
pub(super) fn set_fields<S>(
    settings: &mut S,
    fields: &[Field<S>],
    values: &Bound<'_, PyDict>,
) -> PyResult<()> {
    for (name, value) in values {
        let has_name = |field: &&Field<S>| name.eq(field.name).unwrap_or(false);
        let field = fields.iter().find(has_name);
        let field = field.ok_or_else(|| not_accepted("option", &name, "a known option"))?;
        set_field(settings, field, &value)?;
    }
    Ok(())
}

/// The error for a value that is out of range.
fn not_accepted(name: &'static str, value: &Bound<'_, PyAny>, accepted: &str) -> PyErr {
    FlockError::parameter(name, short_repr(value), accepted).into()
}

/// The `TypeError` for an argument of the wrong type.
pub(super) fn wrong_type(object: &Bound<'_, PyAny>, name: &str, accepted: &str) -> PyErr {
    let type_name = object.get_type().name();
    let type_name = type_name.map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let value = short_repr(object);
    PyTypeError::new_err(format!(
        "{name} must be {accepted}, not {value} of type {type_name}"
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
