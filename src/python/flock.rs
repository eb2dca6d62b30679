//! `flockenv.Flock`.

use super::arguments::{Seconds, Seed, Threads, TimeS, floats, targets};
use super::contacts::PyContacts;
use super::exclusive::{Exclusive, interruptible};
use super::order::PyOrderParameters;
use super::parameters::to_python;
use super::state::{poses_of, rows_of_three, state_from, velocities_of};
use super::statistics::PyStatistics;
use crate::clock::{Ticks, seconds};
use crate::draw::FrameRenderer;
use crate::error::Result;
use crate::flock::Flock;
use crate::integrator::Steering;
use crate::parameters::FlockParameters;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyType};
use std::sync::RwLockReadGuard;

/// A flock of boats in a pool.
///
/// Boats are placed at random without overlap, at rest; leaders are boats 0 to k - 1. The same
/// parameters and seed give the same bits on one machine, through snapshots, pickles and copies too.
/// The interpreter lock is released while the flock moves.
///
/// Parameters
/// ----------
/// parameters : FlockParameters
///     Of the flock.
/// seed : int
///     Seed of all random streams, 0 to 2^64 - 1.
///
/// Raises
/// ------
/// ParameterError
///     If the boats do not fit the pool, and for a seed out of range.
#[pyclass(name = "Flock", module = "flockenv", frozen)]
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
    fn new(py: Python<'_>, parameters: FlockParameters, seed: Seed) -> PyResult<Self> {
        let flock = interruptible(py, parameters.n_boats, |keep_going| {
            Flock::new_while(keep_going, parameters, seed.0)
        })?;
        Ok(Self::of(flock))
    }

    /// The flock of a snapshot.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For bytes that are no whole, unharmed snapshot.
    #[classmethod]
    fn from_snapshot(_class: &Bound<'_, PyType>, snapshot: &Bound<'_, PyBytes>) -> PyResult<Self> {
        Ok(Self::of(Flock::from_snapshot(snapshot.as_bytes())?))
    }

    /// A flock in a given state.
    ///
    /// Parameters
    /// ----------
    /// parameters : FlockParameters
    ///     Of the flock.
    /// seed : int
    ///     Seed of all random streams, 0 to 2^64 - 1.
    /// state : dict
    ///     ``pose`` (n, 3) and, if need be, ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``, as
    ///     in `set_state`.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For other keys, a seed out of range and what `set_state` refuses.
    /// TypeError
    ///     For values of the wrong type.
    #[classmethod]
    fn from_state(
        _class: &Bound<'_, PyType>,
        parameters: FlockParameters,
        seed: Seed,
        state: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        parameters.check()?;
        let state = state_from(state, parameters.n_boats)?;
        Ok(Self::of(Flock::from_state(parameters, seed.0, &state)?))
    }

    /// Start over with another seed, as a new flock with these parameters.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     If the boats do not fit the pool; the flock is unchanged then.
    fn reset(&self, py: Python<'_>, seed: Seed) -> PyResult<()> {
        let mut flock = self.0.write()?;
        let flock = &mut *flock;
        interruptible(py, flock.parameters().n_boats, |keep_going| {
            flock.reset_while(keep_going, seed.0)
        })
    }

    /// The parameters, with the target that holds now.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self.read()?.parameters())
    }

    /// Seed of all random streams.
    #[getter]
    fn seed(&self) -> Result<u64> {
        Ok(self.read()?.seed())
    }

    /// Poses, a copy: (n, 3) [x cm, y cm, heading rad counter-clockwise from x, not wrapped].
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flock = self.read()?;
        let rows = flock.poses().iter();
        rows_of_three(py, rows.map(|p| [p.position.x, p.position.y, p.heading]))
    }

    /// Velocities, a copy: (n, 3) [cm/s, cm/s, rad/s]. With the leapfrog scheme these are means over
    /// the last substep.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flock = self.read()?;
        let rows = flock.velocities().iter();
        rows_of_three(py, rows.map(|v| [v.linear.x, v.linear.y, v.angular]))
    }

    /// Time in s.
    #[getter]
    fn time_s(&self) -> Result<f64> {
        Ok(self.read()?.time_s())
    }

    /// Whether the flock is in the second half of fw or the first half of nop1 now.
    #[getter]
    fn in_analysis_window(&self) -> Result<bool> {
        let flock = self.read()?;
        Ok(flock.schedule().in_analysis_window(flock.time()))
    }

    /// Phase that holds from now on: "fw", "nop1", "bw" or "nop2".
    #[getter]
    fn phase(&self) -> Result<&'static str> {
        Ok(self.read()?.phase().phase.name())
    }

    /// What the substeps since the flock was made did: a `Statistics`.
    #[getter]
    fn statistics(&self) -> PyResult<PyStatistics> {
        Ok(self.read()?.statistics().into())
    }

    /// Threads that the substeps of 200 boats or more are shared out to: 1 to 1024, 1 by default. The motion is the
    /// same, bit for bit. Snapshots and pickles do not hold the number; `restore` and `reset` leave it. There are
    /// never more threads than RAYON_NUM_THREADS, or than cores where that is not set.
    #[getter]
    fn threads(&self) -> Result<usize> {
        Ok(self.read()?.threads())
    }

    #[setter]
    fn set_threads(&self, threads: Threads) -> Result<()> {
        let threads = usize::try_from(threads.0).unwrap_or(usize::MAX);
        self.0.write()?.set_threads(threads)
    }

    /// Put the boats somewhere else.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like, shape (n, 3)
    ///     [x cm, y cm, heading rad].
    /// velocity : array_like, shape (n, 3)
    ///     [cm/s, cm/s, rad/s].
    /// time_s : float
    ///     Time in s, 0 to 1e9.
    /// allow_overlap : bool
    ///     Accept hulls that overlap each other or a wall; they are moved apart in the next substeps.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For wrong shapes, numbers that are not finite, and overlaps; the flock is unchanged then.
    /// TypeError
    ///     For arrays that are not of real numbers.
    #[pyo3(
        signature = (pose, velocity, time_s=TimeS(0.0), *, allow_overlap=false),
        text_signature = "($self, pose, velocity, time_s=0.0, *, allow_overlap=False)"
    )]
    fn set_state(
        &self,
        pose: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        time_s: TimeS,
        allow_overlap: bool,
    ) -> PyResult<()> {
        let shape = [self.read()?.parameters().n_boats, 3];
        let pose = floats(pose, "pose", &shape)?;
        let velocity = floats(velocity, "velocity", &shape)?;
        let (poses, velocities) = (poses_of(&pose), velocities_of(&velocity));
        Ok(self
            .0
            .write()?
            .set_state(&poses, &velocities, time_s.0, allow_overlap)?)
    }

    /// Change the direction that the steering law heads for, "cw" or "ccw", or a list with one per leader.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For another name, and a list of another length; the flock is unchanged then.
    fn set_target(&self, target: &Bound<'_, PyAny>) -> PyResult<()> {
        let target = targets(target)?;
        self.0.write()?.set_target(target)?;
        Ok(())
    }

    /// Advance by a duration. Substeps end on multiples of dt_s, on phase switches and at the end.
    ///
    /// Parameters
    /// ----------
    /// seconds : float
    ///     Duration in s, at least 0.
    /// rudder : array_like, shape (k,), optional
    ///     Commands of the leaders in [-1, 1], held; positive turns a boat that moves forward
    ///     counter-clockwise. None: the steering law, eq. (10), at every substep.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For a duration or rudder out of range or of a wrong shape; the flock is unchanged then.
    /// SolverError
    ///     If the motion left its range of 1e9 (cm, cm/s, rad, rad/s); poses, velocities and time are those before the call.
    #[pyo3(signature = (seconds, rudder=None))]
    fn advance(
        &self,
        py: Python<'_>,
        seconds: Seconds,
        rudder: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let leaders = [self.read()?.parameters().n_leaders];
        let rudder = rudder.map(|rudder| floats(rudder, "rudder", &leaders));
        let rudder = rudder.transpose()?;
        let mut flock = self.0.write()?;
        let flock = &mut *flock;
        flock.check_rudder(rudder.as_deref())?;
        let end = flock.end_of(seconds.0)?;
        let steering = rudder.as_deref().map_or(Steering::Law, Steering::Held);
        advance_interruptibly(py, flock, end, steering)
    }

    /// Rudder commands of the steering law, eq. (10), for where the leaders are now: (k,).
    fn steering_law<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        let flock = self.read()?;
        let leaders = 0..flock.parameters().n_leaders;
        let rudders = leaders.map(|leader| flock.steering_law(leader));
        Ok(PyArray1::from_iter(py, rudders))
    }

    /// Order parameters of the normal boats, or of all boats, now: an `OrderParameters`.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     If there is no such boat.
    #[pyo3(signature = (include_leaders=false))]
    fn order_parameters(&self, include_leaders: bool) -> PyResult<PyOrderParameters> {
        Ok(PyOrderParameters(self.read()?.recorded(include_leaders)?))
    }

    /// Contacts and near-contacts of the last substep: a `Contacts`. None after a state was set or
    /// restored, until the next substep.
    fn contacts(&self, py: Python<'_>) -> PyResult<PyContacts> {
        PyContacts::of(py, &self.read()?.contacts())
    }

    /// The whole state as bytes; continuing from them is bit-identical on the same machine.
    fn snapshot<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.read()?.snapshot()))
    }

    /// Continue from a snapshot of a flock with the same parameters, the target aside.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     For bytes that are no whole, unharmed snapshot, or one of a flock with other parameters;
    ///     the flock is unchanged then.
    fn restore(&self, snapshot: &Bound<'_, PyBytes>) -> Result<()> {
        self.0.write()?.restore(snapshot.as_bytes())
    }

    fn __copy__(&self) -> Result<Self> {
        Ok(Self::of(self.read()?.clone()))
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Result<Self> {
        self.__copy__()
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let snapshot = slf.get().snapshot(slf.py())?;
        Ok((slf.get_type().getattr("from_snapshot")?, (snapshot,)))
    }

    /// The flock as a picture, for notebooks.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let png = FrameRenderer::new(NOTEBOOK_PIXELS, NOTEBOOK_PIXELS)?.png(&*self.read()?)?;
        let encoded = py
            .import("base64")?
            .call_method1("b64encode", (PyBytes::new(py, &png),))?;
        let encoded: String = encoded.call_method1("decode", ("ascii",))?.extract()?;
        let words = self.__repr__()?;
        let words = words.trim_matches(['<', '>']);
        Ok(format!(
            "<img alt=\"{words}\" src=\"data:image/png;base64,{encoded}\">"
        ))
    }

    fn __repr__(&self) -> Result<String> {
        let flock = self.read()?;
        let p = flock.parameters();
        Ok(format!(
            "<flockenv.Flock of {} boats, {} of them leaders, seed {}, time {} s>",
            p.n_boats,
            p.n_leaders,
            flock.seed(),
            flock.time_s()
        ))
    }
}

/// Width and height of a flock's picture in a notebook.
const NOTEBOOK_PIXELS: u32 = 400;

/// Work between two checks of Python's signals: about 30 ms.
pub(crate) const BOAT_SUBSTEPS_A_PIECE: u64 = 200_000;

/// Advances without the interpreter lock, letting Ctrl-C in between pieces that end on the substep
/// grid; whatever stops it leaves the flock as it was before.
fn advance_interruptibly(
    py: Python<'_>,
    flock: &mut Flock,
    end: Ticks,
    steering: Steering,
) -> PyResult<()> {
    let p = flock.parameters();
    let boat_substeps = seconds(end - flock.time()) / p.dt_s * p.n_boats as f64;
    if boat_substeps <= BOAT_SUBSTEPS_A_PIECE as f64 {
        return Ok(py.detach(|| flock.advance_to(end, steering))?);
    }
    let before = flock.clone();
    let outcome = advance_in_pieces(py, flock, end, steering);
    if outcome.is_err() {
        *flock = before;
    }
    outcome
}

fn advance_in_pieces(
    py: Python<'_>,
    flock: &mut Flock,
    end: Ticks,
    steering: Steering,
) -> PyResult<()> {
    while !py.detach(|| flock.advance_towards(end, steering, BOAT_SUBSTEPS_A_PIECE))? {
        py.check_signals()?;
    }
    Ok(())
}
