//! What is derived from order parameters, for whole series.

use crate::analysis::OrderParameters;
use crate::error::{FlockError, Result};
use crate::parameters::Target;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// Signed order of a series of (Ψ_o, φ_o).
#[pyfunction]
pub fn signed_order<'py>(
    py: Python<'py>,
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
    target: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let target: Target = target.parse()?;
    let values = each(&psi_o, &phi_o, |order| order.signed_order(target))?;
    Ok(PyArray1::from_vec(py, values))
}

/// Ψ_o·sin φ_o of a series of (Ψ_o, φ_o).
#[pyfunction]
pub fn rotation<'py>(
    py: Python<'py>,
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let values = each(&psi_o, &phi_o, OrderParameters::rotation)?;
    Ok(PyArray1::from_vec(py, values))
}

/// Ψ_o·cos φ_o of a series of (Ψ_o, φ_o).
#[pyfunction]
pub fn outward<'py>(
    py: Python<'py>,
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let values = each(&psi_o, &phi_o, OrderParameters::outward)?;
    Ok(PyArray1::from_vec(py, values))
}

fn each(
    psi_o: &PyReadonlyArray1<'_, f64>,
    phi_o: &PyReadonlyArray1<'_, f64>,
    value: impl Fn(&OrderParameters) -> f64,
) -> Result<Vec<f64>> {
    let (psi_o, phi_o) = (psi_o.as_array(), phi_o.as_array());
    if psi_o.len() != phi_o.len() {
        return Err(FlockError::Shape {
            field: "phi_o",
            found: format!("({},)", phi_o.len()),
            expected: format!("({},), that of psi_o", psi_o.len()),
        });
    }
    let pairs = psi_o.iter().zip(phi_o.iter());
    let series = pairs.map(|(&psi_o, &phi_o)| {
        value(&OrderParameters {
            psi_o,
            phi_o,
            ..OrderParameters::default()
        })
    });
    Ok(series.collect())
}
