//! The table of quantities, and structure computed from recorded poses: arrays (t, n, 3).

use super::arguments::wrong_shape;
use crate::analysis::quantities::{Formula, QUANTITIES, Quantity, quantity};
use crate::analysis::samples::Samples;
use crate::analysis::structure::{self, PairCounts};
use crate::error::FlockError;
use crate::geometry::Pose;
use crate::geometry::lap_frame::orientation;
use crate::parameters::FlockParameters;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray3};
use pyo3::prelude::*;

/// Found and expected pairs in each bin, or two curves of the same lags.
type Pairs<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// An entry of the table: a dictionary with the fields of `flockenv.order.Quantity`.
#[derive(IntoPyObject)]
pub(crate) struct Entry {
    name: &'static str,
    label: &'static str,
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
    source: &'static str,
    range: Option<(f64, f64)>,
    least_boats: usize,
    is_averaged: bool,
    kind: &'static str,
}

impl From<&Quantity> for Entry {
    fn from(each: &Quantity) -> Self {
        Self {
            name: each.name,
            label: each.label,
            symbol: each.symbol,
            unit: each.unit,
            meaning: each.meaning,
            source: each.source,
            range: each.range,
            least_boats: each.least_boats,
            is_averaged: each.is_averaged,
            kind: match each.formula {
                Formula::Recorded(_) => "recorded",
                Formula::Derived(_) => "derived",
                Formula::Structure(_) => "structure",
            },
        }
    }
}

/// The table of quantities.
#[pyfunction]
pub(crate) fn quantities() -> Vec<Entry> {
    QUANTITIES.iter().map(Entry::from).collect()
}

/// A quantity of the kind "structure" at each time.
#[pyfunction]
pub(crate) fn structure_series<'py>(
    py: Python<'py>,
    name: &str,
    parameters: FlockParameters,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let Formula::Structure(formula) = quantity(name)?.formula else {
        let accepted = "a quantity of structure";
        return Err(FlockError::parameter("quantity", format!("{name:?}"), accepted).into());
    };
    let samples = samples(&pose, "pose")?;
    let each = |poses: Vec<Pose>| formula(&poses, &parameters);
    let values: Vec<f64> = py.detach(|| samples.present().map(each).collect());
    Ok(PyArray1::from_vec(py, values))
}

/// How many boats each jam holds, at each time.
#[pyfunction]
pub(crate) fn jam_sizes(
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
pub(crate) fn lap_orientation<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let samples = samples(&pose, "pose")?;
    let angles = samples.rows().iter().map(orientation);
    PyArray1::from_iter(py, angles).reshape(<[usize; 2]>::from(samples.shape()))
}

/// Pairs by distance, over all times.
#[pyfunction]
pub(crate) fn pair_counts<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    edges: PyReadonlyArray1<'py, f64>,
) -> PyResult<Pairs<'py>> {
    let samples = samples(&pose, "pose")?;
    let edges = edges.to_vec()?;
    let rising = edges.windows(2).all(|pair| pair[0] < pair[1]);
    if edges.len() < 2 || !rising || !edges.iter().all(|edge| edge.is_finite()) {
        let accepted = "at least two finite distances in cm, increasing";
        return Err(FlockError::parameter("edges", format!("{edges:?}"), accepted).into());
    }
    let mut counts = PairCounts::new(edges);
    py.detach(|| samples.present().for_each(|poses| counts.add(&poses)));
    Ok((
        PyArray1::from_vec(py, counts.found),
        PyArray1::from_vec(py, counts.expected),
    ))
}

/// Mean-square displacement in cm² and heading correlation after each lag, in samples.
#[pyfunction]
pub(crate) fn lagged_motion<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    lags: Vec<usize>,
) -> PyResult<Pairs<'py>> {
    let samples = samples(&pose, "pose")?;
    let rows: Vec<&[Pose]> = samples.each().collect();
    let squares = |&lag: &usize| structure::mean_square_displacement(&rows, lag);
    let cosines = |&lag: &usize| structure::heading_correlation(&rows, lag);
    let (squares, cosines): (Vec<f64>, Vec<f64>) =
        py.detach(|| lags.iter().map(|lag| (squares(lag), cosines(lag))).unzip());
    Ok((
        PyArray1::from_vec(py, squares),
        PyArray1::from_vec(py, cosines),
    ))
}

/// Poses, or velocities, of an array of shape (t, n, 3).
pub(super) fn samples(array: &PyReadonlyArray3<'_, f64>, name: &str) -> PyResult<Samples> {
    let array = array.as_array();
    let (times, boats, numbers) = array.dim();
    if numbers != 3 || boats == 0 {
        let found = format!("({times}, {boats}, {numbers})");
        return Err(wrong_shape(name, found, "(t, n, 3) of at least one boat"));
    }
    let rows = array.rows().into_iter();
    let rows = rows.map(|row| Pose::new(row[0], row[1], row[2]));
    Ok(Samples::new(rows.collect(), boats))
}
