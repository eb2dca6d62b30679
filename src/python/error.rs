//! Core errors as Python exceptions: the one place where they convert, so that `?` does it elsewhere.

use crate::error::FlockError;
use pyo3::PyErr;

pyo3::import_exception!(flockenv.errors, EpisodeError);
pyo3::import_exception!(flockenv.errors, ParameterError);
pyo3::import_exception!(flockenv.errors, SolverError);

impl From<FlockError> for PyErr {
    fn from(error: FlockError) -> Self {
        let message = error.to_string();
        match error {
            FlockError::Parameter { .. }
            | FlockError::Shape { .. }
            | FlockError::Overlap { .. }
            | FlockError::Placement { .. }
            | FlockError::Snapshot(_) => ParameterError::new_err(message),
            FlockError::Episode(_) => EpisodeError::new_err(message),
            FlockError::Solver(_) => SolverError::new_err(message),
        }
    }
}
