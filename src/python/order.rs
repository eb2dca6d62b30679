//! `flockenv.OrderParameters` and `flockenv.OrderSeries`: the recorded quantities of the table, at one time
//! and at many.

use super::arguments::{real, same_length, targets};
use super::result::{arrays_equal, repr_of};
use super::structure::Samples;
use crate::analysis::OrderParameters;
use crate::analysis::collective_state::{CollectiveState, ordering_time};
use crate::analysis::quantities::{Formula, QUANTITIES, RECORDED, Recorded, quantity, recorded};
use crate::geometry::HullPose;
use crate::parameters::Target;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray3};
use pyo3::exceptions::{PyAttributeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple, PyType};

/// Names of the recorded quantities, in the order of the table.
fn names() -> impl Iterator<Item = &'static str> {
    QUANTITIES[..RECORDED].iter().map(|each| each.name)
}

/// The place of a recorded quantity, or the error that an attribute is missing.
fn place_of(class: &str, name: &str) -> PyResult<usize> {
    names().position(|known| known == name).ok_or_else(|| {
        PyAttributeError::new_err(format!("'{class}' object has no attribute '{name}'"))
    })
}

/// The attributes of a class and the recorded quantities.
fn attributes_of<'py>(class: &Bound<'py, PyType>) -> PyResult<Bound<'py, PyList>> {
    let attributes = class.dir()?;
    names().try_for_each(|name| attributes.append(name))?;
    Ok(attributes)
}

/// One value for each recorded quantity, out of positional and named arguments.
fn arguments<'py>(
    class: &str,
    values: &Bound<'py, PyTuple>,
    named: Option<&Bound<'py, PyDict>>,
) -> PyResult<Vec<Option<Bound<'py, PyAny>>>> {
    if values.len() > RECORDED {
        let message = format!("{class} takes at most {RECORDED} values");
        return Err(PyTypeError::new_err(message));
    }
    let mut columns: Vec<_> = values.iter().map(Some).collect();
    columns.resize(RECORDED, None);
    for (name, value) in named.into_iter().flatten() {
        let name: String = name.extract()?;
        let place = place_of(class, &name).map_err(|_| {
            PyTypeError::new_err(format!("{class} got an unknown argument '{name}'"))
        })?;
        if columns[place].replace(value).is_some() {
            let message = format!("{class} got two values of '{name}'");
            return Err(PyTypeError::new_err(message));
        }
    }
    Ok(columns)
}

/// Alignment of a set of boats at one time: the recorded quantities of `flockenv.quantities()`.
///
/// LAP angles count clockwise from the outward radial: 0 is jammed outward, +π/2 clockwise. Values that
/// are not given are NaN.
#[pyclass(name = "OrderParameters", module = "flockenv.flock", frozen)]
pub struct PyOrderParameters(pub Recorded);

#[pymethods]
impl PyOrderParameters {
    #[new]
    #[pyo3(signature = (*values, **named))]
    fn new(values: &Bound<'_, PyTuple>, named: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut recorded = [f64::NAN; RECORDED];
        let given = arguments("OrderParameters", values, named)?;
        for ((value, given), name) in recorded.iter_mut().zip(given).zip(names()) {
            if let Some(given) = given {
                *value = real(&given, name)?;
            }
        }
        Ok(Self(recorded))
    }

    fn __getattr__(&self, name: &str) -> PyResult<f64> {
        Ok(self.0[place_of("OrderParameters", name)?])
    }

    fn __dir__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyList>> {
        attributes_of(&slf.get_type())
    }

    fn __eq__(&self, other: &Self) -> bool {
        let mut pairs = self.0.iter().zip(other.0);
        pairs.all(|(&mine, theirs)| mine == theirs || (mine.is_nan() && theirs.is_nan()))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        PyTuple::new(
            py,
            self.0
                .map(|value| if value.is_nan() { None } else { Some(value) }),
        )?
        .hash()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        repr_of(py, "OrderParameters", names().zip(self.0))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let values = PyTuple::new(slf.py(), slf.get().0)?;
        Ok((slf.get_type().into_any(), values))
    }
}

/// Order parameters one after another: the fields of `OrderParameters` as float64 arrays (t,).
///
/// All NaN if there is no boat to take them of; ``c_o`` and ``c_v`` NaN for a single boat. Columns that
/// are not given are NaN.
#[pyclass(name = "OrderSeries", module = "flockenv.flock", frozen, subclass)]
pub struct PyOrderSeries(Vec<Py<PyAny>>);

impl PyOrderSeries {
    /// The series of recorded samples.
    pub fn of(py: Python<'_>, series: &[Recorded]) -> Self {
        let column = |place| {
            let values = series.iter().map(|values: &Recorded| values[place]);
            PyArray1::from_iter(py, values).into_any().unbind()
        };
        Self((0..RECORDED).map(column).collect())
    }

    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<PyReadonlyArray1<'py, f64>> {
        let column = self.0[place_of("OrderSeries", name)?].bind(py);
        column.extract()
    }

    /// The order parameters that derived quantities and states follow from.
    fn orders(&self, py: Python<'_>) -> PyResult<Vec<OrderParameters>> {
        let mut columns = Vec::with_capacity(3);
        for name in ["psi_o", "phi_o", "psi_v"] {
            columns.push(self.column(py, name)?);
            let (first, last) = (columns[0].as_array(), columns[columns.len() - 1].as_array());
            same_length(name, last.len(), first.len())?;
        }
        let [psi_o, phi_o, psi_v] = [0, 1, 2].map(|place| columns[place].as_array());
        let rows = psi_o.iter().zip(phi_o).zip(psi_v);
        Ok(rows
            .map(|((&psi_o, &phi_o), &psi_v)| OrderParameters {
                psi_o,
                phi_o,
                psi_v,
                ..OrderParameters::default()
            })
            .collect())
    }

    fn derived<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        target: Target,
    ) -> PyResult<Bound<'py, PyAny>> {
        match quantity(name)?.formula {
            Formula::Derived(formula) => {
                let orders = self.orders(py)?;
                let values = orders.iter().map(|order| formula(order, target));
                Ok(PyArray1::from_iter(py, values).into_any())
            }
            Formula::Recorded(_) | Formula::Structure(_) => {
                Ok(self.0[place_of("OrderSeries", name)?].bind(py).clone())
            }
        }
    }
}

/// The direction that the signed quantities of a flock with such targets count towards.
fn reference(target: &Bound<'_, PyAny>) -> PyResult<Target> {
    Ok(targets(target)?.reference())
}

#[pymethods]
impl PyOrderSeries {
    #[new]
    #[pyo3(signature = (*columns, **named))]
    fn new(
        py: Python<'_>,
        columns: &Bound<'_, PyTuple>,
        named: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let given = arguments("OrderSeries", columns, named)?;
        let first = given.iter().flatten().next();
        let length = first.map_or(Ok(0), PyAnyMethods::len)?;
        let undefined = || PyArray1::from_vec(py, vec![f64::NAN; length]).into_any();
        let columns = given
            .into_iter()
            .map(|column| column.unwrap_or_else(undefined));
        Ok(Self(columns.map(Bound::unbind).collect()))
    }

    fn __getattr__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        Ok(self.0[place_of("OrderSeries", name)?].clone_ref(py))
    }

    fn __dir__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyList>> {
        attributes_of(&slf.get_type())
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.0[0].bind(py).len()
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        arrays_equal(py, &self.0, &other.0)
    }

    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<PyOrderParameters> {
        let mut values = [f64::NAN; RECORDED];
        for (value, column) in values.iter_mut().zip(&self.0) {
            *value = column.bind(py).get_item(index)?.extract()?;
        }
        Ok(PyOrderParameters(values))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        repr_of(py, "OrderSeries", names().zip(&self.0))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let columns = PyTuple::new(slf.py(), &slf.get().0)?;
        Ok((slf.get_type().into_any(), columns))
    }

    /// The values of a recorded or derived quantity, shape (t,).
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name in the table of quantities.
    /// target : str or sequence of str
    ///     Direction that signed quantities count towards, "cw" or "ccw"; of a list the first.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For an unknown name or target.
    #[pyo3(signature = (name, target=None), text_signature = "($self, name, target='cw')")]
    fn series<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        target: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let target = target.map_or(Ok(Target::Clockwise), reference)?;
        self.derived(py, name, target)
    }

    /// Ψ_o·cos(φ_o - φ_target) in [-1, 1], shape (t,), for target "cw" or "ccw"; of a list, for the first.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For an unknown target.
    fn signed_order<'py>(
        &self,
        py: Python<'py>,
        target: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.derived(py, "signed_order", reference(target)?)
    }

    /// Ψ_o·sin φ_o in [-1, 1], shape (t,): ±1 for rotation in order, 0 for a jam.
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.derived(py, "rotation", Target::Clockwise)
    }

    /// Ψ_o·cos φ_o in [-1, 1], shape (t,): 1 for a jam, near 0 for streams along the pool.
    ///
    /// It is the mean of cos φ over boats, so that opposed streams do not cancel as in `rotation`.
    fn outward<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.derived(py, "outward", Target::Clockwise)
    }

    /// ||φ_o| - π/2| in [0, π/2] rad, shape (t,): 0 for boats that point along the pool.
    fn off_tangent<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.derived(py, "off_tangent", Target::Clockwise)
    }

    /// Return the collective state at each time (Table 2), shape (t,).
    ///
    /// Meant for times in the analysis window. ``"ordered cw"`` and ``"ordered ccw"``: Ψ_o above
    /// 0.8, φ_o within π/4 of ±π/2, Ψ_v at least a quarter of the preferred speed. ``"jamming"``:
    /// Ψ_o above 0.8, φ_o within π/4 of 0, Ψ_v below that. ``"disordered"``: Ψ_o below 0.5.
    /// ``"clustering"``: the same, with at least three quarters of the boats in one cluster.
    /// ``"between"``: none of these.
    ///
    /// Parameters
    /// ----------
    /// speed_cm_s : float
    ///     Preferred forward speed of the boats.
    /// largest_cluster : array, shape (t,), optional
    ///     Part of the boats in the largest cluster, as `largest_cluster` of
    ///     `flockenv.statistics.structure` computes it. None: no state is called clustering.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For an array of another length.
    #[pyo3(signature = (speed_cm_s, largest_cluster=None))]
    fn states<'py>(
        &self,
        py: Python<'py>,
        speed_cm_s: &Bound<'py, PyAny>,
        largest_cluster: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speed = real(speed_cm_s, "speed_cm_s")?;
        let orders = self.orders(py)?;
        let clusters = match largest_cluster {
            Some(clusters) => clusters.as_array().to_vec(),
            None => vec![0.0; orders.len()],
        };
        same_length("largest_cluster", clusters.len(), orders.len())?;
        let places = orders.iter().zip(clusters);
        let places =
            places.map(|(order, cluster)| CollectiveState::of(order, speed, cluster) as i64);
        let states = py
            .import("numpy")?
            .call_method1("array", (collective_state_names(),))?;
        states.get_item(PyArray1::from_iter(py, places))
    }

    /// Ordering time τ of a run, eq. (7), in s; infinite if the run does not order.
    ///
    /// The first time at which Ψ_o > 0.8 and ||φ_o| - π/2| < `within`, if mean Ψ_o over the second
    /// half of the run exceeds 0.8.
    ///
    /// Parameters
    /// ----------
    /// time_s : array, shape (t,)
    ///     Times of the series.
    /// within : float
    ///     Angle in rad: π/20 as printed, or a wider one.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For times of another length.
    #[pyo3(
        signature = (time_s, within=None),
        text_signature = "($self, time_s, within=0.15707963267948966)"
    )]
    fn ordering_time<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
        within: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<f64> {
        let printed = std::f64::consts::PI / 20.0;
        let within = within.map_or(Ok(printed), |within| real(within, "within"))?;
        let (orders, times) = (self.orders(py)?, time_s.as_array().to_vec());
        same_length("time_s", times.len(), orders.len())?;
        Ok(ordering_time(&times, &orders, within))
    }
}

/// Names of the collective states (Table 2; ordered motion by its direction).
#[pyfunction]
pub(crate) fn collective_state_names() -> Vec<&'static str> {
    let states = CollectiveState::ALL.iter();
    states.map(|state| state.name()).collect()
}

/// The recorded quantities of boats at each time, of poses and velocities of shape (t, n, 3).
///
/// Rows of NaN stand for boats that are not there; where too few are, quantities are NaN.
#[pyfunction]
pub(crate) fn order_series<'py>(
    py: Python<'py>,
    pose: PyReadonlyArray3<'py, f64>,
    velocity: PyReadonlyArray3<'py, f64>,
) -> PyResult<PyOrderSeries> {
    let samples = Samples::read(&pose, "pose")?;
    let motions = Samples::read(&velocity, "velocity")?;
    samples.check_same_shape(&motions)?;
    let mut hulls = Vec::new();
    let mut series = Vec::new();
    for (poses, velocities) in samples.present_with(&motions) {
        HullPose::replace_all(&mut hulls, &poses);
        series.push(if hulls.is_empty() {
            [f64::NAN; RECORDED]
        } else {
            recorded(&hulls, &velocities)?
        });
    }
    Ok(PyOrderSeries::of(py, &series))
}
