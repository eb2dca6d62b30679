//! Quantities at many times: recorded, derived, and those of structure, from poses (t, n, 3).

use super::arrays::{check_length, rows_of, wrong_shape};
use super::value::argument;
use crate::analysis::OrderParameters;
use crate::analysis::collective_state::{CollectiveState, ordering_time};
use crate::analysis::quantities::{Formula, QUANTITIES, RECORDED, Recorded, quantity};
use crate::analysis::samples::Samples;
use crate::analysis::structure;
use crate::error::FlockError;
use crate::geometry::Pose;
use crate::geometry::lap_frame::orientation;
use crate::integrator::Phase;
use crate::parameters::{FlockParameters, Targets};
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An array (t,) with a number at each time.
type Series<'py> = PyResult<Bound<'py, PyArray1<f64>>>;

/// The recorded quantities as columns by name, each an array (t,).
pub(super) fn columns<'py>(py: Python<'py>, series: &[Recorded]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for (index, quantity) in QUANTITIES[..RECORDED].iter().enumerate() {
        let values = series.iter().map(|values| values[index]);
        columns.set_item(quantity.name, PyArray1::from_iter(py, values))?;
    }
    Ok(columns)
}

/// The recorded quantities of boats at each time, from poses and velocities of shape (t, n, 3). Rows of NaN stand for
/// missing boats. A quantity is NaN at times with fewer boats than it needs.
#[pyfunction]
pub(super) fn order_columns<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    velocity: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (poses, velocities) = (samples(&pose, "pose")?, samples(&velocity, "velocity")?);
    if velocities.shape() != poses.shape() {
        let ((times, boats), (velocity_times, velocity_boats)) =
            (poses.shape(), velocities.shape());
        let expected = format!("({times}, {boats}, 3), as pose has");
        let shape = [velocity_times, velocity_boats, 3];
        return Err(wrong_shape("velocity", &shape, &expected));
    }
    columns(py, &poses.recorded(&velocities)?)
}

/// The columns from which derived quantities and collective states are computed.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Orders<'py> {
    psi_o: PyReadonlyArray1<'py, f64>,
    phi_o: PyReadonlyArray1<'py, f64>,
    psi_v: PyReadonlyArray1<'py, f64>,
}

impl Orders<'_> {
    /// The columns as order parameters at each time. Order parameters without a column are 0.
    fn rows(&self) -> PyResult<Vec<OrderParameters>> {
        let (psi_o, phi_o) = (self.psi_o.as_array(), self.phi_o.as_array());
        let psi_v = self.psi_v.as_array();
        check_length("phi_o", phi_o.len(), psi_o.len())?;
        check_length("psi_v", psi_v.len(), psi_o.len())?;
        let row = |((&psi_o, &phi_o), &psi_v)| OrderParameters {
            psi_o,
            phi_o,
            psi_v,
            ..OrderParameters::default()
        };
        Ok(psi_o.iter().zip(phi_o).zip(psi_v).map(row).collect())
    }
}

/// The error for a quantity whose formula takes other arguments.
fn wrong_formula(name: &str, accepted: &str) -> PyErr {
    FlockError::parameter("quantity", format!("{name:?}"), accepted).into()
}

/// A derived quantity at each time.
#[pyfunction]
pub(super) fn derived_series<'py>(
    py: Python<'py>,
    name: &str,
    orders: Orders<'py>,
    target: &Bound<'py, PyAny>,
) -> Series<'py> {
    let Formula::Derived(formula) = quantity(name)?.formula else {
        return Err(wrong_formula(name, "a derived quantity"));
    };
    let targets: Targets = argument(target, "target")?;
    let accepted = "\"cw\", \"ccw\", or a list with one of them per leader";
    let has_target = targets != Targets::Each(Vec::new());
    FlockError::unless(has_target, "target", &targets, accepted)?;
    let target = targets.reference();
    let orders = orders.rows()?.into_iter();
    let values = orders.map(|order| formula(&order, target));
    Ok(PyArray1::from_iter(py, values))
}

/// A quantity of the kind "structure" at each time.
#[pyfunction]
pub(super) fn structure_series<'py>(
    py: Python<'py>,
    name: &str,
    parameters: FlockParameters,
    pose: PyReadonlyArray3<'py, f64>,
) -> Series<'py> {
    let Formula::Structure(formula) = quantity(name)?.formula else {
        return Err(wrong_formula(name, "a quantity of structure"));
    };
    let samples = samples(&pose, "pose")?;
    let measure = |poses: Vec<Pose>| formula(&poses, &parameters);
    let values: Vec<f64> = py.detach(|| samples.present().map(measure).collect());
    Ok(PyArray1::from_vec(py, values))
}

/// The collective state at each time, as an index of `COLLECTIVE_STATES`. `largest_cluster` holds fractions of the boats.
#[pyfunction]
pub(super) fn collective_states<'py>(
    py: Python<'py>,
    orders: Orders<'py>,
    speed_cm_s: f64,
    largest_cluster: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let (orders, clusters) = (orders.rows()?, largest_cluster.to_vec()?);
    check_length("largest_cluster", clusters.len(), orders.len())?;
    let times = orders.iter().zip(clusters);
    let states = times.map(|(order, largest_cluster)| {
        CollectiveState::from_order(order, speed_cm_s, largest_cluster) as i64
    });
    Ok(PyArray1::from_iter(py, states))
}

/// Ordering time τ of a run, eq. (7), in s; infinite if the run does not order. `within` is the angle in rad off the
/// tangent below which an orientation counts as tangential.
#[pyfunction]
pub(super) fn ordering_time_s(
    orders: Orders<'_>,
    time_s: PyReadonlyArray1<'_, f64>,
    within: f64,
) -> PyResult<f64> {
    let (orders, times) = (orders.rows()?, time_s.to_vec()?);
    check_length("time_s", times.len(), orders.len())?;
    Ok(ordering_time(&times, &orders, within))
}

/// Whether each time lies in the analysis window, from the times in s and the names of the phases at these times, both
/// of shape (t,).
#[pyfunction]
pub(super) fn sampled_analysis_window<'py>(
    py: Python<'py>,
    time_s: PyReadonlyArray1<'py, f64>,
    phase: Vec<String>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let times = time_s.to_vec()?;
    check_length("phase", phase.len(), times.len())?;
    let phases = phase.iter().map(|name| name.parse::<Phase>());
    let phases = phases.collect::<Result<Vec<_>, _>>()?;
    let analyzed = crate::integrator::sampled_analysis_window(&times, &phases);
    Ok(PyArray1::from_vec(py, analyzed))
}

/// Sizes of the jams at each time.
#[pyfunction]
pub(super) fn jam_sizes(
    py: Python<'_>,
    parameters: FlockParameters,
    pose: PyReadonlyArray3<'_, f64>,
) -> PyResult<Vec<Vec<usize>>> {
    let samples = samples(&pose, "pose")?;
    let sizes = |poses: Vec<Pose>| structure::jam_sizes(&poses, &parameters);
    Ok(py.detach(|| samples.present().map(sizes).collect()))
}

/// LAP orientation φ of each boat at each time, in (-π, π].
#[pyfunction]
pub(super) fn lap_orientation<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let samples = samples(&pose, "pose")?;
    let angles = samples.rows().iter().map(orientation);
    rows_of(py, angles.collect(), samples.shape().1)
}

/// Velocities (t·n, 3) of tracked boats, and the number of steps faster than `fastest_cm_s`. These steps, and steps
/// longer than `longest_s`, are left out. Times have shape (t, n).
#[pyfunction]
pub(super) fn track_velocities<'py>(
    py: Python<'py>,
    time_s: PyReadonlyArray2<'py, f64>,
    pose: PyReadonlyArray3<'py, f64>,
    longest_s: f64,
    fastest_cm_s: f64,
) -> PyResult<(Bound<'py, PyArray2<f64>>, usize)> {
    let (times, samples) = (time_s.as_slice()?, samples(&pose, "pose")?);
    check_length("time_s", times.len(), samples.rows().len())?;
    let (velocities, too_fast) = samples.velocities(times, longest_s, fastest_cm_s);
    let rows = velocities.rows().iter();
    let numbers = rows.flat_map(|row| [row.position.x, row.position.y, row.heading]);
    Ok((rows_of(py, numbers.collect(), 3)?, too_fast))
}

/// Poses or velocities from an array of shape (t, n, 3).
fn samples(array: &PyReadonlyArray3<'_, f64>, name: &str) -> PyResult<Samples> {
    let array = array.as_array();
    let (times, boats, numbers) = array.dim();
    if numbers != 3 || boats == 0 {
        let expected = "(t, n, 3) of at least one boat";
        return Err(wrong_shape(name, &[times, boats, numbers], expected));
    }
    let rows = array.rows().into_iter();
    let rows = rows.map(|row| Pose::new(row[0], row[1], row[2]));
    Ok(Samples::new(rows.collect(), boats))
}
