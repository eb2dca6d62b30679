//! Many environments stepped in parallel. The results of an environment are the same to the bit in every batch and with
//! every number of threads.

use super::credit::ContactCredit;
use super::flock_env::StoredEnv;
use super::observation::ObservationLayout;
use super::{EnvSettings, FlockEnv, ResetRequest, Upcoming};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::parallel;
use crate::parameters::FlockParameters;
use crate::sealed_bytes::{Magic, seal, unseal};

/// First bytes of a stored batch.
const MAGIC: Magic = *b"flocken4";

/// Output of a step. Leaders have one row each, flock after flock; flocks have one flag each.
#[derive(Debug)]
pub struct BatchRows<'a> {
    /// Observations, `rows × observation size`.
    pub observations: &'a mut [f32],
    /// Rewards, one per row.
    pub rewards: &'a mut [f64],
    /// Whether each flock's episode has just reached its time limit.
    pub truncated: &'a mut [bool],
}

/// A batch of environments with the same settings; their flocks may differ in parameters.
#[derive(Debug, Clone)]
pub struct EnvBatch {
    settings: EnvSettings,
    envs: Vec<FlockEnv>,
    /// Number of leaders in all flocks together.
    rows: usize,
}

/// One flock's part of a step: its environment, its actions and its rows of the output.
struct FlockStep<'a> {
    env: &'a mut FlockEnv,
    actions: Option<&'a [f64]>,
    observations: &'a mut [f32],
    rewards: &'a mut [f64],
    truncated: &'a mut bool,
    /// Whether `keep_going` is asked before this flock's step.
    checks_interrupt: bool,
}

impl EnvBatch {
    /// A batch with one environment for each set of parameters. All must be reset before a step.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for settings or parameters that are not accepted.
    pub fn new(settings: EnvSettings, flocks: Vec<FlockParameters>) -> Result<Self> {
        FlockError::unless(!flocks.is_empty(), "num_envs", 0, "at least 1")?;
        for parameters in &flocks {
            parameters.check()?;
            settings.check(parameters)?;
        }
        let leaders = flocks.iter().map(|parameters| parameters.n_leaders);
        settings.reward.check_leaders(leaders.max().unwrap_or(0))?;
        check_memory(&settings, &flocks)?;
        Ok(Self {
            rows: flocks.iter().map(|parameters| parameters.n_leaders).sum(),
            envs: flocks
                .into_iter()
                .map(|parameters| FlockEnv::new(&settings, parameters))
                .collect(),
            settings,
        })
    }

    /// The settings.
    pub fn settings(&self) -> &EnvSettings {
        &self.settings
    }

    /// The environments.
    pub fn envs(&self) -> &[FlockEnv] {
        &self.envs
    }

    /// Number of rows: the leaders of all flocks together.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Size of the observation of one leader.
    pub fn observation_size(&self) -> usize {
        self.settings.observation.size()
    }

    /// Checks the actions, and that every environment is ready, so that a step moves all flocks or none.
    ///
    /// # Errors
    /// [`FlockError::Shape`], [`FlockError::Parameter`] or [`FlockError::Episode`].
    pub fn check_step(&self, actions: Option<&[f64]>) -> Result<()> {
        if let Some(actions) = actions {
            if actions.len() != self.rows {
                return Err(FlockError::Shape {
                    field: "actions",
                    found: format!("({},)", actions.len()),
                    expected: format!("({},), one per leader", self.rows),
                });
            }
            for &action in actions {
                self.settings.check_action(action)?;
            }
        }
        self.envs
            .iter()
            .try_for_each(|env| env.check_ready(self.settings.autoreset_mode))
    }

    /// Takes one decision in every flock and holds its actions over the control steps until the next decision. A flock
    /// whose next episode is due starts that episode instead. Without actions the leaders follow the steering law at
    /// every substep.
    ///
    /// # Errors
    /// Those of [`Self::check_step`], before any flock moves. [`FlockError::Solver`] and [`FlockError::Placement`] of a
    /// flock, after the other flocks have moved: the episode of that flock has ended, and the rewards of this step are
    /// lost.
    ///
    /// # Panics
    /// If the output does not have one row per leader and one flag per flock.
    pub fn step(&mut self, actions: Option<&[f64]>, out: BatchRows) -> Result<()> {
        let keep_going = || true;
        self.step_while(&keep_going, actions, out)
    }

    /// As [`Self::step`], but calls `keep_going` now and then to ask whether to continue.
    ///
    /// # Errors
    /// As for [`Self::step`]; [`FlockError::Interrupted`] if `keep_going` returned false: all flocks must be reset
    /// then.
    ///
    /// # Panics
    /// As for [`Self::step`].
    pub fn step_while(
        &mut self,
        keep_going: KeepGoing,
        actions: Option<&[f64]>,
        out: BatchRows,
    ) -> Result<()> {
        self.check_step(actions)?;
        let settings = &self.settings;
        let flocks = split(&mut self.envs, settings.observation.size(), actions, out);
        let step = |flock: FlockStep| {
            if flock.checks_interrupt && !keep_going() {
                return Err(FlockError::Interrupted);
            }
            let (env, actions) = (flock.env, flock.actions);
            let (observations, rewards) = (flock.observations, flock.rewards);
            *flock.truncated = env.step(keep_going, settings, actions, observations, rewards)?;
            Ok(())
        };
        let results: Vec<Result<()>> = parallel::map(flocks, step);
        if results.contains(&Err(FlockError::Interrupted)) {
            // Some flocks have moved and others have not: all must be reset.
            self.envs.iter_mut().for_each(FlockEnv::abandon);
            return Err(FlockError::Interrupted);
        }
        let is_single_flock = results.len() == 1;
        let numbered = results.into_iter().enumerate();
        let mut errors = numbered.filter_map(|(flock, result)| Some((flock, result.err()?)));
        match (errors.next(), errors.count()) {
            (None, _) => Ok(()),
            (Some((_, error)), _) if is_single_flock => Err(error),
            (Some((flock, error)), further_flocks) => Err(error.with_flock(flock, further_flocks)),
        }
    }

    /// Adds one number per row to the rewards of the last step, besides the weighted terms of the settings.
    ///
    /// # Panics
    /// If the numbers of rewards and rows differ.
    pub fn add_rewards(&mut self, rewards: &[f64]) {
        assert_eq!(rewards.len(), self.rows, "one reward per leader");
        let mut remaining = rewards;
        for env in &mut self.envs {
            let rows = remaining.split_off(..env.parameters().n_leaders);
            env.add_rewards(rows.unwrap_or_default());
        }
    }

    /// Starts new episodes. There is one request per flock; `None` leaves a flock unchanged. If any request fails, no
    /// flock changes.
    ///
    /// # Errors
    /// The first error of a request; [`FlockError::Shape`] if the numbers of requests and flocks differ.
    pub fn reset(&mut self, requests: &[Option<ResetRequest>]) -> Result<()> {
        let keep_going = || true;
        self.reset_while(&keep_going, requests)
    }

    /// As [`Self::reset`], but calls `keep_going` now and then to ask whether to continue, since large flocks take
    /// seconds to place.
    ///
    /// # Errors
    /// As for [`Self::reset`]; [`FlockError::Interrupted`] if `keep_going` returned false.
    pub fn reset_while(
        &mut self,
        keep_going: KeepGoing,
        requests: &[Option<ResetRequest>],
    ) -> Result<()> {
        if requests.len() != self.envs.len() {
            return Err(FlockError::Shape {
                field: "reset requests",
                found: format!("({},)", requests.len()),
                expected: format!("({},), one per flock", self.envs.len()),
            });
        }
        let settings = &self.settings;
        let prepare = |(env, request): (&FlockEnv, &Option<ResetRequest>)| {
            let request = request.as_ref();
            request
                .map(|request| env.prepare(settings, request, keep_going))
                .transpose()
        };
        let pairs: Vec<_> = self.envs.iter().zip(requests).collect();
        let prepared: Result<Vec<_>> = parallel::map(pairs, prepare).into_iter().collect();
        let size = settings.observation.size();
        for (env, prepared) in self.envs.iter_mut().zip(prepared?) {
            if let Some(prepared) = prepared {
                // The caller reads the first observations with `observe`.
                let mut observations = vec![0.0; size * env.parameters().n_leaders];
                env.start(prepared, &mut observations);
            }
        }
        Ok(())
    }

    /// Sets options of the future episodes of some flocks; options that are `None` stay as they were.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for options that a flock cannot have, and for flocks that do not exist; nothing has
    /// changed then.
    pub fn set_upcoming(&mut self, flocks: &[usize], options: &Upcoming) -> Result<()> {
        let merge = |&flock: &usize| {
            let accepted = format!("below {}", self.envs.len());
            let unknown = || FlockError::parameter("flock", flock, accepted);
            let env = self.envs.get(flock).ok_or_else(unknown)?;
            let mut upcoming = env.upcoming().clone();
            upcoming.target = options.target.clone().or(upcoming.target);
            upcoming.bw_s = options.bw_s.or(upcoming.bw_s);
            env.check_upcoming(&self.settings, &upcoming)?;
            Ok(upcoming)
        };
        let merged: Vec<_> = flocks.iter().map(merge).collect::<Result<_>>()?;
        for (&flock, upcoming) in flocks.iter().zip(merged) {
            self.envs[flock].set_upcoming(upcoming);
        }
        Ok(())
    }

    /// Writes the leaders' present observations; zeros before the first reset.
    ///
    /// # Panics
    /// If `out` has another length than `rows × observation size`.
    pub fn observe(&mut self, out: &mut [f32]) {
        let size = self.observation_size();
        assert_eq!(out.len(), self.rows * size, "one row per leader");
        let mut remaining = out;
        for env in &mut self.envs {
            let rows = remaining.split_off_mut(..env.parameters().n_leaders * size);
            env.observe(rows.unwrap_or_default());
        }
    }

    /// Writes the leaders' present observations in another layout, through the same cameras; zeros before the first
    /// reset.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a layout that a flock cannot have.
    ///
    /// # Panics
    /// If `out` has another length than `rows × size of the layout`.
    pub fn observe_in(&self, layout: ObservationLayout, out: &mut [f32]) -> Result<()> {
        assert_eq!(out.len(), self.rows * layout.size(), "one row per leader");
        let mut remaining = out;
        for env in &self.envs {
            let rows = remaining.split_off_mut(..env.parameters().n_leaders * layout.size());
            env.observe_in(layout, rows.unwrap_or_default())?;
        }
        Ok(())
    }

    /// The batch as bytes: settings, parameters and state.
    pub fn to_bytes(&self) -> Vec<u8> {
        let parameters: Vec<_> = self.envs.iter().map(FlockEnv::parameters).collect();
        let states: Vec<_> = self.envs.iter().map(FlockEnv::stored).collect();
        seal(&MAGIC, &(&self.settings, parameters, states))
    }

    /// Restores a batch from its bytes.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged batch.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let (settings, parameters, states): (EnvSettings, Vec<_>, Vec<StoredEnv>) =
            unseal(&MAGIC, bytes)?;
        let mut batch = Self::new(settings, parameters)?;
        let is_complete = states.len() == batch.envs.len();
        FlockError::unless_fitting(is_complete, "a part of the batch is missing")?;
        for (env, stored) in batch.envs.iter_mut().zip(states) {
            *env = env.restored(&batch.settings, stored)?;
        }
        Ok(batch)
    }

    /// Continues from the bytes of a batch with the same settings and parameters.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`]; the batch is unchanged then.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<()> {
        let restored = Self::from_bytes(bytes)?;
        let [current_parameters, stored_parameters] =
            [&*self, &restored].map(|batch| batch.envs.iter().map(FlockEnv::parameters));
        let is_same =
            restored.settings == self.settings && current_parameters.eq(stored_parameters);
        FlockError::unless_fitting(is_same, "the state's environment has other options")?;
        *self = restored;
        Ok(())
    }
}

/// A step of the batch asks `keep_going` once per this many flocks. A long step of one flock asks it, too.
const FLOCKS_BETWEEN_CHECKS: usize = 16;

/// Larger batches (more than 16 GiB) are taken for a mistake.
const MOST_BYTES: u64 = 16 << 30;
/// Upper bound of the bytes of a flock without its boats.
const BYTES_PER_FLOCK: u64 = 16 << 10;
/// Upper bound of the bytes of a boat with its contacts.
const BYTES_PER_BOAT: u64 = 2 << 10;

/// Refuses a batch that would not fit in memory.
fn check_memory(settings: &EnvSettings, flocks: &[FlockParameters]) -> Result<()> {
    // Four copies at most: the caller may hold two, and at the end of an episode the environment holds another.
    let bytes_per_leader = 4 * size_of::<f32>() as u64 * settings.observation.size() as u64;
    let bytes_of_flock = |parameters: &FlockParameters| {
        let (boats, leaders) = (parameters.n_boats, parameters.n_leaders);
        let bytes_of_boats = BYTES_PER_BOAT * boats as u64 + bytes_per_leader * leaders as u64;
        // At the end of an episode there are two.
        let credits = if settings.reward.need_credit() { 2 } else { 0 };
        BYTES_PER_FLOCK + bytes_of_boats + credits * ContactCredit::bytes(leaders, boats)
    };
    let bytes: u64 = flocks.iter().map(bytes_of_flock).sum();
    // Reserving the memory, without writing to it, tells whether the system would give it.
    let mut memory: Vec<u8> = Vec::new();
    if bytes <= MOST_BYTES && memory.try_reserve_exact(bytes as usize).is_ok() {
        return Ok(());
    }
    Err(FlockError::parameter(
        "num_envs",
        flocks.len(),
        format!(
            "{bytes} bytes do not fit: use fewer flocks or boats, for at most {MOST_BYTES} bytes \
             and the free memory"
        ),
    ))
}

/// Splits actions and output into the parts of the flocks.
fn split<'a>(
    envs: &'a mut [FlockEnv],
    observation_size: usize,
    mut actions: Option<&'a [f64]>,
    out: BatchRows<'a>,
) -> Vec<FlockStep<'a>> {
    let (mut observations, mut rewards) = (out.observations, out.rewards);
    let rows: usize = envs.iter().map(|env| env.parameters().n_leaders).sum();
    let observation_count = rows * observation_size;
    assert_eq!(observations.len(), observation_count, "one row per leader");
    assert_eq!(rewards.len(), rows, "one reward per leader");
    assert_eq!(out.truncated.len(), envs.len(), "one flag per flock");
    let mut split_flocks = 0_usize;
    let part = |(env, truncated): (&'a mut FlockEnv, _)| {
        split_flocks += 1;
        let leaders = env.parameters().n_leaders;
        let observations = observations.split_off_mut(..leaders * observation_size);
        FlockStep {
            actions: actions
                .as_mut()
                .and_then(|actions| actions.split_off(..leaders)),
            observations: observations.unwrap_or_default(),
            rewards: rewards.split_off_mut(..leaders).unwrap_or_default(),
            truncated,
            checks_interrupt: split_flocks.is_multiple_of(FLOCKS_BETWEEN_CHECKS),
            env,
        }
    };
    envs.iter_mut().zip(out.truncated).map(part).collect()
}
