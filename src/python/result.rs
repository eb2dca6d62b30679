//! What the classes of results have in common: how they print and compare.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// `Class(field=value, …)`, as a dataclass prints.
pub(crate) fn repr_of<'py, T: IntoPyObjectExt<'py>>(
    py: Python<'py>,
    class: &str,
    fields: impl Iterator<Item = (&'static str, T)>,
) -> PyResult<String> {
    let mut parts = Vec::new();
    for (name, value) in fields {
        let value = value.into_bound_py_any(py)?;
        parts.push(format!("{name}={}", value.repr()?));
    }
    Ok(format!("{class}({})", parts.join(", ")))
}

/// Whether arrays are equal in pairs; NaN equals NaN.
pub(crate) fn arrays_equal(
    py: Python<'_>,
    mine: &[Py<PyAny>],
    theirs: &[Py<PyAny>],
) -> PyResult<bool> {
    let array_equal = py.import("numpy")?.getattr("array_equal")?;
    let with_nan = PyDict::new(py);
    with_nan.set_item("equal_nan", true)?;
    for (mine, theirs) in mine.iter().zip(theirs) {
        if !array_equal
            .call((mine, theirs), Some(&with_nan))?
            .extract::<bool>()?
        {
            return Ok(false);
        }
    }
    Ok(true)
}
