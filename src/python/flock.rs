//! The simulator behind `flockenv.Flock`, which documents its methods.

use super::arrays::{floats, rows_from, rows_of};
use super::exclusive::{Exclusive, interruptible};
use super::parameters::PyParameters;
use super::value::{argument, noise_seed_from, seed_from, value_from, wrong_type};
use crate::analysis::quantities::Recorded;
use crate::clock::Ticks;
use crate::contact::{KeepGoing, Partner};
use crate::draw::{FrameRenderer, Look};
use crate::error::{FlockError, Result};
use crate::flock::{ContactForce, Flock, State};
use crate::geometry::{Pose, Vec2, Velocity};
use crate::integrator::Steering;
use crate::parameters::{FlockParameters, Targets, Value, text_of};
use numpy::{Element, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};
use std::sync::{Mutex, PoisonError};

/// A flock for one thread at a time.
#[pyclass(name = "Flock", module = "flockenv._core", frozen)]
pub(super) struct PyFlock(pub(super) Exclusive<Flock>);

impl PyFlock {
    /// A flock for Python.
    pub(super) fn wrap(flock: Flock) -> Self {
        Self(Exclusive::new(flock, "the flock"))
    }

    /// Calls `advance` with the end of a duration and with checked rudders, without the interpreter lock.
    fn advance_by<T: Send>(
        &self,
        py: Python<'_>,
        seconds: &Bound<'_, PyAny>,
        rudder: Option<&Bound<'_, PyAny>>,
        advance: fn(&mut Flock, KeepGoing, Ticks, Steering) -> Result<T>,
    ) -> PyResult<T> {
        let seconds = argument(seconds, "seconds")?;
        let rudder = rudders_from(rudder, &*self.0.read()?)?;
        let mut flock = self.0.write()?;
        let flock = &mut *flock;
        let end = flock.end_of(seconds)?;
        let steering = rudder.as_deref().map_or(Steering::Law, Steering::Held);
        interruptible(py, |keep_going| advance(flock, keep_going, end, steering))
    }
}

#[pymethods]
impl PyFlock {
    #[new]
    fn new(py: Python<'_>, parameters: FlockParameters, seed: &Bound<'_, PyAny>) -> PyResult<Self> {
        let seed = seed_from(seed)?;
        let flock = interruptible(py, |keep_going| {
            Flock::new_while(keep_going, parameters, seed)
        })?;
        Ok(Self::wrap(flock))
    }

    #[classmethod]
    fn from_snapshot(
        _class: &Bound<'_, PyType>,
        snapshot: &[u8],
        noise_seed: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let noise_seed = noise_seed_from(noise_seed)?;
        Ok(Flock::from_snapshot(snapshot, noise_seed).map(Self::wrap)?)
    }

    #[classmethod]
    fn from_state(
        _class: &Bound<'_, PyType>,
        parameters: FlockParameters,
        seed: &Bound<'_, PyAny>,
        state: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let (seed, state) = (seed_from(seed)?, state_from(state, parameters.n_boats)?);
        Ok(Self::wrap(Flock::from_state(parameters, seed, &state)?))
    }

    fn reset(&self, py: Python<'_>, seed: &Bound<'_, PyAny>) -> PyResult<()> {
        let seed = seed_from(seed)?;
        let mut flock = self.0.write()?;
        let flock = &mut *flock;
        interruptible(py, |keep_going| flock.reset(keep_going, seed))
    }

    #[getter]
    fn parameters(&self) -> Result<PyParameters> {
        Ok(PyParameters(self.0.read()?.parameters().clone()))
    }

    #[getter]
    fn seed(&self) -> Result<u64> {
        Ok(self.0.read()?.seed())
    }

    #[getter]
    fn noise_seed(&self) -> Result<Option<u64>> {
        Ok(self.0.read()?.noise_seed())
    }

    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows_of(py, pose_numbers(self.0.read()?.poses()).collect(), 3)
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows_of(
            py,
            velocity_numbers(self.0.read()?.velocities()).collect(),
            3,
        )
    }

    #[getter]
    fn time_s(&self) -> Result<f64> {
        Ok(self.0.read()?.time_s())
    }

    #[getter]
    fn current_cm_s(&self) -> Result<f64> {
        Ok(self.0.read()?.current_cm_s())
    }

    #[getter]
    fn in_analysis_window(&self) -> Result<bool> {
        let flock = self.0.read()?;
        Ok(flock.schedule().in_analysis_window(flock.time()))
    }

    #[getter]
    fn phase(&self) -> Result<&'static str> {
        Ok(self.0.read()?.phase().phase.name())
    }

    /// Statistics of the substeps since the flock was made, by name.
    #[getter]
    fn statistics(&self) -> Result<Value> {
        Ok(self.0.read()?.statistics().named())
    }

    fn set_state(&self, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let state = state_from(state, self.0.read()?.parameters().n_boats)?;
        let (poses, velocities) = (&state.poses, &state.velocities);
        let mut flock = self.0.write()?;
        Ok(flock.set_state(poses, velocities, state.time_s, state.allow_overlap)?)
    }

    fn set_target(&self, target: &Bound<'_, PyAny>) -> PyResult<()> {
        let target: Targets = argument(target, "target")?;
        Ok(self.0.write()?.set_target(target)?)
    }

    #[pyo3(signature = (seconds, rudder=None))]
    fn advance(
        &self,
        py: Python<'_>,
        seconds: &Bound<'_, PyAny>,
        rudder: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        self.advance_by(py, seconds, rudder, Flock::advance_to)
    }

    /// Advances and returns the error of the step in cm.
    #[pyo3(signature = (seconds, rudder=None))]
    fn advance_with_error(
        &self,
        py: Python<'_>,
        seconds: &Bound<'_, PyAny>,
        rudder: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<f64> {
        self.advance_by(py, seconds, rudder, Flock::advance_to_with_error)
    }

    fn set_step(&self, dt_s: &Bound<'_, PyAny>) -> PyResult<()> {
        let dt_s = argument(dt_s, "dt_s")?;
        Ok(self.0.write()?.set_step(dt_s)?)
    }

    fn steering_law<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        let flock = self.0.read()?;
        let leaders = 0..flock.parameters().n_leaders;
        let rudders = leaders.map(|leader| flock.steering_law(leader));
        Ok(PyArray1::from_iter(py, rudders))
    }

    /// The recorded quantities, in the order of the table.
    fn order_parameters(&self, include_leaders: bool) -> Result<Recorded> {
        self.0.read()?.recorded(include_leaders)
    }

    /// Contacts and near-contacts of the last substep, by column.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        contact_columns::<i64, f64>(py, &self.0.read()?.contacts(), |number| number)
    }

    fn snapshot<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.0.read()?.snapshot()))
    }

    fn restore(&self, snapshot: &[u8], noise_seed: &Bound<'_, PyAny>) -> PyResult<()> {
        let noise_seed = noise_seed_from(noise_seed)?;
        Ok(self.0.write()?.restore(snapshot, noise_seed)?)
    }

    fn copy(&self) -> Result<Self> {
        Ok(Self::wrap(self.0.read()?.clone()))
    }

    /// A square picture as the bytes of a PNG file.
    fn png<'py>(&self, py: Python<'py>, pixels: u32) -> Result<Bound<'py, PyBytes>> {
        let png = py.detach(|| FrameRenderer::new(pixels, pixels)?.png(&*self.0.read()?))?;
        Ok(PyBytes::new(py, &png))
    }
}

/// Numbers [cm, cm, rad] of poses, one after another.
pub(super) fn pose_numbers(poses: &[Pose]) -> impl Iterator<Item = f64> {
    let poses = poses.iter();
    poses.flat_map(|pose| [pose.position.x, pose.position.y, pose.heading])
}

/// Numbers [cm/s, cm/s, rad/s] of velocities, one after another.
pub(super) fn velocity_numbers(velocities: &[Velocity]) -> impl Iterator<Item = f64> {
    let velocities = velocities.iter();
    velocities.flat_map(|v| [v.linear.x, v.linear.y, v.angular])
}

/// Checks the rudders of a flock's leaders, if the argument is given.
pub(super) fn rudders_from(
    object: Option<&Bound<'_, PyAny>>,
    flock: &Flock,
) -> PyResult<Option<Vec<f64>>> {
    let leaders = [flock.parameters().n_leaders];
    let rudders = object.map(|rudder| floats(rudder, "rudder", &leaders));
    let rudders = rudders.transpose()?;
    flock.check_rudder(rudders.as_deref())?;
    Ok(rudders)
}

/// A state from the dictionary {"pose": (n, 3), "velocity": (n, 3), "time_s": float, "allow_overlap": bool}. Only the pose
/// is required.
pub(super) fn state_from(value: &Bound<'_, PyAny>, boats: usize) -> PyResult<State> {
    let accepted = "a dictionary with pose and, if you like, velocity, time_s and allow_overlap";
    let dict = value.cast::<PyDict>();
    let dict = dict.map_err(|_| wrong_type(value, "state", accepted))?;
    let refuse = |found: &str| FlockError::parameter("state", found, accepted);
    let mut state = State {
        poses: Vec::new(),
        velocities: vec![Velocity::default(); boats],
        time_s: 0.0,
        allow_overlap: false,
    };
    let mut has_pose = false;
    for (name, value) in dict {
        match text_of("state", &value_from(&name))? {
            "pose" => {
                let rows = rows_from(&value, "pose", boats)?.into_iter();
                let pose = |[x, y, heading]: [f64; 3]| Pose::new(x, y, heading);
                state.poses = rows.map(pose).collect();
                has_pose = true;
            }
            "velocity" => {
                let rows = rows_from(&value, "velocity", boats)?.into_iter();
                let velocity = |[x, y, angular]: [f64; 3]| Velocity::new(x, y, angular);
                state.velocities = rows.map(velocity).collect();
            }
            "time_s" => state.time_s = argument(&value, "time_s")?,
            "allow_overlap" => state.allow_overlap = argument(&value, "allow_overlap")?,
            other => return Err(refuse(&format!("{other:?}")).into()),
        }
    }
    if !has_pose {
        return Err(refuse("without pose").into());
    }
    Ok(state)
}

/// Contacts as columns: i, j, gap_cm, normal, force, point_cm and along_cm. `round` converts to the columns' precision.
pub(super) fn contact_columns<'py, I: Element + From<i32>, T: Element>(
    py: Python<'py>,
    contacts: &[ContactForce],
    round: fn(f64) -> T,
) -> PyResult<Bound<'py, PyDict>> {
    let numbers = |value: fn(&ContactForce) -> f64| {
        PyArray1::from_iter(py, contacts.iter().map(value).map(round))
    };
    let boats = |boat: fn(&ContactForce) -> i32| {
        PyArray1::from_iter(py, contacts.iter().map(boat).map(I::from))
    };
    let vectors = |vector: fn(&ContactForce) -> Vec2| {
        let numbers = contacts.iter().map(vector).flat_map(|v| [v.x, v.y]);
        rows_of(py, numbers.map(round).collect(), 2)
    };
    let columns = PyDict::new(py);
    columns.set_item(
        "i",
        boats(|contact_force| contact_force.contact.boat as i32),
    )?;
    columns.set_item("j", boats(partner_number))?;
    columns.set_item(
        "gap_cm",
        numbers(|contact_force| contact_force.contact.gap.gap),
    )?;
    columns.set_item(
        "normal",
        vectors(|contact_force| contact_force.contact.gap.normal)?,
    )?;
    columns.set_item("force", numbers(|contact_force| contact_force.force))?;
    columns.set_item("point_cm", vectors(|contact_force| contact_force.point)?)?;
    columns.set_item(
        "along_cm",
        numbers(|contact_force| contact_force.contact.gap.along),
    )?;
    Ok(columns)
}

/// The number of a contact's partner: a boat's index, −1 for the outer wall, −2 for the inner wall, −3 − number for an
/// obstacle.
fn partner_number(contact_force: &ContactForce) -> i32 {
    match contact_force.contact.partner {
        Partner::Boat(boat) => boat as i32,
        Partner::OuterWall => -1,
        Partner::InnerWall => -2,
        Partner::Obstacle(number) => -3 - number as i32,
    }
}

/// Draws flocks in one size, without the interpreter lock. Threads take turns.
#[pyclass(name = "FrameRenderer", module = "flockenv._core", frozen)]
pub(super) struct PyFrameRenderer(Mutex<FrameRenderer>);

#[pymethods]
impl PyFrameRenderer {
    #[new]
    fn new(width: &Bound<'_, PyAny>, height: &Bound<'_, PyAny>) -> PyResult<Self> {
        let side = |object, name| {
            // A number that does not fit 32 bits is refused like the largest that does.
            Ok::<_, PyErr>(u32::try_from(argument::<usize>(object, name)?).unwrap_or(u32::MAX))
        };
        let (width, height) = (side(width, "width")?, side(height, "height")?);
        Ok(Self(Mutex::new(FrameRenderer::new(width, height)?)))
    }

    /// A picture of a flock as it is now: (height, width, 3), uint8. `colors` names what a boat's color shows.
    #[pyo3(signature = (flock, colors="direction", caption=""))]
    fn draw<'py>(
        &self,
        py: Python<'py>,
        flock: &PyFlock,
        colors: &str,
        caption: &str,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let coloring = colors.parse()?;
        let look = Look { coloring, caption };
        let (shape, frame) = py.detach(|| -> Result<_> {
            let mut renderer = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let shape = [renderer.height() as usize, renderer.width() as usize, 3];
            Ok((shape, renderer.draw_with(&*flock.0.read()?, look)))
        })?;
        PyArray1::from_vec(py, frame).reshape(shape)
    }
}
