//! One episode under way: the flock, its leaders' rudders, what was seen and earned so far.

use super::reset::flock_from;
use super::totals::Totals;
use super::{EnvSettings, Episode, EpisodeSummary, Reward, RewardTerms, Servo, TERMS};
use crate::dynamics::Steering;
use crate::error::{FlockError, Result};
use crate::flock::Flock;
use crate::observation::{Camera, CameraState, FlockView, Observer, StateObserver};
use crate::order_parameters::OrderParameters;
use crate::parameters::FlockParameters;

/// What is there to be seen.
#[derive(Debug, Clone)]
struct Scene {
    flock: Flock,
    episode: Episode,
    /// The leaders' rudders as they stand, positive counter-clockwise.
    rudders: Vec<f64>,
    /// Of the normal boats; `None` where there is none.
    order: Option<OrderParameters>,
}

impl Scene {
    fn view(&self) -> FlockView<'_> {
        FlockView {
            poses: self.flock.poses(),
            hulls: self.flock.hulls(),
            velocities: self.flock.velocities(),
            leaders: self.rudders.len(),
            phase: self.flock.phase(),
            bw_s: self.episode.bw_s,
            target: self.episode.target(),
            rudders: &self.rudders,
            order: self.order.as_ref(),
        }
    }
}

/// What is stored of a run.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct StoredRun {
    flock: Vec<u8>,
    episode: Episode,
    rudders: Vec<f64>,
    camera: Option<CameraState>,
    terms: Vec<RewardTerms>,
    totals: Totals,
    ended: bool,
}

/// An episode under way.
#[derive(Debug, Clone)]
pub struct Run {
    scene: Scene,
    observer: Observer,
    camera: Option<Camera>,
    terms: Vec<RewardTerms>,
    totals: Totals,
    ended: bool,
}

impl Run {
    /// An episode that begins with this flock.
    pub fn new(settings: &EnvSettings, episode: Episode, flock: Flock) -> Self {
        let leaders = flock.parameters().n_leaders;
        let camera = settings.camera.is_active().then(|| {
            let (poses, velocities) = (flock.poses(), flock.velocities());
            Camera::new(
                settings.camera,
                episode.flock_seed,
                leaders,
                poses,
                velocities,
            )
        });
        Self {
            observer: Observer::new(settings.observation, flock.parameters()),
            camera,
            terms: vec![[0.0; TERMS]; leaders],
            totals: Totals::default(),
            ended: false,
            scene: Scene {
                order: flock.order_parameters(false).ok(),
                rudders: vec![0.0; leaders],
                episode,
                flock,
            },
        }
    }

    /// The flock.
    pub fn flock(&self) -> &Flock {
        &self.scene.flock
    }

    /// The episode.
    pub fn episode(&self) -> &Episode {
        &self.scene.episode
    }

    /// Whether the episode has ended.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Order parameters of the normal boats now; `None` where there is none.
    pub fn order(&self) -> Option<&OrderParameters> {
        self.scene.order.as_ref()
    }

    /// Each leader's reward terms in the last control step.
    pub fn terms(&self) -> &[RewardTerms] {
        &self.terms
    }

    /// The leaders' rudders as they stand, positive counter-clockwise.
    pub fn rudders(&self) -> &[f64] {
        &self.scene.rudders
    }

    /// What there is to tell about the episode so far.
    pub fn summary(&self) -> EpisodeSummary {
        self.totals.summary(&self.scene.episode)
    }

    /// Writes what leaders see now; returns how many numbers were clipped.
    pub fn observe(&mut self, out: &mut [f32]) -> u32 {
        let mut view = self.scene.view();
        if let Some(camera) = &self.camera {
            view.poses = &camera.seen().poses;
            view.velocities = &camera.seen().velocities;
            view.hulls = camera.hulls();
            view.order = camera.order();
        }
        self.observer.observe(&view, out)
    }

    /// Writes what leaders see in the course of the episode, and counts what was clipped.
    pub fn observe_and_count(&mut self, out: &mut [f32]) {
        let clipped = self.observe(out);
        self.totals.count_clipped(clipped, out.len());
    }

    /// Writes the global state, which no camera stands before.
    pub fn observe_state(&self, observer: &StateObserver, out: &mut [f32]) {
        observer.observe(&self.scene.view(), self.scene.episode.elapsed(), out);
    }

    /// Takes one control step with checked actions, one a leader, and writes the rewards.
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
        let scene = &mut self.scene;
        let target = scene.episode.target();
        let mirrored = settings.observation.mirror_to_target && target.sign() < 0.0;
        for (rudder, &action) in scene.rudders.iter_mut().zip(actions) {
            let command = settings.rudder.command(action);
            *rudder = servo.moved(*rudder, if mirrored { -command } else { command });
        }
        let (plan, step) = (&settings.episode, scene.episode.step);
        let end = scene.flock.time() + plan.time_of(step + 1) - plan.time_of(step);
        if let Err(error) = scene.flock.advance_to(end, Steering::Held(&scene.rudders)) {
            self.ended = true;
            return Err(error);
        }
        scene.order = scene.flock.order_parameters(false).ok();
        self.earn(settings, rewards);
        self.go_on();
        Ok(())
    }

    /// Rewards of the step just taken, with the target that held in it.
    fn earn(&mut self, settings: &EnvSettings, rewards: &mut [f64]) {
        let view = self.scene.view();
        let reward = Reward::new(self.scene.flock.parameters(), &view);
        let share = 1.0 / rewards.len() as f64;
        for (leader, (terms, paid)) in self.terms.iter_mut().zip(rewards).enumerate() {
            *terms = reward.terms(&view, leader);
            *paid = settings.reward.total(terms);
            self.totals.add_reward(share, terms, *paid);
        }
        let (flock, episode) = (&self.scene.flock, &self.scene.episode);
        let settled = 10 * (u64::from(episode.step) + 1) > u64::from(episode.steps);
        if let Some(order) = &self.scene.order
            && settled
            && flock.schedule().in_analysis_window(flock.time())
        {
            self.totals.add_window(order, view.target);
        }
    }

    /// Moves the episode's clock on: targets change, the camera takes its picture.
    fn go_on(&mut self) {
        let scene = &mut self.scene;
        scene.episode.step += 1;
        self.ended = scene.episode.is_over();
        scene.flock.set_target(scene.episode.target());
        if let Some(camera) = &mut self.camera {
            let (poses, velocities) = (scene.flock.poses(), scene.flock.velocities());
            camera.expose(scene.rudders.len(), poses, velocities);
        }
    }

    /// The run, to be stored.
    pub fn stored(&self) -> StoredRun {
        StoredRun {
            flock: self.scene.flock.snapshot(),
            episode: self.scene.episode.clone(),
            rudders: self.scene.rudders.clone(),
            camera: self.camera.as_ref().map(Camera::state),
            terms: self.terms.clone(),
            totals: self.totals,
            ended: self.ended,
        }
    }

    /// The run that was stored, in an environment with these settings and parameters.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if it does not belong there.
    pub fn restored(
        settings: &EnvSettings,
        parameters: &FlockParameters,
        stored: StoredRun,
    ) -> Result<Self> {
        let (leaders, boats) = (parameters.n_leaders, parameters.n_boats);
        let flock = flock_from(&stored.flock, parameters)?;
        let fits = stored.rudders.len() == leaders
            && stored.rudders.iter().all(|rudder| rudder.abs() <= 1.0)
            && stored.terms.len() == leaders
            && stored.episode.steps == settings.episode.steps()
            && stored.episode.bw_s == flock.parameters().bw_s
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
        let seed = stored.episode.flock_seed;
        let mut run = Self::new(settings, stored.episode, flock);
        run.scene.rudders = stored.rudders;
        run.camera = stored.camera.map(|state| {
            let mut camera = Camera::unexposed(settings.camera, seed);
            camera.set_state(state, leaders);
            camera
        });
        run.terms = stored.terms;
        run.totals = stored.totals;
        run.ended = stored.ended;
        Ok(run)
    }
}
