//! Python arguments as Rust values. Every refusal names the argument and shows what was given: a value
//! out of range is a `ParameterError`, a value of the wrong type or dtype a `TypeError`.

use crate::error::FlockError;
use numpy::{
    PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyFloat;

/// Arguments that know their name, for signatures.
macro_rules! named_arguments {
    ($($(#[$meta:meta])* $type:ident($inner:ty) = $read:ident($name:literal);)+) => {
        $($(#[$meta])*
        pub struct $type(pub $inner);

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
    /// How long to advance, in s.
    Seconds(f64) = real("seconds");
    /// A point in time, in s.
    TimeS(f64) = real("time_s");
    /// How long a run lasts, in s.
    DurationS(f64) = real("duration_s");
    /// Samples a second.
    SampleHz(f64) = real("sample_hz");
}

/// A whole number that fits 64 bits, from anything with `__index__` but a bool.
pub fn whole(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<u64> {
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
pub fn real(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<f64> {
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
pub fn truth(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<bool> {
    let given = object.extract::<bool>();
    given.map_err(|_| wrong_type(object, name, "True or False"))
}

/// A string.
pub fn text(object: &Bound<'_, PyAny>, name: &'static str) -> PyResult<String> {
    let given = object.extract::<String>();
    given.map_err(|_| wrong_type(object, name, "a string"))
}

/// The numbers of an array-like of a given shape, row by row. The shape is checked before anything
/// is copied: a broadcast view may claim far more than there is memory.
pub fn floats(
    object: &Bound<'_, PyAny>,
    name: &'static str,
    expected: &[usize],
) -> PyResult<Vec<f64>> {
    let py = object.py();
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
        return Err(FlockError::Shape {
            field: name,
            found: shape_text(array.shape()),
            expected: shape_text(expected),
        }
        .into());
    }
    let array = array.call_method1("astype", (numpy::dtype::<f64>(py),))?;
    let array = array.cast::<PyArrayDyn<f64>>()?.readonly();
    Ok(array.as_array().iter().copied().collect())
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
pub fn wrong_type(object: &Bound<'_, PyAny>, name: &str, accepted: &str) -> PyErr {
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
pub fn shown(object: &Bound<'_, PyAny>) -> String {
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
