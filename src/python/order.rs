//! Recorded quantities at many times, and what follows from them.

use super::arguments::{same_length, targets, wrong_shape};
use super::quantities::samples;
use crate::analysis::OrderParameters;
use crate::analysis::collective_state::{CollectiveState, ordering_time};
use crate::analysis::quantities::{Formula, QUANTITIES, RECORDED, Recorded, quantity};
use crate::error::FlockError;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Columns of the table's recorded quantities, by name: arrays (t,).
pub(super) fn columns<'py>(py: Python<'py>, series: &[Recorded]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for (place, each) in QUANTITIES[..RECORDED].iter().enumerate() {
        let values = series.iter().map(|values| values[place]);
        columns.set_item(each.name, PyArray1::from_iter(py, values))?;
    }
    Ok(columns)
}

/// The recorded quantities of boats at each time, of poses and velocities of shape (t, n, 3). Rows of NaN stand for
/// boats that are not there; quantities of too few boats are NaN.
#[pyfunction]
pub(crate) fn order_columns<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    velocity: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (poses, velocities) = (samples(&pose, "pose")?, samples(&velocity, "velocity")?);
    if poses.shape() != velocities.shape() {
        let text = |(times, boats): (usize, usize)| format!("({times}, {boats}, 3)");
        let expected = format!("{}, that of pose", text(poses.shape()));
        return Err(wrong_shape("velocity", text(velocities.shape()), &expected));
    }
    columns(py, &poses.recorded(&velocities)?)
}

/// The columns that derived quantities and states follow from.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Orders<'py> {
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
    psi_v: PyReadonlyArray1<'py, f64>,
}

impl Orders<'_> {
    fn rows(&self) -> PyResult<Vec<OrderParameters>> {
        let (psi_o, phi_o) = (self.psi_o.as_array(), self.phi_o.as_array());
        let psi_v = self.psi_v.as_array();
        same_length("phi_o", phi_o.len(), psi_o.len())?;
        same_length("psi_v", psi_v.len(), psi_o.len())?;
        let row = |((&psi_o, &phi_o), &psi_v)| OrderParameters {
            psi_o,
            phi_o,
            psi_v,
            ..OrderParameters::default()
        };
        Ok(psi_o.iter().zip(phi_o).zip(psi_v).map(row).collect())
    }
}

/// A derived quantity at each time.
#[pyfunction]
pub(crate) fn derived_series<'py>(
    py: Python<'py>,
    name: &str,
    orders: Orders<'py>,
    target: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let Formula::Derived(formula) = quantity(name)?.formula else {
        let accepted = "a derived quantity";
        return Err(FlockError::parameter("quantity", format!("{name:?}"), accepted).into());
    };
    let target = targets(target)?.reference();
    let values = orders.rows()?.into_iter();
    Ok(PyArray1::from_iter(
        py,
        values.map(|order| formula(&order, target)),
    ))
}

/// The place of the collective state at each time among `collective_state_names`.
#[pyfunction]
pub(crate) fn collective_states<'py>(
    py: Python<'py>,
    orders: Orders<'py>,
    speed_cm_s: f64,
    largest_cluster: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let (orders, clusters) = (orders.rows()?, largest_cluster.to_vec()?);
    same_length("largest_cluster", clusters.len(), orders.len())?;
    let places = orders.iter().zip(clusters);
    let places = places.map(|(order, share)| CollectiveState::of(order, speed_cm_s, share) as i64);
    Ok(PyArray1::from_iter(py, places))
}

/// Names of the collective states (Table 2; ordered motion by its direction).
#[pyfunction]
pub(crate) fn collective_state_names() -> Vec<&'static str> {
    let states = CollectiveState::ALL.iter();
    states.map(|state| state.name()).collect()
}

/// Ordering time τ of a run, eq. (7), in s; infinite if the run does not order.
#[pyfunction]
pub(crate) fn ordering_time_s(
    orders: Orders<'_>,
    time_s: PyReadonlyArray1<'_, f64>,
    within: f64,
) -> PyResult<f64> {
    let (orders, times) = (orders.rows()?, time_s.to_vec()?);
    same_length("time_s", times.len(), orders.len())?;
    Ok(ordering_time(&times, &orders, within))
}
