//! A running episode: the flock, its leaders' rudders, observations and rewards so far.

use super::credit::{ContactCredit, LeaderCredit};
use super::observation::{
    Camera, CourseView, FlockFeatures, FlockView, ObservationLayout, Observer, StateObserver,
};
use super::reset::check_flock;
use super::reward::stored_rows;
use super::settings::observer;
use super::statistics::EpisodeStatistics;
use super::{EnvSettings, EpisodeSchedule, EpisodeSummary, Reward, RewardTerms, Servo, TERMS};
use crate::analysis::OrderParameters;
use crate::analysis::quantities::Boats;
use crate::boat::DampedLaw;
use crate::clock::{Ticks, seconds};
use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use crate::flock::Flock;
use crate::integrator::{Integrator, Steering};
use crate::parameters::{FlockParameters, Target, Targets};

/// Stored state of an episode.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct EpisodeState {
    flock: Flock,
    schedule: EpisodeSchedule,
    /// The leaders' present rudders, positive counter-clockwise.
    rudders: Vec<f64>,
    /// The camera through which leaders see the flock; `None` if they see it as it is.
    camera: Option<Camera>,
    /// Each leader's reward terms, means over the control steps since the last decision.
    #[serde(with = "stored_rows")]
    terms: Vec<RewardTerms>,
    statistics: EpisodeStatistics,
    ended: bool,
    /// Effects of the leaders' contacts; `None` if no reward term needs them.
    credit: Option<ContactCredit>,
    /// Order parameters of the normal boats; `None` if there are none.
    #[serde(skip)]
    order: Option<OrderParameters>,
}

impl EpisodeState {
    fn new(settings: &EnvSettings, schedule: EpisodeSchedule, flock: Flock) -> Self {
        let parameters = flock.parameters();
        let (leaders, boats) = (parameters.n_leaders, parameters.n_boats);
        let lens = settings.lens();
        let credit = settings.reward.need_credit();
        Self {
            rudders: vec![0.0; leaders],
            camera: lens.map(|lens| Camera::new(lens, schedule.flock_seed, leaders, &flock)),
            terms: vec![[0.0; TERMS]; leaders],
            statistics: EpisodeStatistics::default(),
            ended: false,
            credit: credit.then(|| ContactCredit::new(leaders, boats)),
            order: None,
            schedule,
            flock,
        }
    }

    /// Whether this state fits an environment with these settings and parameters.
    fn fits(&self, settings: &EnvSettings, parameters: &FlockParameters) -> bool {
        let (leaders, boats) = (parameters.n_leaders, parameters.n_boats);
        let (camera, credit) = (self.camera.as_ref(), self.credit.as_ref());
        self.rudders.len() == leaders
            && self.rudders.iter().all(|rudder| rudder.abs() <= 1.0)
            && self.terms.len() == leaders
            && self.schedule.steps == settings.steps()
            && self.schedule.targets() == self.flock.parameters().target
            && credit.is_some() == settings.reward.need_credit()
            && credit.is_none_or(|credit| credit.fits(leaders, boats))
            && camera.is_some() == settings.lens().is_some()
            && camera.is_none_or(|camera| camera.fits(boats))
    }

    /// Computes the order parameters of the normal boats as they are now.
    fn update_order(&mut self) {
        self.order = self.flock.order_parameters(Flock::WITHOUT_LEADERS).ok();
    }

    /// The flock as it is, not as the camera shows it.
    fn true_view(&self) -> FlockView<'_> {
        FlockView::new(&self.flock, &self.rudders, self.order.as_ref())
    }

    /// The flock as leaders see it: through the camera, if there is one.
    fn leaders_view(&self) -> FlockView<'_> {
        let (view, camera) = (self.true_view(), self.camera.as_ref());
        camera.map_or(view, |camera| camera.through(view))
    }
}

/// A running episode.
#[derive(Debug, Clone)]
pub struct Episode {
    state: EpisodeState,
    observer: Observer,
    /// The law that steers to an action's heading, and a reader of its inputs; `None` if actions are rudders.
    law: Option<(DampedLaw, CourseView)>,
    /// Rudder commands of the present control step, one per leader.
    commands: Vec<f64>,
}

impl Episode {
    /// An episode that starts with this flock.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if the settings need a law that the flock's pool does not have.
    pub fn new(settings: &EnvSettings, schedule: EpisodeSchedule, flock: Flock) -> Result<Self> {
        Self::from_state(settings, EpisodeState::new(settings, schedule, flock))
    }

    fn from_state(settings: &EnvSettings, mut state: EpisodeState) -> Result<Self> {
        state.update_order();
        let parameters = state.flock.parameters();
        let law = settings.action_mode.steering_law(parameters)?;
        let law = law.map(|law| Ok((law, CourseView::new(parameters)?)));
        Ok(Self {
            observer: Observer::new(settings.layout(), parameters)?,
            law: law.transpose()?,
            commands: vec![0.0; parameters.n_leaders],
            state,
        })
    }

    /// Continues a stored episode in an environment with these settings and parameters.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] if the episode does not fit the environment.
    pub(crate) fn restored(
        settings: &EnvSettings,
        parameters: &FlockParameters,
        mut state: EpisodeState,
    ) -> Result<Self> {
        check_flock(&state.flock, parameters)?;
        let reason = "the state holds an episode that this environment cannot have";
        FlockError::unless_fitting(state.fits(settings, parameters), reason)?;
        let (seed, leaders) = (state.schedule.flock_seed, parameters.n_leaders);
        let camera = settings.lens().zip(state.camera);
        state.camera = camera.map(|(lens, camera)| camera.with_lens(lens, seed, leaders));
        Self::from_state(settings, state)
    }

    /// The part of the episode that is stored.
    pub(crate) fn state(&self) -> &EpisodeState {
        &self.state
    }

    /// The flock.
    pub fn flock(&self) -> &Flock {
        &self.state.flock
    }

    /// The episode's random draws and its progress.
    pub fn schedule(&self) -> &EpisodeSchedule {
        &self.state.schedule
    }

    /// Whether the episode has ended.
    pub fn has_ended(&self) -> bool {
        self.state.ended
    }

    /// Present order parameters of the normal boats; `None` if there are none.
    pub fn order(&self) -> Option<&OrderParameters> {
        self.state.order.as_ref()
    }

    /// Each leader's reward terms, means over the control steps since the last decision.
    pub fn terms(&self) -> &[RewardTerms] {
        &self.state.terms
    }

    /// The leaders' present rudders, positive counter-clockwise.
    pub fn rudders(&self) -> &[f64] {
        &self.state.rudders
    }

    /// Statistics of the episode so far.
    pub fn summary(&self) -> EpisodeSummary {
        let state = &self.state;
        state.statistics.summary(&state.schedule, &state.flock)
    }

    /// The leaders' targets in the next control step; after the last step, those of the last step.
    pub fn targets(&self) -> &Targets {
        &self.state.flock.parameters().target
    }

    /// Writes the leaders' present observations; returns how many numbers were clipped.
    pub fn observe(&mut self, out: &mut [f32]) -> u32 {
        self.observer.observe(&self.state.leaders_view(), out)
    }

    /// Writes the leaders' present observations, and counts the clipped numbers in the episode's statistics.
    pub(crate) fn observe_and_count(&mut self, out: &mut [f32]) {
        let clipped = self.observe(out);
        self.state.statistics.count_clipped(clipped, out.len());
    }

    /// Writes the leaders' present observations in another layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for a layout that the flock cannot have.
    pub(crate) fn observe_in(&self, layout: ObservationLayout, out: &mut [f32]) -> Result<()> {
        let mut observer = observer(layout, self.state.flock.parameters())?;
        observer.observe(&self.state.leaders_view(), out);
        Ok(())
    }

    /// Writes the global state, without the camera's flaws.
    pub(crate) fn observe_state(&self, observer: &StateObserver, out: &mut [f32]) {
        let elapsed = self.state.schedule.elapsed();
        observer.observe(&self.state.true_view(), elapsed, out);
    }

    /// Writes the features of the flock in the frame of a target, without the camera's flaws.
    pub(crate) fn observe_features(
        &self,
        features: &FlockFeatures,
        target: Target,
        out: &mut [f32],
    ) {
        let elapsed = self.state.schedule.elapsed();
        features.observe(&self.state.true_view(), target, elapsed, out);
    }

    /// Holds checked actions, one per leader, over the control steps until the next decision or the episode's end.
    /// Writes each leader's reward, summed over these steps. Without actions leaders follow the steering law at every
    /// substep.
    ///
    /// # Errors
    /// [`FlockError::Solver`] and [`FlockError::Interrupted`]; the flock stays at the start of the control step that
    /// failed, and the episode is over.
    pub fn step(
        &mut self,
        keep_going: KeepGoing,
        settings: &EnvSettings,
        servo: &Servo,
        actions: Option<&[f64]>,
        rewards: &mut [f64],
    ) -> Result<()> {
        // If the target is reversed before the next decision, a rudder chosen in the mirrored view keeps its sign.
        let mirror_to = settings.mirror_to_target.then(|| self.targets().clone());
        self.state.terms.fill([0.0; TERMS]);
        rewards.fill(0.0);
        let follows_law = actions.is_none();
        let mut steps = 0;
        loop {
            if let Some(actions) = actions {
                self.command(settings, actions, mirror_to.as_ref());
                self.move_rudders(servo);
            }
            let elapsed = self.advance(keep_going, settings, follows_law)?;
            self.add_rewards(settings, rewards);
            self.record_order(elapsed);
            self.advance_schedule()?;
            steps += 1;
            if steps >= settings.period_steps() || self.state.ended {
                break;
            }
        }
        if steps > 1 {
            let terms = self.state.terms.iter_mut().flatten();
            terms.for_each(|term| *term /= f64::from(steps));
        }
        Ok(())
    }

    /// Computes the rudder commands of a control step from the leaders' actions.
    ///
    /// `mirror_to` holds the targets at the decision if observations are mirrored, otherwise `None`. Leaders with a
    /// counter-clockwise target chose the rudder of the mirrored view, which has the opposite sign.
    fn command(&mut self, settings: &EnvSettings, actions: &[f64], mirror_to: Option<&Targets>) {
        let mut commands = std::mem::take(&mut self.commands);
        let view = self.state.leaders_view();
        for (leader, (command, &action)) in commands.iter_mut().zip(actions).enumerate() {
            let value = settings.command(action);
            let is_mirrored = mirror_to.is_some_and(|targets| targets.of(leader).sign() < 0.0);
            *command = match &self.law {
                Some((law, courses)) => {
                    let angle = settings.action_mode.angle(value);
                    let rudder = law.rudder(&courses.course(&view, leader, angle));
                    // Rounded to single precision, as actions are.
                    f64::from(rudder as f32)
                }
                None if is_mirrored => -value,
                None => value,
            };
        }
        self.commands = commands;
    }

    /// Moves the rudders towards their commands.
    fn move_rudders(&mut self, servo: &Servo) {
        for (rudder, &command) in self.state.rudders.iter_mut().zip(&self.commands) {
            *rudder = servo.moved(*rudder, command);
        }
    }

    /// Advances the flock by a control step, with the rudders or the steering law; returns the time from the episode's
    /// start to the end of this step.
    fn advance(
        &mut self,
        keep_going: KeepGoing,
        settings: &EnvSettings,
        follows_law: bool,
    ) -> Result<Ticks> {
        let state = &mut self.state;
        let step = state.schedule.step;
        let [elapsed_before, elapsed] = [step, step + 1].map(|step| settings.time_of(step));
        let end = state.flock.time() + elapsed - elapsed_before;
        let steering = if follows_law {
            Steering::Law
        } else {
            Steering::Held(&state.rudders)
        };
        let advanced = match &mut state.credit {
            None => state.flock.advance_to(keep_going, end, steering),
            Some(credit) => {
                credit.start_step();
                let watch = &mut |flock: &Integrator| credit.add_contacts(flock);
                let flock = &mut state.flock;
                flock.advance_watched(keep_going, end, steering, watch)
            }
        };
        if let Err(error) = advanced {
            state.ended = true;
            return Err(error);
        }
        if follows_law {
            let rudders = (0..state.rudders.len()).map(|leader| state.flock.steering_law(leader));
            state.rudders = rudders.collect();
        }
        if let Some(credit) = &mut state.credit {
            credit.advance_turns(&state.flock.integrator, 1.0 / settings.control_hz);
        }
        state.update_order();
        Ok(elapsed)
    }

    /// Adds each leader's terms and reward of the control step just taken, for the target of that step.
    fn add_rewards(&mut self, settings: &EnvSettings, rewards: &mut [f64]) {
        let state = &mut self.state;
        let flock = &state.flock;
        let view = FlockView::new(flock, &state.rudders, state.order.as_ref());
        let flock_reward = Reward::new(flock.parameters(), &view);
        let (share, step_s) = (1.0 / rewards.len() as f64, 1.0 / settings.control_hz);
        for (leader, (term_sums, reward_sum)) in state.terms.iter_mut().zip(rewards).enumerate() {
            let target = view.targets.of(leader);
            let credit = state.credit.as_ref();
            let credit = credit.map_or_else(LeaderCredit::default, |credit| {
                credit.of_leader(leader, &flock.integrator, target, step_s)
            });
            let terms = flock_reward.terms(&view, leader, &credit);
            let reward = settings.reward_factor() * settings.reward.total(leader, &terms);
            state.statistics.add_terms(share, &terms);
            state.statistics.add_reward(share * reward);
            *reward_sum += reward;
            for (sum, term) in term_sums.iter_mut().zip(terms) {
                *sum += term;
            }
        }
    }

    /// Adds rewards that a user computed, one per leader, to the episode's statistics.
    pub(crate) fn add_user_rewards(&mut self, rewards: &[f64]) {
        let sum: f64 = rewards.iter().sum();
        let statistics = &mut self.state.statistics;
        statistics.add_reward(sum / rewards.len().max(1) as f64);
    }

    /// Records the order of the control step just taken, which ends at the time `elapsed` since the episode's start.
    /// After the first tenth of the episode, steps that end in the analysis window also count in the averages.
    fn record_order(&mut self, elapsed: Ticks) {
        let (flock, statistics) = (&self.state.flock, &mut self.state.statistics);
        let Some(order) = self.state.order else {
            return;
        };
        let schedule = &self.state.schedule;
        let (step, steps) = (u64::from(schedule.step) + 1, u64::from(schedule.steps));
        let is_second_half = 2 * step >= steps;
        statistics.record_order(&order, seconds(elapsed), is_second_half);
        let is_first_tenth = 10 * step <= steps;
        if is_first_tenth || !flock.schedule().in_analysis_window(flock.time()) {
            return;
        }
        let (hulls, velocities) = flock.measured(Flock::WITHOUT_LEADERS);
        let boats = Boats {
            hulls,
            velocities,
            order,
        };
        statistics.add_window_step(&boats, flock.parameters().target.reference());
    }

    /// Advances the schedule by a control step: targets may change, and the camera takes a frame.
    fn advance_schedule(&mut self) -> Result<()> {
        let state = &mut self.state;
        state.schedule.step += 1;
        state.ended = state.schedule.step >= state.schedule.steps;
        if state.schedule.alternates {
            state.flock.set_target(state.schedule.targets())?;
        }
        if let Some(camera) = &mut state.camera {
            camera.take_frame(state.rudders.len(), &state.flock);
        }
        Ok(())
    }
}
