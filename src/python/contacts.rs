//! `flockenv.Contacts` and `flockenv.ContactSeries`.

use super::result::{arrays_equal, repr_of};
use crate::contact::Partner;
use crate::flock::{ContactForce, ContactSamples};
use crate::geometry::Vec2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};

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
///     The other boat, or -1 for the outer wall, -2 for the inner wall.
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
pub struct PyContacts {
    i: Py<PyAny>,
    j: Py<PyAny>,
    gap_cm: Py<PyAny>,
    normal: Py<PyAny>,
    force: Py<PyAny>,
    point_cm: Py<PyAny>,
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

    fn fields(&self) -> [(&'static str, &Py<PyAny>); 6] {
        [
            ("i", &self.i),
            ("j", &self.j),
            ("gap_cm", &self.gap_cm),
            ("normal", &self.normal),
            ("force", &self.force),
            ("point_cm", &self.point_cm),
        ]
    }
}

#[pymethods]
impl PyContacts {
    #[new]
    fn new(
        i: Py<PyAny>,
        j: Py<PyAny>,
        gap_cm: Py<PyAny>,
        normal: Py<PyAny>,
        force: Py<PyAny>,
        point_cm: Py<PyAny>,
    ) -> Self {
        Self {
            i,
            j,
            gap_cm,
            normal,
            force,
            point_cm,
        }
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.i.bind(py).len()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        repr_of(py, "Contacts", self.fields().into_iter())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let fields = slf.get().fields().map(|(_, field)| field);
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), fields)?))
    }
}

/// Contacts that carried a force, sample after sample: c of them in t samples.
///
/// Attributes
/// ----------
/// count : int64 array, shape (t,)
///     How many contacts each sample has; they follow one another in the other arrays.
/// i, j : int32 array, shape (c,)
///     The boats, as in `Contacts`: j is -1 for the outer wall, -2 for the inner wall.
/// normal : float32 array, shape (c, 2)
///     Unit vector along which boat i is pushed, world axes.
/// force : float32 array, shape (c,)
///     Mean force over the substep before the sample in cm/s² (mass 1), above 0.
/// point_cm : float32 array, shape (c, 2)
///     Where boat i is pushed: a point of its hull, world axes.
#[pyclass(name = "ContactSeries", module = "flockenv.flock", frozen, get_all)]
pub struct PyContactSeries {
    count: Py<PyAny>,
    i: Py<PyAny>,
    j: Py<PyAny>,
    normal: Py<PyAny>,
    force: Py<PyAny>,
    point_cm: Py<PyAny>,
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

    fn fields(&self) -> [(&'static str, &Py<PyAny>); 6] {
        [
            ("count", &self.count),
            ("i", &self.i),
            ("j", &self.j),
            ("normal", &self.normal),
            ("force", &self.force),
            ("point_cm", &self.point_cm),
        ]
    }
}

#[pymethods]
impl PyContactSeries {
    #[new]
    fn new(
        count: Py<PyAny>,
        i: Py<PyAny>,
        j: Py<PyAny>,
        normal: Py<PyAny>,
        force: Py<PyAny>,
        point_cm: Py<PyAny>,
    ) -> Self {
        Self {
            count,
            i,
            j,
            normal,
            force,
            point_cm,
        }
    }

    /// Return the series of contacts that were looked up sample by sample.
    #[classmethod]
    fn of(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        samples: Vec<PyRef<'_, PyContacts>>,
    ) -> PyResult<Self> {
        let numpy = py.import("numpy")?;
        let mut counts = Vec::with_capacity(samples.len());
        let mut kept: [Vec<Bound<'_, PyAny>>; 5] = Default::default();
        for sample in &samples {
            let pushing = numpy.call_method1("greater", (sample.force.bind(py), 0.0))?;
            counts.push(pushing.call_method0("sum")?.extract::<i64>()?);
            let columns = [
                &sample.i,
                &sample.j,
                &sample.normal,
                &sample.force,
                &sample.point_cm,
            ];
            for (parts, column) in kept.iter_mut().zip(columns) {
                parts.push(column.bind(py).get_item(&pushing)?);
            }
        }
        let [i, j, normal, force, point_cm] = kept;
        let joined = |parts: Vec<Bound<'_, PyAny>>, dtype: &str| -> PyResult<Py<PyAny>> {
            let whole = numpy.call_method1("concatenate", (parts,))?;
            Ok(whole.call_method1("astype", (dtype,))?.unbind())
        };
        Ok(Self {
            count: array(py, counts.into_iter()),
            i: joined(i, "int32")?,
            j: joined(j, "int32")?,
            normal: joined(normal, "float32")?,
            force: joined(force, "float32")?,
            point_cm: joined(point_cm, "float32")?,
        })
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        let fields = |series: &Self| series.fields().map(|(_, field)| field.clone_ref(py));
        arrays_equal(py, &fields(self), &fields(other))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        repr_of(py, "ContactSeries", self.fields().into_iter())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let fields = slf.get().fields().map(|(_, field)| field);
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), fields)?))
    }
}

/// Walls are numbered −1 (outer) and −2 (inner).
fn partner(contact: &ContactForce) -> i32 {
    match contact.contact.partner {
        Partner::Boat(boat) => boat as i32,
        Partner::OuterWall => -1,
        Partner::InnerWall => -2,
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
