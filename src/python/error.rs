//! The exceptions that users meet, and core errors as exceptions: the one place where they convert, so that
//! `?` does it elsewhere.

use crate::error::FlockError;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};

/// A name, what it means, and a built-in class.
type Declared = (
    &'static str,
    &'static str,
    fn(Python<'_>) -> Bound<'_, PyType>,
);

/// The exceptions, each with what it means and the built-in class that it also is. The first is the base of the
/// others.
const DECLARED: [Declared; 5] = [
    (
        "FlockError",
        "Base of every error that flockenv raises by itself.",
        |py| py.get_type::<PyException>(),
    ),
    (
        "ParameterError",
        "A parameter, argument, array, state, snapshot or file is not acceptable.\n\n\
         The message names it, shows the value and says what would be accepted. Nothing has changed.",
        |py| py.get_type::<PyValueError>(),
    ),
    (
        "EpisodeError",
        "An environment was stepped before a reset or after the end of its episode.",
        |py| py.get_type::<PyRuntimeError>(),
    ),
    (
        "SolverError",
        "The motion left the range of 1e9 (cm, cm/s, rad, rad/s).\n\n\
         The flock is where it was before the call.",
        |py| py.get_type::<PyRuntimeError>(),
    ),
    (
        "InUseError",
        "A flock or an environment is at work in another thread: each thread needs one of its own.",
        |py| py.get_type::<PyRuntimeError>(),
    ),
];

static EXCEPTIONS: PyOnceLock<Vec<Py<PyType>>> = PyOnceLock::new();

fn exceptions(py: Python<'_>) -> PyResult<&Vec<Py<PyType>>> {
    EXCEPTIONS.get_or_try_init(py, || {
        let mut made: Vec<Py<PyType>> = Vec::with_capacity(DECLARED.len());
        for (name, doc, built_in) in DECLARED {
            let first = made.first().map(|first| first.bind(py).clone());
            let bases: Vec<_> = first.into_iter().chain([built_in(py)]).collect();
            let body = PyDict::new(py);
            body.set_item("__module__", "flockenv.errors")?;
            body.set_item("__doc__", doc)?;
            // As a `class` statement of Python makes it: it may have several bases.
            let arguments = (name, pyo3::types::PyTuple::new(py, bases)?, body);
            let class = py.get_type::<PyType>().call1(arguments)?;
            made.push(class.cast_into::<PyType>()?.unbind());
        }
        Ok(made)
    })
}

/// Puts the exception classes into the module.
pub(crate) fn add_exceptions(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let classes = exceptions(module.py())?.iter();
    DECLARED
        .iter()
        .zip(classes)
        .try_for_each(|((name, ..), class)| module.add(*name, class))
}

/// The `ParameterError` with a message.
pub(crate) fn refusal(message: String) -> PyErr {
    named("ParameterError", message)
}

fn named(name: &str, message: String) -> PyErr {
    Python::attach(|py| match exceptions(py) {
        Ok(classes) => {
            let mut each = DECLARED.iter().zip(classes);
            let found = each.find(|((known, ..), _)| *known == name);
            let class = found.map_or(&classes[0], |(_, class)| class);
            PyErr::from_type(class.bind(py).clone(), message)
        }
        Err(failure) => failure,
    })
}

impl From<FlockError> for PyErr {
    fn from(error: FlockError) -> Self {
        let name = match error {
            FlockError::Parameter { .. }
            | FlockError::Shape { .. }
            | FlockError::Overlap { .. }
            | FlockError::Placement { .. }
            | FlockError::Snapshot(_) => "ParameterError",
            FlockError::Episode(_) => "EpisodeError",
            FlockError::Solver(_) => "SolverError",
            FlockError::InUse(_) => "InUseError",
            FlockError::Interrupted => return PyKeyboardInterrupt::new_err(()),
        };
        named(name, error.to_string())
    }
}
