//! States of flocks as dictionaries and arrays, and requests of episodes that start in them.

use super::arguments::{Texts, floats, real, text, texts, truth, whole, wrong_type};
use crate::environment::{ResetRequest, Start, TargetChoice};
use crate::error::FlockError;
use crate::flock::State;
use crate::geometry::{Pose, Velocity};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// {"pose": (n, 3), "velocity": (n, 3), "time_s": float, "allow_overlap": bool}; the pose alone will do.
pub(crate) fn state_from(value: &Bound<'_, PyAny>, boats: usize) -> PyResult<State> {
    let accepted = "a dictionary with pose and, if need be, velocity, time_s and allow_overlap";
    let state = value.cast::<PyDict>();
    let state = state.map_err(|_| wrong_type(value, "state", accepted))?;
    let mut pose = None;
    let mut velocity = vec![0.0; 3 * boats];
    let (mut time_s, mut allow_overlap) = (0.0, false);
    for (name, value) in state {
        match text(&name, "state")?.as_str() {
            "pose" => pose = Some(floats(&value, "pose", &[boats, 3])?),
            "velocity" => velocity = floats(&value, "velocity", &[boats, 3])?,
            "time_s" => time_s = real(&value, "time_s")?,
            "allow_overlap" => allow_overlap = truth(&value, "allow_overlap")?,
            other => {
                return Err(FlockError::parameter("state", format!("{other:?}"), accepted).into());
            }
        }
    }
    let Some(pose) = pose else {
        return Err(FlockError::parameter("state", "without pose", accepted).into());
    };
    Ok(State {
        poses: poses_of(&pose),
        velocities: velocities_of(&velocity),
        time_s,
        allow_overlap,
    })
}

/// Poses of the numbers in an array (n, 3).
pub(crate) fn poses_of(numbers: &[f64]) -> Vec<Pose> {
    let rows = numbers.as_chunks::<3>().0.iter();
    rows.map(|&[x, y, a]| Pose::new(x, y, a)).collect()
}

/// Velocities of the numbers in an array (n, 3).
pub(crate) fn velocities_of(numbers: &[f64]) -> Vec<Velocity> {
    let rows = numbers.as_chunks::<3>().0.iter();
    rows.map(|&[x, y, w]| Velocity::new(x, y, w)).collect()
}

/// Rows of three numbers as an array (n, 3).
pub(crate) fn rows_of_three(
    py: Python<'_>,
    rows: impl Iterator<Item = [f64; 3]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let numbers: Vec<f64> = rows.flatten().collect();
    let count = numbers.len() / 3;
    PyArray1::from_vec(py, numbers).reshape([count, 3])
}

/// A request of a flock of so many boats.
pub(crate) fn request_from(options: &Bound<'_, PyDict>, boats: usize) -> PyResult<ResetRequest> {
    let mut request = ResetRequest::default();
    for (name, value) in options {
        match text(&name, "reset option")?.as_str() {
            "seed" if value.is_none() => request.seed = None,
            "seed" => request.seed = Some(whole(&value, "seed")?),
            "target" => request.target = Some(target_choice(&value)?),
            "bw_s" => request.bw_s = Some(real(&value, "bw_s")?),
            "state" => request.start = Start::State(state_from(&value, boats)?),
            "snapshot" => request.start = snapshot_from(&value)?,
            other => {
                let accepted = "target, bw_s, state or snapshot";
                let found = format!("{other:?}");
                return Err(FlockError::parameter("reset option", found, accepted).into());
            }
        }
    }
    let starts_twice = options.contains("state")? && options.contains("snapshot")?;
    let noise_twice = options.contains("bw_s")? && options.contains("snapshot")?;
    if starts_twice || noise_twice {
        let accepted = "a snapshot alone: it brings its own state and bw_s along";
        return Err(FlockError::parameter("reset options", "snapshot and others", accepted).into());
    }
    Ok(request)
}

fn target_choice(value: &Bound<'_, PyAny>) -> PyResult<TargetChoice> {
    Ok(match texts(value, "target")? {
        Texts::One(name) => TargetChoice::named(&name)?,
        Texts::Each(names) => TargetChoice::each(&names)?,
    })
}

fn snapshot_from(value: &Bound<'_, PyAny>) -> PyResult<Start> {
    let bytes = value.cast::<PyBytes>();
    let bytes = bytes.map_err(|_| wrong_type(value, "snapshot", "bytes of Flock.snapshot"))?;
    Ok(Start::Snapshot(bytes.as_bytes().to_vec()))
}
