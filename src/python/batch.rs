//! `flockenv._core.EnvBatch`: the batch behind all environment classes.

use super::arrays::{floats, rows_of};
use super::exclusive::{Exclusive, interruptible};
use super::flock::{PyFlock, pose_numbers, state_from, velocity_numbers};
use super::observation::layout_from;
use super::parameters::PyParameters;
use super::value::{argument, noise_seed_from, seed_from, set_fields, value_from};
use crate::analysis::quantities::RECORDED;
use crate::environment::observation::FlockFeatures;
use crate::environment::{
    BatchRows, EnvBatch, EnvSettings, Episode, EpisodeSummary, FlockEnv, ResetRequest, Start,
    TERMS, Upcoming,
};
use crate::error::{FlockError, Result};
use crate::flock::Flock;
use crate::parameters::{Field, FlockParameters, Setting, Value, named_fields, text_of};
use numpy::{Element, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};

/// Arrays of a step: observations (rows, size), rewards (rows,), truncated (flocks,).
type Step<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
);

/// An array with one row per flock, boat or leader.
type Rows<'py, T> = PyResult<Bound<'py, PyArray2<T>>>;

/// Many flocks with their episodes, stepped together. Arrays have one row per leader, flock after flock.
#[pyclass(name = "EnvBatch", module = "flockenv._core", frozen)]
pub(super) struct PyEnvBatch(Exclusive<EnvBatch>);

impl PyEnvBatch {
    fn wrap(batch: EnvBatch) -> Self {
        Self(Exclusive::new(batch, "the environment"))
    }

    /// Applies `read` to a flock's environment.
    fn read_env<T>(&self, flock: usize, read: impl FnOnce(&FlockEnv) -> T) -> Result<T> {
        let batch = self.0.read()?;
        let refuse = || {
            let accepted = format!("0 to {}", batch.envs().len() - 1);
            FlockError::parameter("flock", flock, accepted)
        };
        batch.envs().get(flock).map(read).ok_or_else(refuse)
    }

    /// Applies `read` to a flock's episode.
    fn read_episode<T>(&self, flock: usize, read: impl FnOnce(&Episode) -> T) -> Result<T> {
        let result = self.read_env(flock, |env| env.episode().map(read))?;
        result.ok_or_else(never_reset)
    }

    /// Collects numbers from every flock's episode, as rows of `columns` numbers.
    fn collect_rows<'py, T: Element>(
        &self,
        py: Python<'py>,
        columns: usize,
        numbers: impl Fn(&FlockEnv, &Episode) -> Vec<T>,
    ) -> Rows<'py, T> {
        let batch = self.0.read()?;
        let mut collected = Vec::new();
        for env in batch.envs() {
            collected.extend(numbers(env, env.episode().ok_or_else(never_reset)?));
        }
        rows_of(py, collected, columns)
    }
}

/// The error for a flock without an episode.
fn never_reset() -> FlockError {
    FlockError::Episode("reset has not been called yet".to_owned())
}

/// A vector of `count` numbers that `fill` writes.
fn filled_vec(count: usize, fill: impl FnOnce(&mut [f32])) -> Vec<f32> {
    let mut numbers = vec![0.0; count];
    fill(&mut numbers);
    numbers
}

#[pymethods]
impl PyEnvBatch {
    #[new]
    fn new(parameters: Vec<FlockParameters>, options: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut settings = EnvSettings::default();
        set_fields(&mut settings, EnvSettings::FIELDS, options)?;
        Ok(Self::wrap(EnvBatch::new(settings, parameters)?))
    }

    /// Numbers per observation, control steps per episode, and control steps per decision.
    #[getter]
    fn sizes(&self) -> Result<(usize, u32, u32)> {
        let batch = self.0.read()?;
        let (settings, size) = (batch.settings(), batch.observation_size());
        Ok((size, settings.steps(), settings.period_steps()))
    }

    #[getter]
    fn options(&self) -> Result<Value> {
        let batch = self.0.read()?;
        Ok(Field::values(EnvSettings::FIELDS, batch.settings()))
    }

    fn parameters(&self, flock: usize) -> Result<PyParameters> {
        self.read_env(flock, |env| PyParameters(env.parameters().clone()))
    }

    /// Takes one decision in every flock. The actions are copied, since other Python threads may write to them
    /// meanwhile. `None`: leaders follow the steering law at every substep.
    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Step<'py>> {
        let mut batch = self.0.write()?;
        let batch = &mut *batch;
        let rows = [batch.rows()];
        let actions = actions.map(|actions| floats(actions, "actions", &rows));
        let actions = actions.transpose()?;
        let size = batch.observation_size();
        let mut observations = vec![0.0; batch.rows() * size];
        let mut rewards = vec![0.0; batch.rows()];
        let mut truncated = vec![false; batch.envs().len()];
        let rows = BatchRows {
            observations: &mut observations,
            rewards: &mut rewards,
            truncated: &mut truncated,
        };
        interruptible(py, |keep_going| {
            batch.step_while(keep_going, actions.as_deref(), rows)
        })?;
        Ok((
            rows_of(py, observations, size)?,
            PyArray1::from_vec(py, rewards),
            PyArray1::from_vec(py, truncated),
        ))
    }

    /// Adds one number per row to the rewards of the last step.
    fn add_rewards(&self, rewards: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut batch = self.0.write()?;
        let rewards = floats(rewards, "rewards", &[batch.rows()])?;
        batch.add_rewards(&rewards);
        Ok(())
    }

    /// Starts episodes: one request per flock; `None` leaves a flock unchanged.
    fn reset(&self, py: Python<'_>, requests: Vec<Option<Bound<'_, PyDict>>>) -> PyResult<()> {
        let mut batch = self.0.write()?;
        let batch = &mut *batch;
        let requests = requests.iter().enumerate().map(|(flock, request)| {
            // `reset_while` refuses more requests than flocks.
            let env = batch.envs().get(flock);
            let boats = env.map_or(0, |env| env.parameters().n_boats);
            let request = request.as_ref().map(|request| request_from(request, boats));
            request.transpose()
        });
        let requests: Vec<_> = requests.collect::<PyResult<_>>()?;
        interruptible(py, |keep_going| batch.reset_while(keep_going, &requests))
    }

    /// Sets the target or the bw_s of flocks' future episodes.
    fn set_upcoming(&self, flocks: Vec<usize>, options: &Bound<'_, PyDict>) -> PyResult<()> {
        // These options hold no state, so the number of boats does not matter.
        let boats = 0;
        let ResetRequest { target, bw_s, .. } = request_from(options, boats)?;
        let upcoming = Upcoming { target, bw_s };
        Ok(self.0.write()?.set_upcoming(&flocks, &upcoming)?)
    }

    /// The target and the bw_s of a flock's future episodes.
    fn upcoming(&self, flock: usize) -> Result<Value> {
        let batch = self.0.read()?;
        self.read_env(flock, |env| {
            let EnvSettings { target, bw_s, .. } = env.upcoming().settings(batch.settings());
            let bw_s = bw_s.map_or(env.parameters().bw_s.value(), |bw_s| bw_s.value());
            [("target", target.value()), ("bw_s", bw_s)]
                .into_iter()
                .collect()
        })
    }

    fn observe<'py>(&self, py: Python<'py>) -> Rows<'py, f32> {
        let mut batch = self.0.write()?;
        if batch.envs().iter().all(|env| env.episode().is_none()) {
            return Err(never_reset().into());
        }
        let size = batch.observation_size();
        let observations = filled_vec(batch.rows() * size, |out| batch.observe(out));
        rows_of(py, observations, size)
    }

    /// The leaders' present observations in another layout: (rows, size). With `mirror_to_target`, those of leaders with a
    /// counter-clockwise target are mirrored.
    fn observe_in<'py>(
        &self,
        py: Python<'py>,
        blocks: &Bound<'py, PyAny>,
        mirror_to_target: bool,
    ) -> Rows<'py, f32> {
        let batch = self.0.read()?;
        let layout = layout_from(blocks, mirror_to_target)?;
        let mut observations = vec![0.0; batch.rows() * layout.size()];
        batch.observe_in(layout, &mut observations)?;
        rows_of(py, observations, layout.size())
    }

    /// The signs of the leaders' present targets: (rows, 1), 1 for clockwise, −1 for counter-clockwise.
    fn target_signs<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.collect_rows(py, 1, |env, episode| {
            let leaders = 0..env.parameters().n_leaders;
            let signs = leaders.map(|leader| episode.targets().of(leader).sign());
            signs.collect()
        })
    }

    /// The observations that the last episode ended with: (leaders, size).
    fn final_observation<'py>(&self, py: Python<'py>, flock: usize) -> Rows<'py, f32> {
        let size = self.0.read()?.observation_size();
        let observations = self.read_env(flock, |env| env.final_observation().to_vec())?;
        rows_of(py, observations, size)
    }

    /// Features of every flock in the frame of its target: (flocks, features). With `each_leader`, in the frame of each
    /// leader's target: (rows, features).
    fn flock_features<'py>(&self, py: Python<'py>, each_leader: bool) -> Rows<'py, f32> {
        self.collect_rows(py, FlockFeatures::SIZE, |env, _| {
            let leaders = env.parameters().n_leaders;
            let rows = if each_leader { leaders } else { 1 };
            filled_vec(rows * FlockFeatures::SIZE, |out| env.observe_features(out))
        })
    }

    /// Global state of every flock: (flocks, state size). All flocks must have the same number of boats.
    fn states<'py>(&self, py: Python<'py>) -> Rows<'py, f32> {
        let size = self.read_env(0, FlockEnv::state_size)?;
        self.collect_rows(py, size, |env, _| {
            filled_vec(env.state_size(), |out| env.observe_state(out))
        })
    }

    /// Reward terms of the last step: (rows, terms).
    fn reward_terms<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.collect_rows(py, TERMS, |_, episode| episode.terms().concat())
    }

    /// The recorded quantities of the normal boats: (flocks, quantities). They are NaN for a flock without normal boats.
    fn order_parameters<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.collect_rows(py, RECORDED, |_, episode| {
            let recorded = episode.flock().recorded(Flock::WITHOUT_LEADERS);
            recorded.unwrap_or([f64::NAN; RECORDED]).to_vec()
        })
    }

    /// Poses of all boats, flock after flock.
    fn poses<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.collect_rows(py, 3, |_, episode| {
            pose_numbers(episode.flock().poses()).collect()
        })
    }

    /// Velocities of all boats, flock after flock.
    fn velocities<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        let numbers = |episode: &Episode| velocity_numbers(episode.flock().velocities()).collect();
        self.collect_rows(py, 3, |_, episode| numbers(episode))
    }

    /// Whether each flock is in the analysis window: (flocks, 1).
    fn in_analysis_window<'py>(&self, py: Python<'py>) -> Rows<'py, bool> {
        self.collect_rows(py, 1, |_, episode| {
            let flock = episode.flock();
            vec![flock.schedule().in_analysis_window(flock.time())]
        })
    }

    /// The leaders' present rudders: (rows, 1), positive counter-clockwise.
    fn rudders<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.collect_rows(py, 1, |_, episode| episode.rudders().to_vec())
    }

    /// Whether a reset has ever set a flock's seed.
    fn is_seeded(&self, flock: usize) -> Result<bool> {
        self.read_env(flock, FlockEnv::is_seeded)
    }

    /// Whether a flock has an episode that has not ended.
    fn is_running(&self, flock: usize) -> Result<bool> {
        let is_running = |episode: &Episode| !episode.has_ended();
        self.read_env(flock, |env| env.episode().is_some_and(is_running))
    }

    /// A copy of a flock.
    fn flock(&self, flock: usize) -> Result<PyFlock> {
        self.read_episode(flock, |episode| PyFlock::wrap(episode.flock().clone()))
    }

    /// Target, backward duration, seed and step of a flock's episode.
    fn episode(&self, flock: usize) -> Result<Value> {
        self.read_episode(flock, |episode| {
            let schedule = episode.schedule();
            let target = ("target", schedule.targets().value());
            let bw_s = named_fields!(episode.flock().parameters(); bw_s);
            let seed_and_step = named_fields!(schedule; flock_seed step);
            let fields = [target].into_iter().chain(bw_s).chain(seed_and_step);
            fields.collect()
        })
    }

    /// Summary of the last episode that reached its end.
    fn finished(&self, flock: usize) -> Result<Option<Value>> {
        self.read_env(flock, |env| env.finished().map(EpisodeSummary::named))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.0.read()?.to_bytes()))
    }

    #[classmethod]
    fn from_bytes(_class: &Bound<'_, PyType>, state: &[u8]) -> Result<Self> {
        EnvBatch::from_bytes(state).map(Self::wrap)
    }

    fn restore(&self, state: &[u8]) -> Result<()> {
        self.0.write()?.restore(state)
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Result<Self> {
        Ok(Self::wrap(self.0.read()?.clone()))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let class = py.get_type::<Self>();
        Ok((class.getattr("from_bytes")?, (self.to_bytes(py)?,)))
    }
}

/// A reset request from options, for a flock with this number of boats.
fn request_from(options: &Bound<'_, PyDict>, boats: usize) -> PyResult<ResetRequest> {
    let mut request = ResetRequest::default();
    let (mut snapshot, mut noise_seed) = (None, None);
    for (name, value) in options {
        match text_of("reset option", &value_from(&name))? {
            "seed" if value.is_none() => request.seed = None,
            "seed" => request.seed = Some(seed_from(&value)?),
            "target" => request.target = Some(argument(&value, "target")?),
            "bw_s" => request.bw_s = Some(argument(&value, "bw_s")?),
            "state" => request.start = Start::State(state_from(&value, boats)?),
            "snapshot" => snapshot = Some(value.extract()?),
            "noise_seed" => noise_seed = noise_seed_from(&value)?,
            other => {
                let accepted = "seed, target, bw_s, state, snapshot or noise_seed";
                let option = format!("{other:?}");
                return Err(FlockError::parameter("reset option", option, accepted).into());
            }
        }
    }
    let has_snapshot = options.contains("snapshot")?;
    let accepted = "a snapshot alone: it brings its own state and bw_s along";
    let contradicts = has_snapshot && (options.contains("state")? || options.contains("bw_s")?);
    FlockError::unless(
        !contradicts,
        "reset options",
        "snapshot and others",
        accepted,
    )?;
    if let Some(seed) = noise_seed.filter(|_| snapshot.is_none()) {
        let accepted = "a noise_seed only together with a snapshot";
        return Err(FlockError::parameter("noise_seed", seed, accepted).into());
    }
    if let Some(bytes) = snapshot {
        request.start = Start::Snapshot { bytes, noise_seed };
    }
    Ok(request)
}
