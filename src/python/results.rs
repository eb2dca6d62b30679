//! What a flock reports, as the dataclasses of the Python package.

use crate::analysis::OrderParameters;
use crate::contact::{Partner, Statistics};
use crate::flock::{ContactForce, ContactSamples};
use crate::geometry::Vec2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
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
    let class = py.import("flockenv.flock")?.getattr("OrderParameters")?;
    class.call1((psi_o, phi_o, c_o, psi_v, phi_v, c_v))
}

/// A `flockenv.OrderSeries` of order parameters one after another.
pub fn order_series<'py>(
    py: Python<'py>,
    series: &[OrderParameters],
) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("flockenv.flock")?.getattr("OrderSeries")?;
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
    let class = py.import("flockenv.flock")?.getattr("Contacts")?;
    let each = contacts.iter();
    class.call1((
        PyArray1::from_iter(py, each.clone().map(|c| i64::from(c.contact.boat))),
        PyArray1::from_iter(py, each.clone().map(|c| i64::from(partner(c)))),
        PyArray1::from_iter(py, each.clone().map(|c| c.contact.gap.gap)),
        pairs(py, contacts, |c| c.contact.gap.normal, |x| x)?,
        PyArray1::from_iter(py, each.map(|c| c.force)),
        pairs(py, contacts, |c| c.point, |x| x)?,
    ))
}

/// A `flockenv.ContactSeries`.
pub fn contact_series<'py>(
    py: Python<'py>,
    samples: &ContactSamples,
) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("flockenv.flock")?.getattr("ContactSeries")?;
    let contacts = &samples.contacts[..];
    let each = contacts.iter();
    class.call1((
        PyArray1::from_iter(py, samples.count.iter().map(|&count| count as i64)),
        PyArray1::from_iter(py, each.clone().map(|c| c.contact.boat as i32)),
        PyArray1::from_iter(py, each.clone().map(partner)),
        pairs(py, contacts, |c| c.contact.gap.normal, |x| x as f32)?,
        PyArray1::from_iter(py, each.map(|c| c.force as f32)),
        pairs(py, contacts, |c| c.point, |x| x as f32)?,
    ))
}

fn partner(contact: &ContactForce) -> i32 {
    match contact.contact.partner {
        Partner::Boat(boat) => boat as i32,
        Partner::OuterWall => -1,
        Partner::InnerWall => -2,
    }
}

/// One vector a contact: (c, 2).
fn pairs<'py, T: Element>(
    py: Python<'py>,
    contacts: &[ContactForce],
    vector: fn(&ContactForce) -> Vec2,
    rounded: fn(f64) -> T,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let vectors = contacts.iter().map(vector);
    let numbers: Vec<T> = vectors.flat_map(|v| [v.x, v.y]).map(rounded).collect();
    PyArray1::from_vec(py, numbers).reshape([contacts.len(), 2])
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
            let class = py.import("flockenv.flock")?.getattr("Statistics")?;
            class.call((), Some(&fields))
        }
    };
}

statistics_fields! {
    substeps solves contacts islands solver_iterations factored_rows most_factor_entries unsolved
    depenetration_passes neighbor_builds worst_residual_cm_s worst_overlap_cm
}
