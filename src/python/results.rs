//! What a flock reports, as the dataclasses of the Python package.

use crate::contact::Partner;
use crate::flock::ContactForce;
use crate::order_parameters::OrderParameters;
use crate::statistics::Statistics;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A `flockenv.OrderParameters`.
pub fn order_parameters<'py>(
    py: Python<'py>,
    order: &OrderParameters,
) -> PyResult<Bound<'py, PyAny>> {
    let OrderParameters {
        psi_o,
        phi_o,
        c_o,
        psi_v,
        phi_v,
        c_v,
    } = *order;
    let class = py
        .import("flockenv.order_parameters")?
        .getattr("OrderParameters")?;
    class.call1((psi_o, phi_o, c_o, psi_v, phi_v, c_v))
}

/// A `flockenv.OrderSeries` of order parameters one after another.
pub fn order_series<'py>(
    py: Python<'py>,
    series: &[OrderParameters],
) -> PyResult<Bound<'py, PyAny>> {
    let class = py
        .import("flockenv.order_parameters")?
        .getattr("OrderSeries")?;
    let column = |value: fn(&OrderParameters) -> f64| {
        PyArray1::from_vec(py, series.iter().map(value).collect())
    };
    class.call1((
        column(|order| order.psi_o),
        column(|order| order.phi_o),
        column(|order| order.c_o),
        column(|order| order.psi_v),
        column(|order| order.phi_v),
        column(|order| order.c_v),
    ))
}

/// A `flockenv.Contacts`; walls are numbered −1 (outer) and −2 (inner).
pub fn contacts<'py>(py: Python<'py>, contacts: &[ContactForce]) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("flockenv.contacts")?.getattr("Contacts")?;
    let partner = |contact: &ContactForce| match contact.contact.partner {
        Partner::Boat(boat) => i64::from(boat),
        Partner::OuterWall => -1,
        Partner::InnerWall => -2,
    };
    let normals = contacts.iter().map(|c| c.contact.gap.normal);
    let normals: Vec<f64> = normals.flat_map(|normal| [normal.x, normal.y]).collect();
    let each = contacts.iter();
    class.call1((
        PyArray1::from_vec(
            py,
            each.clone().map(|c| i64::from(c.contact.boat)).collect(),
        ),
        PyArray1::from_vec(py, each.clone().map(partner).collect()),
        PyArray1::from_vec(py, each.clone().map(|c| c.contact.gap.gap).collect()),
        PyArray1::from_vec(py, normals).reshape([contacts.len(), 2])?,
        PyArray1::from_vec(py, each.map(|c| c.force).collect()),
    ))
}

macro_rules! statistics_fields {
    ($($name:ident)+) => {
        /// A `flockenv.Statistics`.
        pub fn statistics<'py>(
            py: Python<'py>,
            statistics: &Statistics,
        ) -> PyResult<Bound<'py, PyAny>> {
            let Statistics { $($name),+ } = *statistics;
            let fields = PyDict::new(py);
            $(fields.set_item(stringify!($name), $name)?;)+
            let class = py.import("flockenv.statistics")?.getattr("Statistics")?;
            class.call((), Some(&fields))
        }
    };
}

statistics_fields! {
    substeps solves contacts islands solver_iterations factored_rows most_factor_entries unsolved
    recovery_passes neighbor_builds worst_residual_cm_s worst_overlap_cm
}
