//! `flockenv._core.EnvBatch`: what all environment classes sit on.

use super::arguments::floats;
use super::exclusive::{Exclusive, interruptible};
use super::flock::PyFlock;
use super::parameters::to_dict;
use super::state::request_from;
use super::summary::{episode_dict, summary_dict};
use super::value::{options_dict, settings_from};
use crate::environment::observation::FlockFeatures;
use crate::environment::{BatchRows, EnvBatch, Episode, FlockEnv, TERMS};
use crate::error::{FlockError, Result};
use crate::parameters::FlockParameters;
use numpy::{Element, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};

/// What a step returns: observations (rows, size), rewards (rows,), truncated (flocks,).
type Step<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
);

/// Observations (leaders, size), the global state, and features of the flock (leaders, features).
type Views<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray2<f32>>,
);

/// Many flocks with their episodes, stepped at once; one row per leader, flock after flock.
#[pyclass(name = "EnvBatch", module = "flockenv._core", frozen)]
pub struct PyEnvBatch(Exclusive<EnvBatch>);

impl PyEnvBatch {
    fn of(batch: EnvBatch) -> Self {
        Self(Exclusive::new(batch, "the environment"))
    }

    /// Numbers of every flock's episode, as rows of so many.
    fn gathered<'py, T: Element>(
        &self,
        py: Python<'py>,
        columns: usize,
        append: impl Fn(&FlockEnv, &Episode, &mut Vec<T>),
    ) -> PyResult<Bound<'py, PyArray2<T>>> {
        let batch = self.0.read()?;
        let mut numbers = Vec::new();
        for env in batch.envs() {
            append(env, env.episode().ok_or_else(never_reset)?, &mut numbers);
        }
        let rows = numbers.len() / columns;
        PyArray1::from_vec(py, numbers).reshape([rows, columns])
    }

    /// Three numbers of every boat: (flocks, boats, 3).
    fn of_boats<'py>(
        &self,
        py: Python<'py>,
        append: impl Fn(&Episode, &mut Vec<f64>),
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let rows = self.gathered(py, 3, |_, episode, numbers| append(episode, numbers))?;
        let flocks = self.0.read()?.envs().len();
        rows.reshape([flocks, rows.len()? / flocks, 3])
    }
}

fn env_of(batch: &EnvBatch, flock: usize) -> Result<&FlockEnv> {
    let envs = batch.envs();
    envs.get(flock)
        .ok_or_else(|| FlockError::parameter("flock", flock, format!("0 to {}", envs.len() - 1)))
}

fn episode_of(batch: &EnvBatch, flock: usize) -> Result<&Episode> {
    env_of(batch, flock)?.episode().ok_or_else(never_reset)
}

fn never_reset() -> FlockError {
    FlockError::Episode("reset has not been called yet".to_owned())
}

/// Appends zeros that `fill` then writes.
fn appended(numbers: &mut Vec<f32>, count: usize, fill: impl FnOnce(&mut [f32])) {
    let start = numbers.len();
    numbers.resize(start + count, 0.0);
    fill(&mut numbers[start..]);
}

#[pymethods]
impl PyEnvBatch {
    #[new]
    fn new(parameters: Vec<FlockParameters>, options: &Bound<'_, PyDict>) -> PyResult<Self> {
        let batch = EnvBatch::new(settings_from(options)?, parameters)?;
        Ok(Self::of(batch))
    }

    #[getter]
    fn observation_size(&self) -> Result<usize> {
        Ok(self.0.read()?.observation_size())
    }

    #[getter]
    fn episode_steps(&self) -> Result<u32> {
        Ok(self.0.read()?.settings().episode.steps())
    }

    #[getter]
    fn period_steps(&self) -> Result<u32> {
        Ok(self.0.read()?.settings().period_steps())
    }

    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        options_dict(py, self.0.read()?.settings())
    }

    fn parameters<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        let batch = self.0.read()?;
        to_dict(py, env_of(&batch, flock)?.parameters())
    }

    /// One decision of every flock. The actions are copied, since other Python threads may write to them meanwhile.
    fn step<'py>(&self, py: Python<'py>, actions: &Bound<'py, PyAny>) -> PyResult<Step<'py>> {
        let mut batch = self.0.write()?;
        let batch = &mut *batch;
        let actions = floats(actions, "actions", &[batch.rows()])?;
        let shape = [batch.rows(), batch.observation_size()];
        let observations = PyArray2::zeros(py, shape, false);
        let rewards = PyArray1::zeros(py, batch.rows(), false);
        let truncated = PyArray1::zeros(py, batch.envs().len(), false);
        let (mut o, mut r, mut t) = (
            observations.readwrite(),
            rewards.readwrite(),
            truncated.readwrite(),
        );
        let rows = BatchRows {
            observations: o.as_slice_mut()?,
            rewards: r.as_slice_mut()?,
            truncated: t.as_slice_mut()?,
        };
        py.detach(|| batch.step(&actions, rows))?;
        Ok((observations, rewards, truncated))
    }

    /// Starts episodes: one request per flock, `None` leaves it as it is.
    fn reset(&self, py: Python<'_>, requests: Vec<Option<Bound<'_, PyDict>>>) -> PyResult<()> {
        let mut batch = self.0.write()?;
        let batch = &mut *batch;
        let each = requests.iter().enumerate().map(|(flock, request)| {
            let boats = batch.envs().get(flock);
            let boats = boats.map_or(0, |env| env.parameters().n_boats);
            let request = request.as_ref().map(|request| request_from(request, boats));
            request.transpose()
        });
        let requests: Vec<_> = each.collect::<PyResult<_>>()?;
        interruptible(py, |keep_going| batch.reset_while(keep_going, &requests))
    }

    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mut batch = self.0.write()?;
        if batch.envs().iter().all(|env| env.episode().is_none()) {
            return Err(never_reset().into());
        }
        let array = PyArray2::zeros(py, [batch.rows(), batch.observation_size()], false);
        batch.observe(array.readwrite().as_slice_mut()?);
        Ok(array)
    }

    /// What the episode that ended in the last step ended with; features are empty after a restore.
    fn last_views<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Views<'py>> {
        let batch = self.0.read()?;
        let env = env_of(&batch, flock)?;
        let rows = |numbers: &[f32], size: usize| {
            PyArray1::from_slice(py, numbers).reshape([numbers.len() / size, size])
        };
        let leaders = 0..env.parameters().n_leaders;
        let features: Vec<f32> = leaders
            .flat_map(|leader| env.final_features(leader).to_vec())
            .collect();
        Ok((
            rows(env.final_observation(), batch.observation_size())?,
            PyArray1::from_slice(py, env.final_state()),
            rows(&features, FlockFeatures::SIZE)?,
        ))
    }

    /// Features of every flock in the frame of its target, (flocks, features), or of each leader's flock in the frame
    /// of its own, (rows, features).
    fn flock_features<'py>(
        &self,
        py: Python<'py>,
        each_leader: bool,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.gathered(py, FlockFeatures::SIZE, |env, _, numbers| {
            let leaders = env.parameters().n_leaders;
            let rows = if each_leader { leaders } else { 1 };
            appended(numbers, rows * FlockFeatures::SIZE, |out| {
                env.observe_features(out);
            });
        })
    }

    /// Global states of every flock, which have equally many boats: (flocks, state size).
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let size = self
            .0
            .read()?
            .envs()
            .first()
            .map_or(1, FlockEnv::state_size);
        self.gathered(py, size, |env, _, numbers| {
            appended(numbers, env.state_size(), |out| env.observe_state(out));
        })
    }

    /// Reward terms of the last step: (rows, terms).
    fn reward_terms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.gathered(py, TERMS, |_, episode, numbers| {
            numbers.extend(episode.terms().iter().flatten());
        })
    }

    /// Order parameters of the normal boats: (flocks, 6) [psi_o, phi_o, c_o, psi_v, phi_v, c_v], NaN
    /// where a flock has none.
    fn order_parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.gathered(py, 6, |_, episode, numbers| {
            let order = episode.order();
            numbers.extend(order.map_or([f64::NAN; 6], |o| {
                [o.psi_o, o.phi_o, o.c_o, o.psi_v, o.phi_v, o.c_v]
            }));
        })
    }

    /// Poses of all boats: (flocks, boats, 3).
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.of_boats(py, |episode, numbers| {
            let poses = episode.flock().poses().iter();
            numbers.extend(poses.flat_map(|p| [p.position.x, p.position.y, p.heading]));
        })
    }

    /// Velocities of all boats: (flocks, boats, 3).
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        self.of_boats(py, |episode, numbers| {
            let velocities = episode.flock().velocities().iter();
            numbers.extend(velocities.flat_map(|v| [v.linear.x, v.linear.y, v.angular]));
        })
    }

    /// Whether each flock is in the analysis window: (flocks, 1).
    fn in_analysis_window<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        self.gathered(py, 1, |_, episode, windows| {
            let flock = episode.flock();
            windows.push(flock.schedule().in_analysis_window(flock.time()));
        })
    }

    /// Rudders as they stand: (rows, 1), positive counter-clockwise.
    fn rudders<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.gathered(py, 1, |_, episode, rudders| {
            rudders.extend_from_slice(episode.rudders());
        })
    }

    /// Whether a flock has ever been given a seed.
    fn is_seeded(&self, flock: usize) -> Result<bool> {
        Ok(env_of(&*self.0.read()?, flock)?.is_seeded())
    }

    /// Whether a flock has an episode under way.
    fn is_running(&self, flock: usize) -> Result<bool> {
        let batch = self.0.read()?;
        let episode = env_of(&batch, flock)?.episode();
        Ok(episode.is_some_and(|episode| !episode.has_ended()))
    }

    /// A copy of a flock.
    fn flock(&self, flock: usize) -> Result<PyFlock> {
        let batch = self.0.read()?;
        Ok(PyFlock::of(episode_of(&batch, flock)?.flock().clone()))
    }

    /// A flock's target, step, backward duration and seed.
    fn episode<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        episode_dict(py, episode_of(&*self.0.read()?, flock)?.schedule())
    }

    /// Summary of the episode under way.
    fn summary<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        let batch = self.0.read()?;
        let episode = episode_of(&batch, flock)?;
        summary_dict(py, &episode.summary(), &episode.leader_summaries())
    }

    /// Summary of the last episode that reached its end.
    fn finished<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Option<Bound<'py, PyDict>>> {
        let batch = self.0.read()?;
        let env = env_of(&batch, flock)?;
        let summary = env.finished();
        let dict = summary.map(|summary| summary_dict(py, summary, env.finished_leaders()));
        dict.transpose()
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.0.read()?.to_bytes()))
    }

    #[classmethod]
    fn from_bytes(_class: &Bound<'_, PyType>, state: &Bound<'_, PyBytes>) -> PyResult<Self> {
        Ok(Self::of(EnvBatch::from_bytes(state.as_bytes())?))
    }

    fn restore(&self, state: &Bound<'_, PyBytes>) -> Result<()> {
        self.0.write()?.restore(state.as_bytes())
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Result<Self> {
        Ok(Self::of(self.0.read()?.clone()))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let class = py.get_type::<Self>();
        Ok((class.getattr("from_bytes")?, (self.to_bytes(py)?,)))
    }
}
