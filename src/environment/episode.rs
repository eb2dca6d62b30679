//! One episode under way: the flock, its leaders' rudders, what was observed and rewarded so far.

use super::observation::{Camera, CameraState, FlockView, Observer, StateObserver};
use super::reset::flock_from;
use super::statistics::EpisodeStatistics;
use super::{
    Averages, EnvSettings, EpisodeSchedule, EpisodeSummary, Reward, RewardTerms, Servo, TERMS,
};
use crate::analysis::OrderParameters;
use crate::analysis::quantities::Boats;
use crate::clock::seconds;
use crate::error::{FlockError, Result};
use crate::flock::Flock;
use crate::integrator::Steering;
use crate::parameters::FlockParameters;

/// What observations and rewards are computed from.
#[derive(Debug, Clone)]
struct EpisodeState {
    flock: Flock,
    schedule: EpisodeSchedule,
    /// The leaders' rudders as they stand, positive counter-clockwise.
    rudders: Vec<f64>,
    /// Of the normal boats; `None` where there is none.
    order: Option<OrderParameters>,
}

impl EpisodeState {
    fn view(&self) -> FlockView<'_> {
        FlockView {
            poses: self.flock.poses(),
            hulls: self.flock.hulls(),
            velocities: self.flock.velocities(),
            leaders: self.rudders.len(),
            phase: self.flock.phase(),
            bw_s: self.schedule.bw_s,
            target: self.schedule.target(),
            rudders: &self.rudders,
            order: self.order.as_ref(),
        }
    }
}

/// What is stored of an episode.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct StoredEpisode<A = Averages> {
    flock: Vec<u8>,
    schedule: EpisodeSchedule,
    rudders: Vec<f64>,
    camera: Option<CameraState>,
    terms: Vec<RewardTerms>,
    statistics: EpisodeStatistics<A>,
    ended: bool,
}

/// An episode under way.
#[derive(Debug, Clone)]
pub struct Episode {
    state: EpisodeState,
    observer: Observer,
    camera: Option<Camera>,
    terms: Vec<RewardTerms>,
    statistics: EpisodeStatistics,
    ended: bool,
}

impl Episode {
    /// An episode that starts with this flock.
    pub fn new(settings: &EnvSettings, schedule: EpisodeSchedule, flock: Flock) -> Self {
        let leaders = flock.parameters().n_leaders;
        let camera = settings.camera.is_active().then(|| {
            let (poses, velocities) = (flock.poses(), flock.velocities());
            Camera::new(
                settings.camera,
                schedule.flock_seed,
                leaders,
                poses,
                velocities,
            )
        });
        Self {
            observer: Observer::new(settings.observation, flock.parameters()),
            camera,
            terms: vec![[0.0; TERMS]; leaders],
            statistics: EpisodeStatistics::default(),
            ended: false,
            state: EpisodeState {
                order: flock.order_parameters(false).ok(),
                rudders: vec![0.0; leaders],
                schedule,
                flock,
            },
        }
    }

    /// The flock.
    pub fn flock(&self) -> &Flock {
        &self.state.flock
    }

    /// What was drawn for the episode, and how far it is.
    pub fn schedule(&self) -> &EpisodeSchedule {
        &self.state.schedule
    }

    /// Whether the episode has ended.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Order parameters of the normal boats now; `None` where there is none.
    pub fn order(&self) -> Option<&OrderParameters> {
        self.state.order.as_ref()
    }

    /// Each leader's reward terms in the last control step.
    pub fn terms(&self) -> &[RewardTerms] {
        &self.terms
    }

    /// The leaders' rudders as they stand, positive counter-clockwise.
    pub fn rudders(&self) -> &[f64] {
        &self.state.rudders
    }

    /// Statistics of the episode so far.
    pub fn summary(&self) -> EpisodeSummary {
        self.statistics.summary(&self.state.schedule)
    }

    /// Writes what leaders see now; returns how many numbers were clipped.
    pub fn observe(&mut self, out: &mut [f32]) -> u32 {
        let mut view = self.state.view();
        if let Some(camera) = &self.camera {
            view.poses = &camera.seen().poses;
            view.velocities = &camera.seen().velocities;
            view.hulls = camera.hulls();
            view.order = camera.order();
        }
        self.observer.observe(&view, out)
    }

    /// Writes what leaders see in the course of the episode, and counts what was clipped.
    pub(crate) fn observe_and_count(&mut self, out: &mut [f32]) {
        let clipped = self.observe(out);
        self.statistics.count_clipped(clipped, out.len());
    }

    /// Writes the global state, which no camera stands before.
    pub(crate) fn observe_state(&self, observer: &StateObserver, out: &mut [f32]) {
        observer.observe(&self.state.view(), self.state.schedule.elapsed(), out);
    }

    /// Takes one control step with checked actions, one per leader, and writes the rewards.
    ///
    /// # Errors
    /// [`FlockError::Solver`]; the flock stays where it was, and the episode is over.
    pub fn step(
        &mut self,
        settings: &EnvSettings,
        servo: &Servo,
        actions: &[f64],
        rewards: &mut [f64],
    ) -> Result<()> {
        let state = &mut self.state;
        let target = state.schedule.target();
        let mirrored = settings.observation.mirror_to_target && target.sign() < 0.0;
        for (rudder, &action) in state.rudders.iter_mut().zip(actions) {
            let command = settings.rudder.command(action);
            *rudder = servo.moved(*rudder, if mirrored { -command } else { command });
        }
        let (plan, step) = (&settings.episode, state.schedule.step);
        let end = state.flock.time() + plan.time_of(step + 1) - plan.time_of(step);
        if let Err(error) = state.flock.advance_to(end, Steering::Held(&state.rudders)) {
            self.ended = true;
            return Err(error);
        }
        state.order = state.flock.order_parameters(false).ok();
        self.compute_rewards(settings, rewards);
        self.advance_schedule();
        Ok(())
    }

    /// Rewards of the step just taken, with the target that held in it.
    fn compute_rewards(&mut self, settings: &EnvSettings, rewards: &mut [f64]) {
        let view = self.state.view();
        let reward = Reward::new(self.state.flock.parameters(), &view);
        let share = 1.0 / rewards.len() as f64;
        for (leader, (terms, paid)) in self.terms.iter_mut().zip(rewards).enumerate() {
            *terms = reward.terms(&view, leader);
            *paid = settings.reward.total(terms);
            self.statistics.add_reward(share, terms, *paid);
        }
        let (flock, schedule) = (&self.state.flock, &self.state.schedule);
        let counted = 10 * (u64::from(schedule.step) + 1) > u64::from(schedule.steps);
        if let Some(order) = &self.state.order {
            let time_s = seconds(settings.episode.time_of(schedule.step + 1));
            let is_late = 2 * (u64::from(schedule.step) + 1) >= u64::from(schedule.steps);
            self.statistics.watch_order(order, time_s, is_late);
            if counted && flock.schedule().in_analysis_window(flock.time()) {
                let leaders = flock.parameters().n_leaders;
                let boats = Boats {
                    hulls: &view.hulls[leaders..],
                    velocities: &view.velocities[leaders..],
                    order: *order,
                };
                self.statistics.add_window(&boats, view.target);
            }
        }
    }

    /// Moves the episode's clock on: targets change, the camera takes its picture.
    fn advance_schedule(&mut self) {
        let state = &mut self.state;
        state.schedule.step += 1;
        self.ended = state.schedule.is_over();
        state.flock.set_target(state.schedule.target());
        if let Some(camera) = &mut self.camera {
            let (poses, velocities) = (state.flock.poses(), state.flock.velocities());
            camera.expose(state.rudders.len(), poses, velocities);
        }
    }

    /// The episode, to be stored.
    pub(crate) fn stored(&self) -> StoredEpisode {
        StoredEpisode {
            flock: self.state.flock.snapshot(),
            schedule: self.state.schedule.clone(),
            rudders: self.state.rudders.clone(),
            camera: self.camera.as_ref().map(Camera::state),
            terms: self.terms.clone(),
            statistics: self.statistics,
            ended: self.ended,
        }
    }

    /// The episode that was stored, in an environment with these settings and parameters.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if it does not belong there.
    pub(crate) fn restored<A>(
        settings: &EnvSettings,
        parameters: &FlockParameters,
        stored: StoredEpisode<A>,
    ) -> Result<Self>
    where
        Averages: From<A>,
    {
        let (leaders, boats) = (parameters.n_leaders, parameters.n_boats);
        let flock = flock_from(&stored.flock, parameters)?;
        let fits = stored.rudders.len() == leaders
            && stored.rudders.iter().all(|rudder| rudder.abs() <= 1.0)
            && stored.terms.len() == leaders
            && stored.schedule.steps == settings.episode.steps()
            && stored.schedule.bw_s == flock.parameters().bw_s
            && stored.camera.is_some() == settings.camera.is_active()
            && stored
                .camera
                .as_ref()
                .is_none_or(|state| Camera::fits(state, boats));
        if !fits {
            return Err(FlockError::Snapshot(
                "the state holds an episode that this environment cannot have".to_owned(),
            ));
        }
        let seed = stored.schedule.flock_seed;
        let mut episode = Self::new(settings, stored.schedule, flock);
        episode.state.rudders = stored.rudders;
        episode.camera = stored.camera.map(|state| {
            let mut camera = Camera::unexposed(settings.camera, seed);
            camera.set_state(state, leaders);
            camera
        });
        episode.terms = stored.terms;
        episode.statistics = stored.statistics.restored();
        episode.ended = stored.ended;
        Ok(episode)
    }
}
