//! What is derived from order parameters, for whole series.

use crate::order_parameters::OrderParameters;
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
    Ok(each(py, &psi_o, &phi_o, |order| order.signed_order(target)))
}

/// Ψ_o·sin φ_o of a series of (Ψ_o, φ_o).
#[pyfunction]
pub fn rotation<'py>(
    py: Python<'py>,
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
) -> Bound<'py, PyArray1<f64>> {
    each(py, &psi_o, &phi_o, OrderParameters::rotation)
}

fn each<'py>(
    py: Python<'py>,
    psi_o: &PyReadonlyArray1<'py, f64>,
    phi_o: &PyReadonlyArray1<'py, f64>,
    value: impl Fn(&OrderParameters) -> f64,
) -> Bound<'py, PyArray1<f64>> {
    let (psi_o, phi_o) = (psi_o.as_array(), phi_o.as_array());
    let pairs = psi_o.iter().zip(phi_o.iter());
    PyArray1::from_iter(
        py,
        pairs.map(|(&psi_o, &phi_o)| {
            value(&OrderParameters {
                psi_o,
                phi_o,
                ..OrderParameters::default()
            })
        }),
    )
}
