//! Structure of recorded flocks: poses come as (t, n, 3) arrays.

use crate::analysis::structure::{self, PairCounts};
use crate::error::FlockError;
use crate::geometry::lap_frame::orientation;
use crate::geometry::{Pose, Velocity};
use crate::parameters::FlockParameters;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray3};
use pyo3::prelude::*;

/// Found and expected pairs in each bin.
type Pairs<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Part of the boats in the largest cluster, at each time.
#[pyfunction]
pub(crate) fn largest_cluster<'py>(
    py: Python<'py>,
    parameters: FlockParameters,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let samples = Samples::read(&pose, "pose")?;
    let share = |poses: Vec<Pose>| structure::largest_cluster(&poses, &parameters);
    let shares: Vec<f64> = py.detach(|| samples.present().map(share).collect());
    Ok(PyArray1::from_vec(py, shares))
}

/// How many boats each jam holds, at each time.
#[pyfunction]
pub(crate) fn jam_sizes(
    py: Python<'_>,
    parameters: FlockParameters,
    pose: PyReadonlyArray3<'_, f64>,
) -> PyResult<Vec<Vec<usize>>> {
    let samples = Samples::read(&pose, "pose")?;
    let sizes = |poses: Vec<Pose>| structure::jam_sizes(&poses, &parameters);
    Ok(py.detach(|| samples.present().map(sizes).collect()))
}

/// Part of the boats on the outer wall, at each time.
#[pyfunction]
pub(crate) fn on_outer_wall<'py>(
    py: Python<'py>,
    parameters: FlockParameters,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let samples = Samples::read(&pose, "pose")?;
    let shares = samples.present();
    let shares = shares.map(|poses| structure::on_outer_wall(&poses, &parameters));
    Ok(PyArray1::from_iter(py, shares))
}

/// Length of the mean heading in the axes of the world, at each time.
#[pyfunction]
pub(crate) fn polarization<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let samples = Samples::read(&pose, "pose")?;
    let lengths = samples
        .present()
        .map(|poses| structure::polarization(&poses));
    Ok(PyArray1::from_iter(py, lengths))
}

/// LAP orientation φ of each boat at each time, in (-π, π].
#[pyfunction]
pub(crate) fn lap_orientation<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let samples = Samples::read(&pose, "pose")?;
    let angles = samples.poses.iter().map(orientation).collect();
    PyArray1::from_vec(py, angles).reshape([samples.poses.len() / samples.boats, samples.boats])
}

/// Pairs by distance, over all times.
#[pyfunction]
pub(crate) fn pair_counts<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    edges: PyReadonlyArray1<'py, f64>,
) -> PyResult<Pairs<'py>> {
    let samples = Samples::read(&pose, "pose")?;
    let edges = edges.to_vec()?;
    let rising = edges.windows(2).all(|pair| pair[0] < pair[1]);
    if edges.len() < 2 || !rising || !edges.iter().all(|edge| edge.is_finite()) {
        let accepted = "at least two finite distances in cm, increasing";
        return Err(FlockError::parameter("edges", format!("{edges:?}"), accepted).into());
    }
    let counts = py.detach(|| {
        let mut counts = PairCounts::new(edges);
        samples.present().for_each(|poses| counts.add(&poses));
        counts
    });
    let (found, expected) = (counts.found, counts.expected);
    Ok((
        PyArray1::from_vec(py, found),
        PyArray1::from_vec(py, expected),
    ))
}

/// Mean-square displacement in cm² and heading correlation after each lag, in samples.
#[pyfunction]
pub(crate) fn lagged_motion<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    lags: Vec<usize>,
) -> PyResult<Pairs<'py>> {
    let samples = Samples::read(&pose, "pose")?;
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

/// Poses, or velocities, sample after sample.
pub(crate) struct Samples {
    poses: Vec<Pose>,
    boats: usize,
}

impl Samples {
    /// Of an array of shape (t, n, 3).
    pub(crate) fn read(array: &PyReadonlyArray3<'_, f64>, name: &'static str) -> PyResult<Self> {
        let array = array.as_array();
        let (times, boats, numbers) = array.dim();
        if numbers != 3 || boats == 0 {
            return Err(FlockError::Shape {
                field: name,
                found: format!("({times}, {boats}, {numbers})"),
                expected: "(t, n, 3) of at least one boat".to_owned(),
            }
            .into());
        }
        let rows = array.rows();
        let poses = rows
            .into_iter()
            .map(|row| Pose::new(row[0], row[1], row[2]));
        Ok(Self {
            poses: poses.collect(),
            boats,
        })
    }

    /// Refuses velocities of other times or boats than the poses.
    pub(crate) fn check_same_shape(&self, velocities: &Self) -> PyResult<()> {
        let shape = |samples: &Self| (samples.poses.len() / samples.boats, samples.boats, 3);
        if shape(self) == shape(velocities) {
            return Ok(());
        }
        Err(FlockError::Shape {
            field: "velocity",
            found: format!("{:?}", shape(velocities)),
            expected: format!("{:?}, that of pose", shape(self)),
        }
        .into())
    }

    /// The boats that are there, one sample after another: rows of NaN stand for those that are not.
    fn present(&self) -> impl Iterator<Item = Vec<Pose>> {
        self.each().map(|poses| {
            poses
                .iter()
                .filter(|pose| is_there(pose))
                .copied()
                .collect()
        })
    }

    /// The poses and velocities of the boats that have both, one sample after another.
    pub(crate) fn present_with<'a>(
        &'a self,
        motions: &'a Self,
    ) -> impl Iterator<Item = (Vec<Pose>, Vec<Velocity>)> + 'a {
        self.each().zip(motions.each()).map(|(poses, motions)| {
            let both = poses.iter().zip(motions);
            both.filter(|(pose, motion)| is_there(pose) && is_there(motion))
                .map(|(pose, row)| {
                    let motion = Velocity::new(row.position.x, row.position.y, row.heading);
                    (*pose, motion)
                })
                .unzip()
        })
    }

    /// One sample after another.
    fn each(&self) -> impl Iterator<Item = &[Pose]> {
        self.poses.chunks_exact(self.boats)
    }
}

fn is_there(row: &Pose) -> bool {
    row.position.iter().all(|number| number.is_finite()) && row.heading.is_finite()
}
