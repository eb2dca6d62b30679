//! `flockenv._core.EnvBatch`: what all environment classes sit on.

use super::exclusive::{Exclusive, interruptible};
use super::flock::PyFlock;
use super::parameters::{to_python, written};
use super::settings::{settings_from, settings_to_dict};
use super::state::request_from;
use super::summary::{add_leaders, summary_dict};
use crate::environment::observation::FlockFeatures;
use crate::environment::{BatchRows, EnvBatch, Episode, FlockEnv, TERMS};
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, Value};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};

/// What a step returns: observations (rows, size), rewards (rows,), truncated (flocks,).
type Step<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
);

/// Many flocks with their episodes, stepped at once; one row per leader, flock after flock.
#[pyclass(name = "EnvBatch", module = "flockenv._core", frozen)]
pub struct PyEnvBatch(Exclusive<EnvBatch>);

impl PyEnvBatch {
    fn of(batch: EnvBatch) -> Self {
        Self(Exclusive::new(batch, "the environment"))
    }

    /// Some numbers of one flock: an array of its own.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        flock: usize,
        of: fn(&FlockEnv) -> &[f32],
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let batch = self.0.read()?;
        Ok(PyArray1::from_slice(py, of(env_of(&batch, flock)?)))
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

fn matrix<'py>(py: Python<'py>, batch: &EnvBatch) -> Bound<'py, PyArray2<f32>> {
    PyArray2::zeros(py, [batch.rows(), batch.observation_size()], false)
}

#[pymethods]
impl PyEnvBatch {
    #[new]
    fn new(parameters: Vec<FlockParameters>, options: &Bound<'_, PyDict>) -> PyResult<Self> {
        let batch = EnvBatch::new(settings_from(options)?, parameters)?;
        Ok(Self::of(batch))
    }

    #[getter]
    fn num_flocks(&self) -> Result<usize> {
        Ok(self.0.read()?.envs().len())
    }

    #[getter]
    fn leaders(&self) -> Result<Vec<usize>> {
        let batch = self.0.read()?;
        let envs = batch.envs().iter();
        Ok(envs.map(|env| env.parameters().n_leaders).collect())
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
        settings_to_dict(py, self.0.read()?.settings())
    }

    fn parameters<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyAny>> {
        let batch = self.0.read()?;
        to_python(py, env_of(&batch, flock)?.parameters())
    }

    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Step<'py>> {
        let mut batch = self.0.write()?;
        let batch = &mut *batch;
        // A copy, since other Python threads may write to the array meanwhile.
        let actions = actions.as_array().to_vec();
        let observations = matrix(py, batch);
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

    fn reset(&self, py: Python<'_>, requests: Vec<Option<Bound<'_, PyDict>>>) -> PyResult<()> {
        let shapes: Vec<_> = {
            let batch = self.0.read()?;
            let envs = batch.envs().iter();
            envs.map(|env| env.parameters().n_boats).collect()
        };
        let mut read = Vec::with_capacity(requests.len());
        for (flock, request) in requests.iter().enumerate() {
            let boats = shapes.get(flock).copied().unwrap_or_default();
            let request = request.as_ref().map(|request| request_from(request, boats));
            read.push(request.transpose()?);
        }
        let requested = shapes.iter().zip(&read);
        let boats = requested.filter_map(|(boats, request)| request.as_ref().map(|_| boats));
        let boats = boats.sum();
        let mut batch = self.0.write()?;
        let batch = &mut *batch;
        interruptible(py, boats, |keep_going| batch.reset_while(keep_going, &read))
    }

    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mut batch = self.0.write()?;
        if batch.envs().iter().all(|env| env.episode().is_none()) {
            return Err(never_reset().into());
        }
        let array = matrix(py, &batch);
        batch.observe(array.readwrite().as_slice_mut()?);
        Ok(array)
    }

    fn final_observation<'py>(
        &self,
        py: Python<'py>,
        flock: usize,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let batch = self.0.read()?;
        let numbers = env_of(&batch, flock)?.final_observation();
        let size = batch.observation_size();
        PyArray1::from_slice(py, numbers).reshape([numbers.len() / size, size])
    }

    fn final_state<'py>(
        &self,
        py: Python<'py>,
        flock: usize,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.numbers(py, flock, FlockEnv::final_state)
    }

    /// Features of the flock for a leader at the end of the episode that ended in the last step.
    #[pyo3(signature = (flock, leader=0))]
    fn final_flock_features<'py>(
        &self,
        py: Python<'py>,
        flock: usize,
        leader: usize,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let batch = self.0.read()?;
        let features = env_of(&batch, flock)?.final_features(leader);
        Ok(PyArray1::from_slice(py, features))
    }

    /// Features of its flock for every leader, in the frame of its own target: (rows, features).
    fn leader_features<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let batch = self.0.read()?;
        let array = PyArray2::zeros(py, [batch.rows(), FlockFeatures::SIZE], false);
        let mut numbers = array.readwrite();
        let mut rest = numbers.as_slice_mut()?;
        for env in batch.envs() {
            env.episode().ok_or_else(never_reset)?;
            let (own, others) = rest.split_at_mut(env.parameters().n_leaders * FlockFeatures::SIZE);
            env.observe_features(own);
            rest = others;
        }
        drop(numbers);
        Ok(array)
    }

    fn state_size(&self, flock: usize) -> PyResult<usize> {
        let batch = self.0.read()?;
        Ok(env_of(&batch, flock)?.state_size())
    }

    fn state<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let batch = self.0.read()?;
        let env = env_of(&batch, flock)?;
        env.episode().ok_or_else(never_reset)?;
        let array = PyArray1::zeros(py, env.state_size(), false);
        env.observe_state(array.readwrite().as_slice_mut()?);
        Ok(array)
    }

    /// Global states of every flock, which have equally many boats: (flocks, state size).
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let batch = self.0.read()?;
        let size = batch.envs().first().map_or(0, FlockEnv::state_size);
        if batch.envs().iter().any(|env| env.state_size() != size) {
            return Err(FlockError::parameter("n_boats", "of flocks", "equal numbers").into());
        }
        let array = PyArray2::zeros(py, [batch.envs().len(), size], false);
        let mut numbers = array.readwrite();
        let rows = numbers.as_slice_mut()?.chunks_exact_mut(size.max(1));
        for (env, row) in batch.envs().iter().zip(rows) {
            env.episode().ok_or_else(never_reset)?;
            env.observe_state(row);
        }
        drop(numbers);
        Ok(array)
    }

    /// Features of every flock: (flocks, features).
    fn flock_features<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let batch = self.0.read()?;
        let array = PyArray2::zeros(py, [batch.envs().len(), FlockFeatures::SIZE], false);
        let mut numbers = array.readwrite();
        let rows = numbers
            .as_slice_mut()?
            .chunks_exact_mut(FlockFeatures::SIZE);
        for (env, row) in batch.envs().iter().zip(rows) {
            env.episode().ok_or_else(never_reset)?;
            env.observe_features(row);
        }
        drop(numbers);
        Ok(array)
    }

    /// Reward terms of the last step: (terms, rows).
    fn reward_terms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let batch = self.0.read()?;
        let rows = batch.rows();
        let mut terms = vec![0.0; TERMS * rows];
        let mut row = 0;
        for flock in 0..batch.envs().len() {
            for own in episode_of(&batch, flock)?.terms() {
                for (term, &value) in own.iter().enumerate() {
                    terms[term * rows + row] = value;
                }
                row += 1;
            }
        }
        PyArray1::from_vec(py, terms).reshape([TERMS, rows])
    }

    /// Order parameters of the normal boats: (flocks, 6) [psi_o, phi_o, c_o, psi_v, phi_v, c_v], NaN
    /// where a flock has none.
    fn order_parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let batch = self.0.read()?;
        let flocks = batch.envs().len();
        let mut numbers = Vec::with_capacity(6 * flocks);
        for flock in 0..flocks {
            numbers.extend(
                episode_of(&batch, flock)?
                    .order()
                    .map_or([f64::NAN; 6], |o| {
                        [o.psi_o, o.phi_o, o.c_o, o.psi_v, o.phi_v, o.c_v]
                    }),
            );
        }
        PyArray1::from_vec(py, numbers).reshape([flocks, 6])
    }

    /// Whether each flock is in the analysis window.
    fn in_analysis_window<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let batch = self.0.read()?;
        let flocks = 0..batch.envs().len();
        let windows: PyResult<Vec<bool>> = flocks
            .map(|flock| {
                let flock = episode_of(&batch, flock)?.flock();
                Ok(flock.schedule().in_analysis_window(flock.time()))
            })
            .collect();
        Ok(PyArray1::from_vec(py, windows?))
    }

    /// Rudders as they stand: (rows,), positive counter-clockwise.
    fn rudders<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let batch = self.0.read()?;
        let mut rudders = Vec::with_capacity(batch.rows());
        for flock in 0..batch.envs().len() {
            rudders.extend_from_slice(episode_of(&batch, flock)?.rudders());
        }
        Ok(PyArray1::from_vec(py, rudders))
    }

    /// Whether a flock has ever been given a seed.
    fn is_seeded(&self, flock: usize) -> PyResult<bool> {
        let batch = self.0.read()?;
        Ok(env_of(&batch, flock)?.is_seeded())
    }

    /// Whether a flock has an episode under way.
    fn is_running(&self, flock: usize) -> PyResult<bool> {
        let batch = self.0.read()?;
        Ok(env_of(&batch, flock)?
            .episode()
            .is_some_and(|episode| !episode.has_ended()))
    }

    /// A copy of a flock.
    fn flock(&self, flock: usize) -> PyResult<PyFlock> {
        let batch = self.0.read()?;
        Ok(PyFlock::of(episode_of(&batch, flock)?.flock().clone()))
    }

    /// A flock's target, step, backward duration and seed.
    fn episode<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        let batch = self.0.read()?;
        let schedule = episode_of(&batch, flock)?.schedule();
        let dict = PyDict::new(py);
        dict.set_item("target", written(&Value::from(&schedule.targets()), py)?)?;
        dict.set_item("bw_s", schedule.bw_s)?;
        dict.set_item("flock_seed", schedule.flock_seed)?;
        dict.set_item("step", schedule.step)?;
        Ok(dict)
    }

    /// Summary of the episode under way.
    fn summary<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        let batch = self.0.read()?;
        let episode = episode_of(&batch, flock)?;
        let dict = summary_dict(py, &episode.summary())?;
        add_leaders(&dict, &episode.leader_summaries())?;
        Ok(dict)
    }

    /// Summary of the last episode that reached its end.
    fn finished<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Option<Bound<'py, PyDict>>> {
        let batch = self.0.read()?;
        let env = env_of(&batch, flock)?;
        let dict = env.finished().map(|summary| summary_dict(py, summary));
        if let Some(Ok(dict)) = &dict {
            add_leaders(dict, env.finished_leaders())?;
        }
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

    fn __copy__(&self) -> Result<Self> {
        Ok(Self::of(self.0.read()?.clone()))
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Result<Self> {
        self.__copy__()
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let class = py.get_type::<Self>();
        Ok((class.getattr("from_bytes")?, (self.to_bytes(py)?,)))
    }
}
