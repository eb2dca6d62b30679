//! `flockenv.Statistics`.

use super::result::repr_of;
use crate::contact::Statistics;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyDeprecationWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

macro_rules! statistics {
    ($($name:ident: $type:ty),+ $(,)?) => {
        /// Running sums and worst cases since the flock was made or reset; snapshots carry them.
        ///
        /// Attributes
        /// ----------
        /// substeps : int
        ///     Substeps taken.
        /// solves : int
        ///     Contact problems solved; substeps without a contact have none.
        /// contacts : int
        ///     Contacts and near-contacts, summed over substeps.
        /// islands : int
        ///     Islands (boats joined by contacts), summed over solves.
        /// solver_iterations : int
        ///     Solver iterations, summed over solves and islands.
        /// factored_rows : int
        ///     Rows of Cholesky factors computed.
        /// most_factor_entries : int
        ///     Most numbers that the Cholesky factors of one solve held.
        /// unsolved : int
        ///     Solves whose constraints contradicted each other or that exceeded their residual.
        /// depenetration_passes : int
        ///     Passes that moved deeply overlapping hulls apart.
        /// neighbor_builds : int
        ///     Substeps that had to rebuild the neighbor list.
        /// worst_residual_cm_s : float
        ///     Largest natural residual of a solve in cm/s.
        /// worst_overlap_cm : float
        ///     Deepest overlap at the start of a substep in cm, positive.
        /// displaced_angular_momentum_cm2_s : float
        ///     Angular momentum about the pool's center that came or went where hulls that overlapped
        ///     deeply were moved apart, in cm²/s for boats of mass 1: its changes, each positive, summed.
        #[pyclass(name = "Statistics", module = "flockenv.flock", frozen, get_all, eq)]
        #[derive(PartialEq)]
        pub struct PyStatistics { $($name: $type),+ }

        impl From<&Statistics> for PyStatistics {
            fn from(statistics: &Statistics) -> Self {
                let Statistics { $($name),+ } = *statistics;
                Self { $($name),+ }
            }
        }

        #[pymethods]
        impl PyStatistics {
            #[new]
            #[expect(clippy::too_many_arguments, reason = "one for each field")]
            #[pyo3(signature = (*, $($name),+))]
            fn new($($name: $type),+) -> Self {
                Self { $($name),+ }
            }

            fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
                let values = vec![$(self.$name.into_bound_py_any(py)?),+];
                PyTuple::new(py, values)?.hash()
            }

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                let values = vec![$((stringify!($name), self.$name.into_bound_py_any(py)?)),+];
                repr_of(py, "Statistics", values.into_iter())
            }

            fn __reduce__<'py>(
                slf: &Bound<'py, Self>,
            ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
                let fields = PyDict::new(slf.py());
                $(fields.set_item(stringify!($name), slf.get().$name)?;)+
                let partial = slf.py().import("functools")?.getattr("partial")?;
                let copy = partial.call((slf.get_type(),), Some(&fields))?;
                Ok((copy, PyTuple::empty(slf.py())))
            }

            /// Earlier name of `depenetration_passes`.
            #[getter]
            fn recovery_passes(&self, py: Python<'_>) -> PyResult<u64> {
                let message = c"Statistics.recovery_passes is called depenetration_passes";
                PyErr::warn(py, &py.get_type::<PyDeprecationWarning>(), message, 1)?;
                Ok(self.depenetration_passes)
            }
        }
    };
}

statistics! {
    substeps: u64,
    solves: u64,
    contacts: u64,
    islands: u64,
    solver_iterations: u64,
    factored_rows: u64,
    most_factor_entries: u64,
    unsolved: u64,
    depenetration_passes: u64,
    neighbor_builds: u64,
    worst_residual_cm_s: f64,
    worst_overlap_cm: f64,
    displaced_angular_momentum_cm2_s: f64,
}
