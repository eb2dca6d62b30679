//! The exceptions that users meet. Other files convert errors of the core with `?`, which calls the conversion here.

use crate::error::FlockError;
use pyo3::exceptions::{
    PyException, PyKeyboardInterrupt, PyRuntimeError, PyTypeError, PyValueError,
};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyTuple, PyType};

/// Names and docstrings of the exceptions. The first is the base of the others. Each also derives from a built-in
/// exception.
const DECLARED: [(&str, &str); 5] = [
    (
        "FlockError",
        "Base of every error that flockenv raises by itself.",
    ),
    (
        "ParameterError",
        "A parameter, argument, array, state, snapshot or file is not acceptable.\n\n\
         The message names it, shows the value and says what would be accepted. Nothing has changed.",
    ),
    (
        "EpisodeError",
        "An environment was stepped before a reset or after the end of its episode.",
    ),
    (
        "SolverError",
        "The motion could not be continued: boats left the water or the range of 1e9 (cm, cm/s, rad, rad/s), moved \
         too far in a substep, or had contacts that took too much work.\n\n\
         The flock is where it was before the call.",
    ),
    (
        "InUseError",
        "A flock or an environment is at work in another thread: each thread needs one of its own.",
    ),
];
/// Indices of the exceptions in `DECLARED`.
const BASE: usize = 0;
const PARAMETER: usize = 1;
const EPISODE: usize = 2;
const SOLVER: usize = 3;
const IN_USE: usize = 4;

static EXCEPTIONS: PyOnceLock<Vec<Py<PyType>>> = PyOnceLock::new();

/// The exception classes, which the first call makes.
fn exceptions(py: Python<'_>) -> PyResult<&Vec<Py<PyType>>> {
    EXCEPTIONS.get_or_try_init(py, || {
        let mut classes: Vec<Py<PyType>> = Vec::new();
        for (index, (name, doc)) in DECLARED.into_iter().enumerate() {
            let built_in = match index {
                BASE => py.get_type::<PyException>(),
                PARAMETER => py.get_type::<PyValueError>(),
                _ => py.get_type::<PyRuntimeError>(),
            };
            let base = classes.get(BASE).map(|base| base.bind(py).clone());
            let bases = PyTuple::new(py, base.into_iter().chain([built_in]).collect::<Vec<_>>())?;
            let body = [("__module__", "flockenv.errors"), ("__doc__", doc)].into_py_dict(py)?;
            // `type` makes the class, as Python's `class` statement does: unlike an exception declared with pyo3, it may
            // have several bases.
            let class = py.get_type::<PyType>().call1((name, bases, body))?;
            classes.push(class.cast_into::<PyType>()?.unbind());
        }
        Ok(classes)
    })
}

/// Puts the exception classes into the module.
pub(super) fn add_exceptions(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let mut classes = exceptions(module.py())?.iter();
    classes.try_for_each(|class| module.add(class.bind(module.py()).name()?, class))
}

/// The `ParameterError` with a message.
pub(super) fn parameter_error(message: String) -> PyErr {
    exception(PARAMETER, message)
}

/// The exception of the class with this index.
fn exception(index: usize, message: String) -> PyErr {
    Python::attach(|py| match exceptions(py) {
        Ok(classes) => PyErr::from_type(classes[index].bind(py).clone(), message),
        Err(failure) => failure,
    })
}

impl From<FlockError> for PyErr {
    fn from(error: FlockError) -> Self {
        let index = match error {
            FlockError::Parameter { .. }
            | FlockError::Shape { .. }
            | FlockError::Overlap { .. }
            | FlockError::Placement { .. }
            | FlockError::Snapshot(_) => PARAMETER,
            FlockError::Episode(_) => EPISODE,
            FlockError::Solver(_) => SOLVER,
            FlockError::InUse(_) => IN_USE,
            FlockError::Kind { .. } => return PyTypeError::new_err(error.to_string()),
            FlockError::Interrupted => return PyKeyboardInterrupt::new_err(()),
        };
        exception(index, error.to_string())
    }
}
