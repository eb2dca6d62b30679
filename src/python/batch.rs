//! `flockenv._core.EnvBatch`: what all environment classes sit on.

use super::arrays::{floats, rows_of};
use super::exclusive::{Exclusive, interruptible};
use super::flock::{PyFlock, pose_numbers, state_from, velocity_numbers};
use super::value::{fields_dict, given, seed_from, set_given, value_from, written};
use crate::environment::observation::FlockFeatures;
use crate::environment::{
    BatchRows, EnvBatch, EnvSettings, Episode, EpisodeSummary, FlockEnv, LeaderSummary,
    ResetRequest, RewardTerm, Start, TERMS,
};
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, Setting, text_of};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};

/// What a step returns: observations (rows, size), rewards (rows,), truncated (flocks,).
type Step<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
);

/// Observations (leaders, size), the global state (1, size), and features of the flock (leaders, features).
type Views<'py> = [Bound<'py, PyArray2<f32>>; 3];

/// Numbers of flocks, boats or leaders, a row each.
type Rows<'py, T> = PyResult<Bound<'py, PyArray2<T>>>;

/// Many flocks with their episodes, stepped at once; one row per leader, flock after flock.
#[pyclass(name = "EnvBatch", module = "flockenv._core", frozen)]
pub(super) struct PyEnvBatch(Exclusive<EnvBatch>);

impl PyEnvBatch {
    fn of(batch: EnvBatch) -> Self {
        Self(Exclusive::new(batch, "the environment"))
    }

    /// Numbers of every flock's episode, as rows of so many.
    fn gathered<'py, T: Element>(
        &self,
        py: Python<'py>,
        columns: usize,
        numbers: impl Fn(&FlockEnv, &Episode) -> Vec<T>,
    ) -> Rows<'py, T> {
        let batch = self.0.read()?;
        let mut gathered = Vec::new();
        for env in batch.envs() {
            gathered.extend(numbers(env, env.episode().ok_or_else(never_reset)?));
        }
        rows_of(py, gathered, columns)
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

/// So many numbers that `fill` writes.
fn filled(count: usize, fill: impl FnOnce(&mut [f32])) -> Vec<f32> {
    let mut numbers = vec![0.0; count];
    fill(&mut numbers);
    numbers
}

#[pymethods]
impl PyEnvBatch {
    #[new]
    fn new(parameters: Vec<FlockParameters>, options: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut settings = EnvSettings::default();
        set_given(&mut settings, EnvSettings::FIELDS, options)?;
        Ok(Self::of(EnvBatch::new(settings, parameters)?))
    }

    #[getter]
    fn observation_size(&self) -> Result<usize> {
        Ok(self.0.read()?.observation_size())
    }

    #[getter]
    fn episode_steps(&self) -> Result<u32> {
        Ok(self.0.read()?.settings().steps())
    }

    #[getter]
    fn period_steps(&self) -> Result<u32> {
        Ok(self.0.read()?.settings().period_steps())
    }

    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        fields_dict(py, self.0.read()?.settings(), EnvSettings::FIELDS)
    }

    fn parameters<'py>(&self, py: Python<'py>, flock: usize) -> PyResult<Bound<'py, PyDict>> {
        let batch = self.0.read()?;
        let parameters = env_of(&batch, flock)?.parameters();
        fields_dict(py, parameters, FlockParameters::FIELDS)
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

    fn observe<'py>(&self, py: Python<'py>) -> Rows<'py, f32> {
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
        let rows = |numbers: &[f32], columns| rows_of(py, numbers.to_vec(), columns);
        Ok([
            rows(env.final_observation(), batch.observation_size())?,
            rows(env.final_state(), env.state_size())?,
            rows(env.final_features(), FlockFeatures::SIZE)?,
        ])
    }

    /// Features of every flock in the frame of its target, (flocks, features), or of each leader's flock in the frame
    /// of its own, (rows, features).
    fn flock_features<'py>(&self, py: Python<'py>, each_leader: bool) -> Rows<'py, f32> {
        self.gathered(py, FlockFeatures::SIZE, |env, _| {
            let leaders = env.parameters().n_leaders;
            let rows = if each_leader { leaders } else { 1 };
            filled(rows * FlockFeatures::SIZE, |out| env.observe_features(out))
        })
    }

    /// Global states of every flock, which have equally many boats: (flocks, state size).
    fn states<'py>(&self, py: Python<'py>) -> Rows<'py, f32> {
        let size = self
            .0
            .read()?
            .envs()
            .first()
            .map_or(1, FlockEnv::state_size);
        self.gathered(py, size, |env, _| {
            filled(env.state_size(), |out| env.observe_state(out))
        })
    }

    /// Reward terms of the last step: (rows, terms).
    fn reward_terms<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.gathered(py, TERMS, |_, episode| episode.terms().concat())
    }

    /// Order parameters of the normal boats: (flocks, 6) [psi_o, phi_o, c_o, psi_v, phi_v, c_v], NaN
    /// where a flock has none.
    fn order_parameters<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.gathered(py, 6, |_, episode| {
            let order = episode.order();
            let numbers = order.map(|o| vec![o.psi_o, o.phi_o, o.c_o, o.psi_v, o.phi_v, o.c_v]);
            numbers.unwrap_or_else(|| vec![f64::NAN; 6])
        })
    }

    /// Poses of all boats, flock after flock.
    fn poses<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.gathered(py, 3, |_, episode| {
            pose_numbers(episode.flock().poses()).collect()
        })
    }

    /// Velocities of all boats, flock after flock.
    fn velocities<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        let numbers = |episode: &Episode| velocity_numbers(episode.flock().velocities()).collect();
        self.gathered(py, 3, |_, episode| numbers(episode))
    }

    /// Whether each flock is in the analysis window: (flocks, 1).
    fn in_analysis_window<'py>(&self, py: Python<'py>) -> Rows<'py, bool> {
        self.gathered(py, 1, |_, episode| {
            let flock = episode.flock();
            vec![flock.schedule().in_analysis_window(flock.time())]
        })
    }

    /// Rudders as they stand: (rows, 1), positive counter-clockwise.
    fn rudders<'py>(&self, py: Python<'py>) -> Rows<'py, f64> {
        self.gathered(py, 1, |_, episode| episode.rudders().to_vec())
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
        let batch = self.0.read()?;
        let episode = episode_of(&batch, flock)?;
        let schedule = episode.schedule();
        let dict = PyDict::new(py);
        dict.set_item("target", written(&schedule.targets().value(), py)?)?;
        dict.set_item("bw_s", episode.flock().parameters().bw_s)?;
        dict.set_item("flock_seed", schedule.flock_seed)?;
        dict.set_item("step", schedule.step)?;
        Ok(dict)
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
    fn from_bytes(_class: &Bound<'_, PyType>, state: &[u8]) -> Result<Self> {
        EnvBatch::from_bytes(state).map(Self::of)
    }

    fn restore(&self, state: &[u8]) -> Result<()> {
        self.0.write()?.restore(state)
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

/// A request of a flock of so many boats.
fn request_from(options: &Bound<'_, PyDict>, boats: usize) -> PyResult<ResetRequest> {
    let mut request = ResetRequest::default();
    for (name, value) in options {
        match text_of("reset option", &value_from(&name))? {
            "seed" if value.is_none() => request.seed = None,
            "seed" => request.seed = Some(seed_from(&value)?),
            "target" => request.target = Some(given(&value, "target")?),
            "bw_s" => request.bw_s = Some(given(&value, "bw_s")?),
            "state" => request.start = Start::State(state_from(&value, boats)?),
            "snapshot" => request.start = Start::Snapshot(value.extract()?),
            other => {
                let accepted = "target, bw_s, state or snapshot";
                let found = format!("{other:?}");
                return Err(FlockError::parameter("reset option", found, accepted).into());
            }
        }
    }
    let starts_twice = options.contains("state")? && options.contains("snapshot")?;
    let noise_twice = options.contains("bw_s")? && options.contains("snapshot")?;
    let accepted = "a snapshot alone: it brings its own state and bw_s along";
    let is_alone = !starts_twice && !noise_twice;
    FlockError::unless(is_alone, "reset options", "snapshot and others", accepted)?;
    Ok(request)
}

/// A summary by name, with what each leader with a target of its own has: arrays (k,). Means over an analysis window
/// that the episode did not reach are left out: infos hold no NaN.
fn summary_dict<'py>(
    py: Python<'py>,
    summary: &EpisodeSummary,
    leaders: &[LeaderSummary],
) -> PyResult<Bound<'py, PyDict>> {
    let terms = PyDict::new(py);
    for (term, mean) in RewardTerm::ALL.iter().zip(summary.terms) {
        terms.set_item(term.name(), mean)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("flock_seed", summary.flock_seed)?;
    dict.set_item("bw_s", summary.bw_s)?;
    dict.set_item("steps", summary.steps)?;
    dict.set_item("total_reward", summary.total_reward)?;
    dict.set_item("reward_terms", terms)?;
    let share = ("share_towards_target", summary.share_towards_target);
    let means = summary.averages.named().chain([share]);
    for (name, mean) in means.filter(|(_, mean)| !mean.is_nan()) {
        dict.set_item(name, mean)?;
    }
    let [printed, wide] = summary.ordering_times_s;
    dict.set_item("ordering_time_s", printed)?;
    dict.set_item("ordering_time_wide_s", wide)?;
    dict.set_item("clip_rate", summary.clip_rate)?;
    type Column = (&'static str, fn(&LeaderSummary) -> f64);
    let columns: [Column; 4] = [
        ("leader_targets", |each| each.target.sign()),
        ("leader_total_rewards", |each| each.total_reward),
        ("leader_signed_orders", |each| each.signed_order),
        ("leader_shares_towards_target", |each| {
            each.share_towards_target
        }),
    ];
    for (name, value) in columns {
        let values: Vec<f64> = leaders.iter().map(value).collect();
        if !values.is_empty() && !values.iter().any(|value| value.is_nan()) {
            dict.set_item(name, PyArray1::from_vec(py, values))?;
        }
    }
    Ok(dict)
}
