//! Many environments stepped in parallel. The bits of an environment depend neither on its batch nor on the number of
//! threads.

use super::flock_env::StoredEnv;
use super::observation::ObservationLayout;
use super::{EnvSettings, FlockEnv, ResetRequest, Upcoming};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::parallel;
use crate::parameters::FlockParameters;
use crate::sealed_bytes::{Magic, seal, unseal};

const MAGIC: Magic = *b"flocken4";

/// Output of a step: one row per leader, flock after flock, and one flag per flock.
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
    rows: usize,
}

/// One flock's part of a step: its environment, its actions and its rows of the output.
struct Share<'a> {
    env: &'a mut FlockEnv,
    actions: Option<&'a [f64]>,
    observations: &'a mut [f32],
    rewards: &'a mut [f64],
    truncated: &'a mut bool,
    /// Whether `keep_going` is asked before this flock's step.
    checks_interrupt: bool,
}

impl EnvBatch {
    /// One environment for each set of parameters. They must be reset before a step.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for settings or parameters that are not accepted.
    pub fn new(settings: EnvSettings, members: Vec<FlockParameters>) -> Result<Self> {
        FlockError::unless(!members.is_empty(), "num_envs", 0, "at least 1")?;
        for parameters in &members {
            parameters.check()?;
            settings.check(parameters)?;
        }
        let leaders = members.iter().map(|parameters| parameters.n_leaders);
        settings.reward.check_leaders(leaders.max().unwrap_or(0))?;
        check_memory(&settings, &members)?;
        Ok(Self {
            rows: members.iter().map(|p| p.n_leaders).sum(),
            envs: members
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

    /// Leaders of all flocks together.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Size of the observation of one leader.
    pub fn observation_size(&self) -> usize {
        self.settings.observation.size()
    }

    /// Checks actions, and that every environment is ready: a step moves all flocks or none.
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

    /// Takes one decision in every flock and holds it over the control steps until the next one. A flock whose next
    /// episode is due starts it instead. Without actions the leaders follow the steering law at every substep.
    ///
    /// # Errors
    /// Those of [`Self::check_step`], before anything moves; [`FlockError::Solver`] and [`FlockError::Placement`] of
    /// one flock, after the others have moved. Its episode has ended, the others continue, and the rewards of this step
    /// are lost.
    ///
    /// # Panics
    /// If the rows have other lengths than the batch.
    pub fn step(&mut self, actions: Option<&[f64]>, out: BatchRows) -> Result<()> {
        self.step_while(&|| true, actions, out)
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
        let shares = shares(&mut self.envs, settings.observation.size(), actions, out);
        let step = |share: Share| {
            if share.checks_interrupt && !keep_going() {
                return Err(FlockError::Interrupted);
            }
            let (actions, observations) = (share.actions, share.observations);
            *share.truncated =
                share
                    .env
                    .step(keep_going, settings, actions, observations, share.rewards)?;
            Ok(())
        };
        let moved: Vec<Result<()>> = parallel::map(shares, step);
        if moved.contains(&Err(FlockError::Interrupted)) {
            // Some flocks have moved and others have not: all must be reset.
            self.envs.iter_mut().for_each(FlockEnv::abandon);
            return Err(FlockError::Interrupted);
        }
        let is_alone = moved.len() == 1;
        let failed = moved.into_iter().enumerate();
        let mut failed = failed.filter_map(|(flock, outcome)| Some((flock, outcome.err()?)));
        match (failed.next(), failed.count()) {
            (None, _) => Ok(()),
            (Some((_, error)), _) if is_alone => Err(error),
            (Some((flock, error)), more) => Err(error.of_flock(flock, more)),
        }
    }

    /// Adds one number per row to the rewards of the last step, on top of the settings' weighted terms.
    ///
    /// # Panics
    /// If the numbers of rewards and rows differ.
    pub fn add_rewards(&mut self, rewards: &[f64]) {
        assert_eq!(rewards.len(), self.rows, "one reward a leader");
        let mut rest = rewards;
        for env in &mut self.envs {
            let own = rest.split_off(..env.parameters().n_leaders);
            env.add_rewards(own.unwrap_or_default());
        }
    }

    /// Starts new episodes. There is one request per flock; `None` leaves a flock unchanged. If a request cannot be met,
    /// nothing changes.
    ///
    /// # Errors
    /// The first error of a request; [`FlockError::Shape`] if the numbers of requests and flocks differ.
    pub fn reset(&mut self, requests: &[Option<ResetRequest>]) -> Result<()> {
        self.reset_while(&|| true, requests)
    }

    /// As [`Self::reset`], but calls `keep_going` now and then, since large flocks take seconds to place.
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
        for (env, next) in self.envs.iter_mut().zip(prepared?) {
            if let Some(next) = next {
                let mut unread = vec![0.0; size * env.parameters().n_leaders];
                env.start(next, &mut unread);
            }
        }
        Ok(())
    }

    /// Sets options of the future episodes of some flocks; options that are `None` stay as they were.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for options that a flock cannot have, or no such flock; nothing has changed then.
    pub fn set_upcoming(&mut self, flocks: &[usize], options: &Upcoming) -> Result<()> {
        let merged = |&flock: &usize| {
            let accepted = format!("below {}", self.envs.len());
            let none = || FlockError::parameter("flock", flock, accepted);
            let env = self.envs.get(flock).ok_or_else(none)?;
            let mut upcoming = env.upcoming().clone();
            upcoming.target = options.target.clone().or(upcoming.target);
            upcoming.bw_s = options.bw_s.or(upcoming.bw_s);
            env.check_upcoming(&self.settings, &upcoming)?;
            Ok(upcoming)
        };
        let checked: Vec<_> = flocks.iter().map(merged).collect::<Result<_>>()?;
        for (&flock, upcoming) in flocks.iter().zip(checked) {
            self.envs[flock].set_upcoming(upcoming);
        }
        Ok(())
    }

    /// Writes the observations as they are now, zeros before the first reset.
    ///
    /// # Panics
    /// If `out` has another length than `rows × observation size`.
    pub fn observe(&mut self, out: &mut [f32]) {
        let size = self.observation_size();
        assert_eq!(out.len(), self.rows * size, "one row per leader");
        let mut rest = out;
        for env in &mut self.envs {
            let own = rest.split_off_mut(..env.parameters().n_leaders * size);
            env.observe(own.unwrap_or_default());
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
        let mut rest = out;
        for env in &self.envs {
            let own = rest.split_off_mut(..env.parameters().n_leaders * layout.size());
            env.observe_in(layout, own.unwrap_or_default())?;
        }
        Ok(())
    }

    /// The whole batch as bytes: settings, parameters and state.
    pub fn to_bytes(&self) -> Vec<u8> {
        let members: Vec<_> = self.envs.iter().map(FlockEnv::parameters).collect();
        let states: Vec<_> = self.envs.iter().map(FlockEnv::stored).collect();
        seal(&MAGIC, &(&self.settings, members, states))
    }

    /// A batch from its bytes.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] for bytes that are not a complete, undamaged batch.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let (settings, members, states): (EnvSettings, Vec<_>, Vec<StoredEnv>) =
            unseal(&MAGIC, bytes)?;
        let mut batch = Self::new(settings, members)?;
        let is_whole = states.len() == batch.envs.len();
        FlockError::unless_fitting(is_whole, "a part of the batch is missing")?;
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
        let [own, other] =
            [&*self, &restored].map(|batch| batch.envs.iter().map(FlockEnv::parameters));
        let is_same = restored.settings == self.settings && own.eq(other);
        FlockError::unless_fitting(is_same, "the state's environment has other options")?;
        *self = restored;
        Ok(())
    }
}

/// A step of the batch can be interrupted after this many flocks, and within a long step of one flock.
const FLOCKS_BETWEEN_CHECKS: usize = 16;

/// Batches beyond this many bytes (16 GiB) are taken for a mistake.
const MOST_BYTES: u64 = 16 << 30;
/// Upper bounds of the bytes of a flock without its boats, and of a boat with its contacts.
const BYTES_A_FLOCK: u64 = 16 << 10;
const BYTES_A_BOAT: u64 = 2 << 10;

/// Refuses a batch for which memory would run out.
fn check_memory(settings: &EnvSettings, members: &[FlockParameters]) -> Result<()> {
    // Observations are also held by the caller and, at the end of an episode, by the environment.
    let bytes_a_leader = 4 * size_of::<f32>() as u64 * settings.observation.size() as u64;
    let bytes: u64 = members
        .iter()
        .map(|p| {
            let (boats, leaders) = (p.n_boats as u64, p.n_leaders as u64);
            BYTES_A_FLOCK + BYTES_A_BOAT * boats + bytes_a_leader * leaders
        })
        .sum();
    let mut memory: Vec<u8> = Vec::new();
    if bytes <= MOST_BYTES && memory.try_reserve_exact(bytes as usize).is_ok() {
        return Ok(());
    }
    Err(FlockError::parameter(
        "num_envs",
        members.len(),
        format!(
            "{bytes} bytes do not fit; at most {MOST_BYTES} bytes, and the memory there is: fewer \
             flocks or fewer boats"
        ),
    ))
}

/// Splits actions and rows into one share per flock.
fn shares<'a>(
    envs: &'a mut [FlockEnv],
    size: usize,
    mut actions: Option<&'a [f64]>,
    out: BatchRows<'a>,
) -> Vec<Share<'a>> {
    let (mut observations, mut rewards) = (out.observations, out.rewards);
    let rows: usize = envs.iter().map(|env| env.parameters().n_leaders).sum();
    assert_eq!(observations.len(), rows * size, "one row per leader");
    assert_eq!(rewards.len(), rows, "one reward a leader");
    assert_eq!(out.truncated.len(), envs.len(), "one flag a flock");
    let mut number = 0_usize;
    let share = |(env, truncated): (&'a mut FlockEnv, _)| {
        number += 1;
        let leaders = env.parameters().n_leaders;
        Share {
            actions: actions.as_mut().and_then(|rest| rest.split_off(..leaders)),
            observations: observations
                .split_off_mut(..leaders * size)
                .unwrap_or_default(),
            rewards: rewards.split_off_mut(..leaders).unwrap_or_default(),
            truncated,
            checks_interrupt: number.is_multiple_of(FLOCKS_BETWEEN_CHECKS),
            env,
        }
    };
    envs.iter_mut().zip(out.truncated).map(share).collect()
}
