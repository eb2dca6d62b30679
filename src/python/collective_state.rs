//! Collective states and ordering times of whole series.

use super::arguments::real;
use crate::analysis::OrderParameters;
use crate::analysis::collective_state::{
    CollectiveState, off_tangent, ordering_time as ordering_time_of,
};
use crate::error::FlockError;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

/// Names of the states; `collective_states` gives places in this list.
#[pyfunction]
pub fn collective_state_names() -> Vec<&'static str> {
    let states = CollectiveState::ALL.iter();
    states.map(|state| state.name()).collect()
}

/// The state at each time of a series.
#[pyfunction]
pub fn collective_states<'py>(
    py: Python<'py>,
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
    psi_v: PyReadonlyArray1<'py, f64>,
    largest_cluster: PyReadonlyArray1<'py, f64>,
    speed_cm_s: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let speed = real(speed_cm_s, "speed_cm_s")?;
    let series = orders(&psi_o, &phi_o, Some(&psi_v))?;
    let clusters = largest_cluster.as_array();
    same_length("largest_cluster", clusters.len(), series.len())?;
    let states = series.iter().zip(clusters);
    Ok(PyArray1::from_iter(
        py,
        states.map(|(order, &cluster)| CollectiveState::of(order, speed, cluster) as u8),
    ))
}

/// ||φ_o| − π/2| at each time of a series.
#[pyfunction(name = "off_tangent")]
pub fn off_tangents<'py>(
    py: Python<'py>,
    phi_o: PyReadonlyArray1<'py, f64>,
) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_iter(py, phi_o.as_array().iter().map(|&phi| off_tangent(phi)))
}

/// The ordering time of a run, eq. (7) with the angle `within`; infinite if it does not order.
#[pyfunction]
pub fn ordering_time<'py>(
    time_s: PyReadonlyArray1<'py, f64>,
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
    within: &Bound<'py, PyAny>,
) -> PyResult<f64> {
    let within = real(within, "within")?;
    let series = orders(&psi_o, &phi_o, None)?;
    let times = time_s.to_vec()?;
    same_length("time_s", times.len(), series.len())?;
    Ok(ordering_time_of(&times, &series, within))
}

fn orders(
    psi_o: &PyReadonlyArray1<'_, f64>,
    phi_o: &PyReadonlyArray1<'_, f64>,
    psi_v: Option<&PyReadonlyArray1<'_, f64>>,
) -> PyResult<Vec<OrderParameters>> {
    let (psi_o, phi_o) = (psi_o.as_array(), phi_o.as_array());
    same_length("phi_o", phi_o.len(), psi_o.len())?;
    let speeds = match psi_v {
        Some(speeds) => speeds.as_array().to_vec(),
        None => vec![0.0; psi_o.len()],
    };
    same_length("psi_v", speeds.len(), psi_o.len())?;
    let rows = psi_o.iter().zip(phi_o).zip(speeds);
    Ok(rows
        .map(|((&psi_o, &phi_o), psi_v)| OrderParameters {
            psi_o,
            phi_o,
            psi_v,
            ..OrderParameters::default()
        })
        .collect())
}

fn same_length(field: &'static str, found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(FlockError::Shape {
        field,
        found: format!("({found},)"),
        expected: format!("({expected},)"),
    }
    .into())
}
