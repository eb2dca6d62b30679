//! The exceptions that users meet, and core errors as exceptions: the one place where they convert, so that
//! `?` does it elsewhere.

use crate::error::FlockError;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};

/// The exception classes. They belong to `flockenv.errors`, which is where users know them from.
struct Exceptions {
    flock: Py<PyType>,
    parameter: Py<PyType>,
    episode: Py<PyType>,
    solver: Py<PyType>,
    in_use: Py<PyType>,
}

static EXCEPTIONS: PyOnceLock<Exceptions> = PyOnceLock::new();

impl Exceptions {
    fn get(py: Python<'_>) -> PyResult<&Self> {
        EXCEPTIONS.get_or_try_init(py, || Self::new(py))
    }

    fn new(py: Python<'_>) -> PyResult<Self> {
        let flock = class(
            py,
            "FlockError",
            "Base of every error that flockenv raises by itself.",
            vec![py.get_type::<PyException>()],
        )?;
        let kind = |name, doc, base| class(py, name, doc, vec![flock.clone(), base]);
        Ok(Self {
            parameter: kind(
                "ParameterError",
                "A parameter, argument, array, state, snapshot or file is not acceptable.\n\n\
                 The message names it, shows the value and says what would be accepted. Nothing has changed.",
                py.get_type::<PyValueError>(),
            )?
            .unbind(),
            episode: kind(
                "EpisodeError",
                "An environment was stepped before a reset or after the end of its episode.",
                py.get_type::<PyRuntimeError>(),
            )?
            .unbind(),
            solver: kind(
                "SolverError",
                "The motion left the range of 1e9 (cm, cm/s, rad, rad/s).\n\n\
                 The flock is where it was before the call.",
                py.get_type::<PyRuntimeError>(),
            )?
            .unbind(),
            in_use: kind(
                "InUseError",
                "A flock or an environment is at work in another thread: each thread needs one of its own.",
                py.get_type::<PyRuntimeError>(),
            )?
            .unbind(),
            flock: flock.unbind(),
        })
    }
}

/// An exception class, made as a `class` statement of Python makes it: it may have several bases.
fn class<'py>(
    py: Python<'py>,
    name: &str,
    doc: &str,
    bases: Vec<Bound<'py, PyType>>,
) -> PyResult<Bound<'py, PyType>> {
    let body = PyDict::new(py);
    body.set_item("__module__", "flockenv.errors")?;
    body.set_item("__doc__", doc)?;
    let class = py
        .get_type::<PyType>()
        .call1((name, PyTuple::new(py, bases)?, body))?;
    Ok(class.cast_into()?)
}

/// Puts the exception classes into the module.
pub(crate) fn add_exceptions(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let exceptions = Exceptions::get(module.py())?;
    module.add("FlockError", &exceptions.flock)?;
    module.add("ParameterError", &exceptions.parameter)?;
    module.add("EpisodeError", &exceptions.episode)?;
    module.add("SolverError", &exceptions.solver)?;
    module.add("InUseError", &exceptions.in_use)
}

impl From<FlockError> for PyErr {
    fn from(error: FlockError) -> Self {
        Python::attach(|py| {
            let exceptions = match Exceptions::get(py) {
                Ok(exceptions) => exceptions,
                Err(failure) => return failure,
            };
            let message = error.to_string();
            let class = match error {
                FlockError::Parameter { .. }
                | FlockError::Shape { .. }
                | FlockError::Overlap { .. }
                | FlockError::Placement { .. }
                | FlockError::Snapshot(_) => &exceptions.parameter,
                FlockError::Episode(_) => &exceptions.episode,
                FlockError::Solver(_) => &exceptions.solver,
                FlockError::InUse(_) => &exceptions.in_use,
                FlockError::Interrupted => return PyKeyboardInterrupt::new_err(()),
            };
            PyErr::from_type(class.bind(py).clone(), message)
        })
    }
}
