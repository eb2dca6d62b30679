//! `flockenv.Contacts` and `flockenv.ContactSeries`: columns of one value or vector per contact.

use super::arguments::same_length;
use super::result::{arrays_equal, repr_of};
use super::state::poses_of;
use crate::contact::{Partner, along_core};
use crate::flock::{ContactForce, ContactSamples};
use crate::geometry::{HullPose, Vec2};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};

/// A class of columns, which are its arguments and attributes in this order.
macro_rules! columns {
    (
        $(#[$meta:meta])*
        pub struct $class:ident { $($column:ident),+ $(,)? }

        named $name:literal;
        $($method:item)*
    ) => {
        $(#[$meta])*
        pub struct $class {
            $($column: Py<PyAny>,)+
        }

        impl $class {
            fn columns(&self) -> Vec<(&'static str, &Py<PyAny>)> {
                vec![$((stringify!($column), &self.$column)),+]
            }
        }

        #[pymethods]
        impl $class {
            #[new]
            fn new($($column: Py<PyAny>),+) -> Self {
                Self { $($column),+ }
            }

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                repr_of(py, $name, self.columns().into_iter())
            }

            fn __reduce__<'py>(
                slf: &Bound<'py, Self>,
            ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
                let columns = slf.get().columns().into_iter().map(|(_, column)| column);
                let columns = PyTuple::new(slf.py(), columns.collect::<Vec<_>>())?;
                Ok((slf.get_type().into_any(), columns))
            }

            $($method)*
        }
    };
}

columns! {
    /// Contacts and near-contacts of a flock's last substep, c of them.
    ///
    /// Snapshots do not hold them: a flock that was restored or unpickled has none until its next
    /// substep, and continues from the same warm-start cache.
    ///
    /// Two nearly parallel hulls, and a hull along the outer wall, touch at two points: two entries.
    ///
    /// Attributes
    /// ----------
    /// i : int64 array, shape (c,)
    ///     The boat that the normal pushes.
    /// j : int64 array, shape (c,)
    ///     The other boat, or -1 for the outer wall, -2 for the inner wall, and from -3 downwards the
    ///     obstacles: the discs in their order, then the walls.
    /// gap_cm : float64 array, shape (c,)
    ///     Distance between the hulls now in cm, negative for overlap.
    /// normal : float64 array, shape (c, 2)
    ///     Unit vector along which boat i is pushed, world axes.
    /// force : float64 array, shape (c,)
    ///     Mean force on boat i along the normal over the last substep in cm/s² (mass 1), at least 0;
    ///     boat j feels its opposite.
    /// point_cm : float64 array, shape (c, 2)
    ///     Where boat i is pushed: a point of its hull, world axes.
    #[pyclass(name = "Contacts", module = "flockenv.flock", frozen, get_all)]
    pub struct PyContacts { i, j, gap_cm, normal, force, point_cm }

    named "Contacts";

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.i.bind(py).len()
    }
}

impl PyContacts {
    /// Of a flock.
    pub fn of(py: Python<'_>, contacts: &[ContactForce]) -> PyResult<Self> {
        let each = contacts.iter();
        Ok(Self {
            i: array(py, each.clone().map(|c| i64::from(c.contact.boat))),
            j: array(py, each.clone().map(|c| i64::from(partner(c)))),
            gap_cm: array(py, each.clone().map(|c| c.contact.gap.gap)),
            normal: pairs(py, contacts, |c| c.contact.gap.normal, |x| x)?,
            force: array(py, each.map(|c| c.force)),
            point_cm: pairs(py, contacts, |c| c.point, |x| x)?,
        })
    }
}

columns! {
    /// Contacts that carried a force, sample after sample: c of them in t samples.
    ///
    /// Attributes
    /// ----------
    /// count : int64 array, shape (t,)
    ///     How many contacts each sample has; they follow one another in the other arrays.
    /// i, j : int32 array, shape (c,)
    ///     The boats, as in `Contacts`: j is -1 for the outer wall, -2 for the inner wall, -3 and below
    ///     for obstacles.
    /// normal : float32 array, shape (c, 2)
    ///     Unit vector along which boat i is pushed, world axes.
    /// force : float32 array, shape (c,)
    ///     Mean force over the substep before the sample in cm/s² (mass 1), above 0.
    /// point_cm : float32 array, shape (c, 2)
    ///     Where boat i is pushed: a point of its hull, world axes.
    #[pyclass(name = "ContactSeries", module = "flockenv.flock", frozen, get_all)]
    pub struct PyContactSeries { count, i, j, normal, force, point_cm }

    named "ContactSeries";

    /// Return the series of contacts that were looked up sample by sample.
    #[classmethod]
    fn of(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        samples: Vec<PyRef<'_, PyContacts>>,
    ) -> PyResult<Self> {
        let numpy = py.import("numpy")?;
        let mut counts = Vec::with_capacity(samples.len());
        let mut pushing = Vec::with_capacity(samples.len());
        for sample in &samples {
            let each = numpy.call_method1("greater", (sample.force.bind(py), 0.0))?;
            counts.push(each.call_method0("sum")?.extract::<i64>()?);
            pushing.push(each);
        }
        let joined = |column: fn(&PyContacts) -> &Py<PyAny>, dtype: &str| -> PyResult<Py<PyAny>> {
            let parts = samples.iter().zip(&pushing);
            let parts = parts.map(|(sample, pushing)| column(sample).bind(py).get_item(pushing));
            let parts = parts.collect::<PyResult<Vec<_>>>()?;
            let whole = numpy.call_method1("concatenate", (parts,))?;
            Ok(whole.call_method1("astype", (dtype,))?.unbind())
        };
        Ok(Self {
            count: array(py, counts.into_iter()),
            i: joined(|sample| &sample.i, "int32")?,
            j: joined(|sample| &sample.j, "int32")?,
            normal: joined(|sample| &sample.normal, "float32")?,
            force: joined(|sample| &sample.force, "float32")?,
            point_cm: joined(|sample| &sample.point_cm, "float32")?,
        })
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        let columns = |series: &Self| -> Vec<_> {
            let each = series.columns().into_iter();
            each.map(|(_, column)| column.clone_ref(py)).collect()
        };
        arrays_equal(py, &columns(self), &columns(other))
    }
}

impl PyContactSeries {
    /// Of a recording.
    pub fn recorded(py: Python<'_>, samples: &ContactSamples) -> PyResult<Self> {
        let contacts = &samples.contacts[..];
        let each = contacts.iter();
        Ok(Self {
            count: array(py, samples.count.iter().map(|&count| count as i64)),
            i: array(py, each.clone().map(|c| c.contact.boat as i32)),
            j: array(py, each.clone().map(partner)),
            normal: pairs(py, contacts, |c| c.contact.gap.normal, |x| x as f32)?,
            force: array(py, each.map(|c| c.force as f32)),
            point_cm: pairs(py, contacts, |c| c.point, |x| x as f32)?,
        })
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

/// Walls are numbered −1 (outer) and −2 (inner), obstacles from −3 downwards.
fn partner(contact: &ContactForce) -> i32 {
    match contact.contact.partner {
        Partner::Boat(boat) => boat as i32,
        Partner::OuterWall => -1,
        Partner::InnerWall => -2,
        Partner::Obstacle(number) => -3 - number as i32,
    }
}

fn array<T: Element>(py: Python<'_>, values: impl Iterator<Item = T>) -> Py<PyAny> {
    PyArray1::from_iter(py, values).into_any().unbind()
}

/// One vector per contact: (c, 2).
fn pairs<T: Element>(
    py: Python<'_>,
    contacts: &[ContactForce],
    vector: fn(&ContactForce) -> Vec2,
    rounded: fn(f64) -> T,
) -> PyResult<Py<PyAny>> {
    let vectors = contacts.iter().map(vector);
    let numbers: Vec<T> = vectors.flat_map(|v| [v.x, v.y]).map(rounded).collect();
    let pairs: Bound<'_, PyArray2<T>> =
        PyArray1::from_vec(py, numbers).reshape([contacts.len(), 2])?;
    Ok(pairs.into_any().unbind())
}
