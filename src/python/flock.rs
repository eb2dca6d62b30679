//! The simulator behind `flockenv.Flock`, which documents its methods.

use super::arguments::{floats, real, targets, whole};
use super::contacts;
use super::exclusive::{Exclusive, interruptible};
use super::parameters::to_dict;
use super::state::{poses_of, rows_of_three, state_from, velocities_of};
use crate::analysis::quantities::Recorded;
use crate::contact::Statistics;
use crate::draw::FrameRenderer;
use crate::error::Result;
use crate::flock::Flock;
use crate::integrator::Steering;
use crate::parameters::FlockParameters;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};
use std::sync::RwLockReadGuard;

/// A flock for one thread at a time.
#[pyclass(name = "Flock", module = "flockenv._core", frozen)]
pub struct PyFlock(Exclusive<Flock>);

impl PyFlock {
    /// A flock for Python.
    pub fn of(flock: Flock) -> Self {
        Self(Exclusive::new(flock, "the flock"))
    }

    /// The flock, to read.
    ///
    /// # Errors
    /// [`FlockError::InUse`] while another thread changes it.
    pub fn read(&self) -> Result<RwLockReadGuard<'_, Flock>> {
        self.0.read()
    }
}

#[pymethods]
impl PyFlock {
    #[new]
    fn new(py: Python<'_>, parameters: FlockParameters, seed: &Bound<'_, PyAny>) -> PyResult<Self> {
        let seed = whole(seed, "seed")?;
        let flock = interruptible(py, |keep_going| {
            Flock::new_while(keep_going, parameters, seed)
        })?;
        Ok(Self::of(flock))
    }

    #[classmethod]
    fn from_snapshot(_class: &Bound<'_, PyType>, snapshot: &Bound<'_, PyBytes>) -> PyResult<Self> {
        Ok(Self::of(Flock::from_snapshot(snapshot.as_bytes())?))
    }

    #[classmethod]
    fn from_state(
        _class: &Bound<'_, PyType>,
        parameters: FlockParameters,
        seed: &Bound<'_, PyAny>,
        state: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        parameters.check()?;
        let (seed, state) = (whole(seed, "seed")?, state_from(state, parameters.n_boats)?);
        Ok(Self::of(Flock::from_state(parameters, seed, &state)?))
    }

    fn reset(&self, py: Python<'_>, seed: &Bound<'_, PyAny>) -> PyResult<()> {
        let seed = whole(seed, "seed")?;
        let mut flock = self.0.write()?;
        let flock = &mut *flock;
        interruptible(py, |keep_going| flock.reset_while(keep_going, seed))
    }

    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(py, self.read()?.parameters())
    }

    #[getter]
    fn seed(&self) -> Result<u64> {
        Ok(self.read()?.seed())
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flock = self.read()?;
        let rows = flock.poses().iter();
        rows_of_three(py, rows.map(|p| [p.position.x, p.position.y, p.heading]))
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flock = self.read()?;
        let rows = flock.velocities().iter();
        rows_of_three(py, rows.map(|v| [v.linear.x, v.linear.y, v.angular]))
    }

    #[getter]
    fn time_s(&self) -> Result<f64> {
        Ok(self.read()?.time_s())
    }

    #[getter]
    fn in_analysis_window(&self) -> Result<bool> {
        let flock = self.read()?;
        Ok(flock.schedule().in_analysis_window(flock.time()))
    }

    #[getter]
    fn phase(&self) -> Result<&'static str> {
        Ok(self.read()?.phase().phase.name())
    }

    /// What the substeps since the flock was made did, by name.
    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        statistics_dict(py, self.read()?.statistics())
    }

    #[getter]
    fn threads(&self) -> Result<usize> {
        Ok(self.read()?.threads())
    }

    #[setter]
    fn set_threads(&self, threads: &Bound<'_, PyAny>) -> PyResult<()> {
        let threads = usize::try_from(whole(threads, "threads")?).unwrap_or(usize::MAX);
        Ok(self.0.write()?.set_threads(threads)?)
    }

    fn set_state(
        &self,
        pose: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        time_s: &Bound<'_, PyAny>,
        allow_overlap: bool,
    ) -> PyResult<()> {
        let shape = [self.read()?.parameters().n_boats, 3];
        let poses = poses_of(&floats(pose, "pose", &shape)?);
        let velocities = velocities_of(&floats(velocity, "velocity", &shape)?);
        let time_s = real(time_s, "time_s")?;
        let mut flock = self.0.write()?;
        Ok(flock.set_state(&poses, &velocities, time_s, allow_overlap)?)
    }

    fn set_target(&self, target: &Bound<'_, PyAny>) -> PyResult<()> {
        Ok(self.0.write()?.set_target(targets(target)?)?)
    }

    #[pyo3(signature = (seconds, rudder=None))]
    fn advance(
        &self,
        py: Python<'_>,
        seconds: &Bound<'_, PyAny>,
        rudder: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let seconds = real(seconds, "seconds")?;
        let leaders = [self.read()?.parameters().n_leaders];
        let rudder = rudder.map(|rudder| floats(rudder, "rudder", &leaders));
        let rudder = rudder.transpose()?;
        let mut flock = self.0.write()?;
        let flock = &mut *flock;
        flock.check_rudder(rudder.as_deref())?;
        let end = flock.end_of(seconds)?;
        let steering = rudder.as_deref().map_or(Steering::Law, Steering::Held);
        interruptible(py, |keep_going| {
            flock.advance_while(keep_going, end, steering)
        })
    }

    fn steering_law<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        let flock = self.read()?;
        let leaders = 0..flock.parameters().n_leaders;
        let rudders = leaders.map(|leader| flock.steering_law(leader));
        Ok(PyArray1::from_iter(py, rudders))
    }

    /// The recorded quantities, in the order of the table.
    fn order_parameters(&self, include_leaders: bool) -> Result<Recorded> {
        self.read()?.recorded(include_leaders)
    }

    /// Contacts and near-contacts of the last substep, by column.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        contacts::columns::<i64, f64>(py, &self.read()?.contacts(), |x| x)
    }

    fn snapshot<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.read()?.snapshot()))
    }

    fn restore(&self, snapshot: &Bound<'_, PyBytes>) -> Result<()> {
        self.0.write()?.restore(snapshot.as_bytes())
    }

    fn copy(&self) -> Result<Self> {
        Ok(Self::of(self.read()?.clone()))
    }

    /// A square picture as the bytes of a PNG file.
    fn png<'py>(&self, py: Python<'py>, pixels: u32) -> Result<Bound<'py, PyBytes>> {
        let png = FrameRenderer::new(pixels, pixels)?.png(&*self.read()?)?;
        Ok(PyBytes::new(py, &png))
    }
}

/// Statistics by name.
fn statistics_dict<'py>(py: Python<'py>, of: &Statistics) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    macro_rules! set {
        ($($name:ident),+) => { $(dict.set_item(stringify!($name), of.$name)?;)+ };
    }
    set!(
        substeps,
        solves,
        contacts,
        islands,
        solver_iterations,
        factored_rows
    );
    set!(
        most_factor_entries,
        unsolved,
        depenetration_passes,
        neighbor_builds
    );
    set!(
        worst_residual_cm_s,
        worst_overlap_cm,
        displaced_angular_momentum_cm2_s
    );
    Ok(dict)
}
