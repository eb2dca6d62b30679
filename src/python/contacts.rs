//! Contacts as columns: arrays of one value or vector per contact.

use super::arguments::same_length;
use super::state::poses_of;
use crate::contact::{Partner, along_core};
use crate::flock::ContactForce;
use crate::geometry::{HullPose, Vec2};
use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Contacts by column: i, j, gap_cm, normal, force and point_cm, in the precision that a flock or a recording has.
pub(super) fn columns<'py, I: Element + From<i32>, T: Element>(
    py: Python<'py>,
    contacts: &[ContactForce],
    rounded: fn(f64) -> T,
) -> PyResult<Bound<'py, PyDict>> {
    let numbers = |value: fn(&ContactForce) -> f64| {
        PyArray1::from_iter(py, contacts.iter().map(value).map(rounded))
    };
    let boats = |boat: fn(&ContactForce) -> i32| {
        PyArray1::from_iter(py, contacts.iter().map(boat).map(I::from))
    };
    let vectors = |vector: fn(&ContactForce) -> Vec2| {
        let each = contacts.iter().map(vector).flat_map(|v| [v.x, v.y]);
        PyArray1::from_iter(py, each.map(rounded)).reshape([contacts.len(), 2])
    };
    let columns = PyDict::new(py);
    columns.set_item("i", boats(|each| each.contact.boat as i32))?;
    columns.set_item("j", boats(partner))?;
    columns.set_item("gap_cm", numbers(|each| each.contact.gap.gap))?;
    columns.set_item("normal", vectors(|each| each.contact.gap.normal)?)?;
    columns.set_item("force", numbers(|each| each.force))?;
    columns.set_item("point_cm", vectors(|each| each.point)?)?;
    Ok(columns)
}

/// Walls are numbered −1 (outer) and −2 (inner), obstacles from −3 downwards.
fn partner(contact: &ContactForce) -> i32 {
    match contact.contact.partner {
        Partner::Boat(boat) => boat as i32,
        Partner::OuterWall => -1,
        Partner::InnerWall => -2,
        Partner::Obstacle(number) => -3 - number as i32,
    }
}

/// Where along the cores of hulls recorded contacts push, from their centers to the bows, in cm: of the pushed
/// boats' poses (c, 3), the normals and points (c, 2) of a `ContactSeries`, and the hulls' radius.
#[pyfunction]
pub(crate) fn contact_along_cm<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray2<'py, f64>,
    normal: PyReadonlyArray2<'py, f32>,
    point_cm: PyReadonlyArray2<'py, f32>,
    radius_cm: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let poses = poses_of(&pose.to_vec()?);
    let (normals, points) = (vectors_of(&normal)?, vectors_of(&point_cm)?);
    same_length("normal", normals.len(), poses.len())?;
    same_length("point_cm", points.len(), poses.len())?;
    let each = poses.iter().zip(normals).zip(points);
    let along = each
        .map(|((pose, normal), point)| along_core(&HullPose::new(pose), normal, point, radius_cm));
    Ok(PyArray1::from_iter(py, along))
}

fn vectors_of(array: &PyReadonlyArray2<'_, f32>) -> PyResult<Vec<Vec2>> {
    let numbers = array.to_vec()?;
    let vectors = numbers.as_chunks::<2>().0.iter();
    Ok(vectors
        .map(|&[x, y]| Vec2::new(x.into(), y.into()))
        .collect())
}
