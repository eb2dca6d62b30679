//! `flockenv._core.EnvBatch`: what all environment classes sit on.

use super::arguments::{real, text, whole, wrong_type};
use super::flock::{PyFlock, state_from};
use super::parameters::to_python;
use super::settings::{settings_from, settings_to_dict, term_names};
use crate::environment::{
    BatchRows, EnvBatch, Episode, EpisodeSummary, FlockEnv, ResetRequest, Start, TERMS,
};
use crate::error::FlockError;
use crate::parameters::FlockParameters;
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
#[pyclass(name = "EnvBatch", module = "flockenv._core")]
pub struct PyEnvBatch(EnvBatch);

impl PyEnvBatch {
    fn env(&self, flock: usize) -> PyResult<&FlockEnv> {
        let envs = self.0.envs();
        Ok(envs.get(flock).ok_or_else(|| {
            FlockError::parameter("flock", flock, format!("0 to {}", envs.len() - 1))
        })?)
    }

    fn episode_of(&self, flock: usize) -> PyResult<&Episode> {
        let episode = self.env(flock)?.episode();
        Ok(episode
            .ok_or_else(|| FlockError::Episode("reset has not been called yet".to_owned()))?)
    }

    fn matrix<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        PyArray2::zeros(py, [self.0.rows(), self.0.observation_size()], false)
    }
}

#[pymethods]
impl PyEnvBatch {
    #[new]
    fn new(parameters: Vec<FlockParameters>, options: &Bound<'_, PyDict>) -> PyResult<Self> {
        Ok(Self(EnvBatch::new(settings_from(options)?, parameters)?))
    }

    #[getter]
    fn num_flocks(&self) -> usize {
        self.0.envs().len()
    }

    #[getter]
    fn leaders(&self) -> Vec<usize> {
        let envs = self.0.envs().iter();
        envs.map(|env| env.parameters().n_leaders).collect()
    }

    #[getter]
    fn observation_size(&self) -> usize {
        self.0.observation_size()
    }

    #[getter]
    fn episode_steps(&self) -> u32 {
        self.0.settings().episode.steps()
    }

    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        settings_to_dict(py, self.0.settings())
    }

    fn parameters<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self.env(flock)?.parameters())
    }

    fn step<'py>(
        &mut self,
        py: Python<'py>,
        actions: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Step<'py>> {
        // A copy, since other Python threads may write to the array meanwhile.
        let actions = actions.as_array().to_vec();
        let observations = self.matrix(py);
        let rewards = PyArray1::zeros(py, self.0.rows(), false);
        let truncated = PyArray1::zeros(py, self.0.envs().len(), false);
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
        py.detach(|| self.0.step(&actions, rows))?;
        Ok((observations, rewards, truncated))
    }

    fn reset(&mut self, py: Python<'_>, requests: Vec<Option<Bound<'_, PyDict>>>) -> PyResult<()> {
        let shapes: Vec<_> = self
            .0
            .envs()
            .iter()
            .map(|env| env.parameters().n_boats)
            .collect();
        let mut read = Vec::with_capacity(requests.len());
        for (flock, request) in requests.iter().enumerate() {
            let boats = shapes.get(flock).copied().unwrap_or_default();
            let request = request.as_ref().map(|request| request_from(request, boats));
            read.push(request.transpose()?);
        }
        Ok(py.detach(|| self.0.reset(&read))?)
    }

    fn observe<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let array = self.matrix(py);
        self.0.observe(array.readwrite().as_slice_mut()?);
        Ok(array)
    }

    fn final_observation<'py>(
        &self,
        py: Python<'py>,
        flock: usize,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let numbers = self.env(flock)?.final_observation();
        let size = self.0.observation_size();
        PyArray1::from_slice(py, numbers).reshape([numbers.len() / size, size])
    }

    fn final_state<'py>(
        &self,
        py: Python<'py>,
        flock: usize,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        Ok(PyArray1::from_slice(py, self.env(flock)?.final_state()))
    }

    fn state_size(&self, flock: usize) -> PyResult<usize> {
        Ok(self.env(flock)?.state_size())
    }

    fn state<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let env = self.env(flock)?;
        let array = PyArray1::zeros(py, env.state_size(), false);
        env.observe_state(array.readwrite().as_slice_mut()?);
        Ok(array)
    }

    /// Reward terms of the last step: (terms, rows).
    fn reward_terms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.0.rows();
        let mut terms = vec![0.0; TERMS * rows];
        let mut row = 0;
        for flock in 0..self.0.envs().len() {
            for own in self.episode_of(flock)?.terms() {
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
        let flocks = self.0.envs().len();
        let mut numbers = Vec::with_capacity(6 * flocks);
        for flock in 0..flocks {
            numbers.extend(self.episode_of(flock)?.order().map_or([f64::NAN; 6], |o| {
                [o.psi_o, o.phi_o, o.c_o, o.psi_v, o.phi_v, o.c_v]
            }));
        }
        PyArray1::from_vec(py, numbers).reshape([flocks, 6])
    }

    /// Whether each flock is in the analysis window.
    fn in_analysis_window<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let flocks = 0..self.0.envs().len();
        let windows: PyResult<Vec<bool>> = flocks
            .map(|flock| {
                let flock = self.episode_of(flock)?.flock();
                Ok(flock.schedule().in_analysis_window(flock.time()))
            })
            .collect();
        Ok(PyArray1::from_vec(py, windows?))
    }

    /// Rudders as they stand: (rows,), positive counter-clockwise.
    fn rudders<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut rudders = Vec::with_capacity(self.0.rows());
        for flock in 0..self.0.envs().len() {
            rudders.extend_from_slice(self.episode_of(flock)?.rudders());
        }
        Ok(PyArray1::from_vec(py, rudders))
    }

    /// Whether a flock has ever been given a seed.
    fn is_seeded(&self, flock: usize) -> PyResult<bool> {
        Ok(self.env(flock)?.is_seeded())
    }

    /// Whether a flock has an episode under way.
    fn is_running(&self, flock: usize) -> PyResult<bool> {
        Ok(self
            .env(flock)?
            .episode()
            .is_some_and(|episode| !episode.has_ended()))
    }

    /// A copy of a flock.
    fn flock(&self, flock: usize) -> PyResult<PyFlock> {
        Ok(PyFlock(self.episode_of(flock)?.flock().clone()))
    }

    /// A flock's target, step, backward duration and seed.
    fn episode<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        let schedule = self.episode_of(flock)?.schedule();
        let dict = PyDict::new(py);
        dict.set_item("target", schedule.target().name())?;
        dict.set_item("bw_s", schedule.bw_s)?;
        dict.set_item("flock_seed", schedule.flock_seed)?;
        dict.set_item("step", schedule.step)?;
        Ok(dict)
    }

    /// Summary of the episode under way.
    fn summary<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        summary_dict(py, &self.episode_of(flock)?.summary())
    }

    /// Summary of the last episode that reached its end.
    fn finished<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Option<Bound<'py, PyDict>>> {
        let summary = self.env(flock)?.finished();
        summary.map(|summary| summary_dict(py, summary)).transpose()
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.to_bytes())
    }

    #[classmethod]
    fn from_bytes(_class: &Bound<'_, PyType>, state: &Bound<'_, PyBytes>) -> PyResult<Self> {
        Ok(Self(EnvBatch::from_bytes(state.as_bytes())?))
    }

    fn restore(&mut self, state: &Bound<'_, PyBytes>) -> PyResult<()> {
        Ok(self.0.restore(state.as_bytes())?)
    }

    fn __copy__(&self) -> Self {
        Self(self.0.clone())
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        Self(self.0.clone())
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let class = py.get_type::<Self>();
        Ok((class.getattr("from_bytes")?, (self.to_bytes(py),)))
    }
}

fn summary_dict<'py>(py: Python<'py>, summary: &EpisodeSummary) -> PyResult<Bound<'py, PyDict>> {
    let terms = PyDict::new(py);
    for (name, mean) in term_names(py).iter().zip(summary.terms) {
        terms.set_item(name, mean)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("flock_seed", summary.flock_seed)?;
    dict.set_item("bw_s", summary.bw_s)?;
    dict.set_item("steps", summary.steps)?;
    dict.set_item("total_reward", summary.total_reward)?;
    dict.set_item("reward_terms", terms)?;
    for (name, mean) in [
        ("signed_order", summary.signed_order),
        ("psi_o", summary.psi_o),
        ("share_towards_target", summary.share_towards_target),
    ] {
        // A mean over an analysis window that the episode did not reach: infos hold no NaN.
        if !mean.is_nan() {
            dict.set_item(name, mean)?;
        }
    }
    let [printed, wide] = summary.ordering_times_s;
    dict.set_item("ordering_time_s", printed)?;
    dict.set_item("ordering_time_wide_s", wide)?;
    dict.set_item("clip_rate", summary.clip_rate)?;
    Ok(dict)
}

/// A request of a flock of so many boats.
fn request_from(options: &Bound<'_, PyDict>, boats: usize) -> PyResult<ResetRequest> {
    let mut request = ResetRequest::default();
    for (name, value) in options {
        match text(&name, "reset option")?.as_str() {
            "seed" if value.is_none() => request.seed = None,
            "seed" => request.seed = Some(whole(&value, "seed")?),
            "target" => request.target = Some(text(&value, "target")?.parse()?),
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
    let begins_twice = options.contains("state")? && options.contains("snapshot")?;
    let noise_twice = options.contains("bw_s")? && options.contains("snapshot")?;
    if begins_twice || noise_twice {
        let accepted = "a snapshot alone: it brings its own state and bw_s along";
        return Err(FlockError::parameter("reset options", "snapshot and others", accepted).into());
    }
    Ok(request)
}

fn snapshot_from(value: &Bound<'_, PyAny>) -> PyResult<Start> {
    let bytes = value.cast::<PyBytes>();
    let bytes = bytes.map_err(|_| wrong_type(value, "snapshot", "bytes of Flock.snapshot"))?;
    Ok(Start::Snapshot(bytes.as_bytes().to_vec()))
}
