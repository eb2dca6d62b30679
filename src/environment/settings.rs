//! Options of an environment besides the flock's parameters, each declared once. The bindings, their defaults and the
//! documentation follow from this table.

use super::action::{self, ActionMode};
use super::observation::{Block, Lens, ObservationLayout, Observer};
use super::{Drawn, Servo, TargetChoice, Weights};
use crate::clock::{Ticks, ticks, whole_steps};
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, Range, declare_fields, named_choice};

named_choice! {
    /// Behavior at the end of an episode.
    pub enum Autoreset ("autoreset_mode") {
        /// The next step starts a new episode and ignores its action.
        NextStep = "next_step",
        /// The same step starts a new episode; the last observation is kept aside.
        SameStep = "same_step",
        /// Nothing: the user resets.
        Disabled = "disabled",
    }
}

/// The largest chance below 1.
const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

declare_fields! {
    /// The settings of an environment.
    pub struct EnvSettings;

    /// "cw", "ccw", "random" (drawn for each episode) or "alternate" (ccw, cw, ccw, cw, a quarter of the episode each); or a list of "cw" and "ccw", one per leader
    target: TargetChoice = TargetChoice::default(), "", Range::Any, "chosen";
    /// length of an episode in s, rounded to whole control steps; None: 960 if the targets alternate, otherwise 480
    episode_s: Option<f64> = None, "s", Range::Dependent("at least one control step, at most 1e6 s"), "chosen";
    /// control steps per second
    control_hz: f64 = 10.0, "1/s", Range::Within(0.1, 1000.0, "0.1 to 1000 control steps per second"), "chosen";
    /// meaning of an action in [-1, 1]: "rudder", the rudder itself; "heading", the angle of a heading outward of the target's tangent, over pi, to which the damped law steers; or "lean", such an angle over 1.2 rad, to which the pool's tuned law steers: the action 0 is that law itself
    action_mode: ActionMode = ActionMode::Rudder, "", Range::Any, "chosen";
    /// time in s from one decision to the next, a whole number of control steps; the action is held meanwhile; None:
    /// one control step
    decision_period_s: Option<f64> = None, "s", Range::Dependent("a whole number of control steps"), "chosen";
    /// bw_s of each episode, fixed or drawn uniformly from a range (low, high); None: that of the parameters
    bw_s: Option<Drawn> = None, "s", Range::NonNegative, "chosen";
    /// blocks that differ from the default layout, such as `{'order': False, 'neighbors': 4}`
    observation: ObservationLayout = ObservationLayout::default(), "", Range::Any, "chosen";
    /// reflect observation, state and action if the target is ccw, so that both directions are one task
    mirror_to_target: bool = false, "", Range::Any, "chosen";
    /// chance that the camera misses a boat in a frame and shows it as in the frame before
    dropout_rate: f64 = 0.0, "", Range::Within(0.0, ALMOST_ONE, "a chance of at least 0, below 1"), "chosen";
    /// delay in frames of the picture that leaders see, 0 or 1
    delay_frames: usize = 0, "", Range::Within(0.0, 1.0, "0 or 1"), "chosen";
    /// weights of the reward's terms, or a list of such weights, one per leader; terms that are not named have the weight 0
    reward: Weights = Weights::default(), "", Range::Any, "chosen";
    /// time T in s: a control step's reward is multiplied by the step's length over T, so that the sum of rewards over a
    /// time T is a mean, of order one; None: no factor
    reward_horizon_s: Option<f64> = None, "s", Range::Positive, "chosen";
    /// number of levels of the discrete action, 2 to 1001; None: continuous
    rudder_levels: Option<usize> = None, "", Range::Within(2.0, 1001.0, "2 to 1001 choices, or none for continuous rudders"), "chosen";
    /// time constant of the rudder servo in s
    rudder_lag_s: f64 = 0.0, "s", Range::Within(0.0, 1e3, "0 (no lag) to 1000 s"), "chosen";
    /// fastest change of the rudder in 1/s (-1 to 1 is a change of 2); None: no limit
    rudder_rate_per_s: Option<f64> = None, "1/s", Range::Positive, "chosen";
    /// what happens at an episode's end in the vector environment: "next_step", "same_step" or "disabled"
    autoreset_mode: Autoreset = Autoreset::NextStep, "", Range::Any, "chosen";
}

/// An observer with this layout for flocks with these parameters.
///
/// # Errors
/// [`FlockError::Parameter`] for a layout that these flocks cannot have.
pub(super) fn observer(
    layout: ObservationLayout,
    parameters: &FlockParameters,
) -> Result<Observer> {
    let observer = Observer::new(layout, parameters)?;
    let has_normal_boats = parameters.n_leaders < parameters.n_boats;
    for block in [Block::Order, Block::LeanFeatures] {
        let is_accepted = has_normal_boats || !layout.has(block);
        let accepted = "order parameters need a normal boat: n_boats > n_leaders";
        FlockError::unless(is_accepted, block.option(), true, accepted)?;
    }
    Ok(observer)
}

impl EnvSettings {
    /// Checks the settings for flocks with these checked parameters.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] names the first setting that is not accepted.
    pub fn check(&self, parameters: &FlockParameters) -> Result<()> {
        Self::FIELDS
            .iter()
            .try_for_each(|field| field.check(self))?;
        let duration = self.duration_s();
        let steps = duration * self.control_hz;
        let accepted = "at least one control step, at most 1e6 s";
        let is_in_range = duration <= 1e6 && (0.5..=1e9).contains(&steps);
        FlockError::unless(is_in_range, "episode_s", duration, accepted)?;
        let step_s = 1.0 / self.control_hz;
        let horizon = self.reward_horizon_s.unwrap_or(step_s);
        let accepted = format!("at least one control step of {step_s} s");
        // With ten control steps per second, 0.1 s must be accepted in spite of rounding.
        let is_long_enough = horizon >= (1.0 - 1e-9) * step_s;
        FlockError::unless(is_long_enough, "reward_horizon_s", horizon, accepted)?;
        self.bw_s.map_or(Ok(()), |bw_s| bw_s.check("bw_s"))?;
        self.target.check(parameters.n_leaders)?;
        self.observation.check()?;
        self.action_mode.steering_law(parameters)?;
        if let Some(period) = self.decision_period_s {
            let (name, steps) = ("decision_period_s", "control steps");
            whole_steps(name, period, self.control_hz, steps)?;
        }
        observer(self.layout(), parameters)?;
        self.reward.check(parameters)
    }

    /// The layout of observations, mirrored or not.
    pub fn layout(&self) -> ObservationLayout {
        self.observation.mirrored(self.mirror_to_target)
    }

    /// Length of an episode in s.
    pub fn duration_s(&self) -> f64 {
        self.episode_s.unwrap_or(match self.target {
            TargetChoice::Alternate => 960.0,
            TargetChoice::Fixed(_) | TargetChoice::Random => 480.0,
        })
    }

    /// Length of an episode in control steps.
    pub fn steps(&self) -> u32 {
        (self.duration_s() * self.control_hz).round() as u32
    }

    /// Control steps from one decision to the next.
    pub fn period_steps(&self) -> u32 {
        self.decision_period_s
            .map_or(1, |period| (period * self.control_hz).round() as u32)
    }

    /// Time from an episode's start to the end of its first `steps` control steps. Only the sum is rounded to a tick, so
    /// that rounding errors of single steps do not add up.
    pub(crate) fn time_of(&self, steps: u32) -> Ticks {
        ticks(f64::from(steps) / self.control_hz)
    }

    /// The factor that turns the weighted sum of a control step's terms into its reward: the step's length over the
    /// reward horizon.
    pub(crate) fn reward_factor(&self) -> f64 {
        self.reward_horizon_s
            .map_or(1.0, |horizon| 1.0 / (self.control_hz * horizon))
    }

    /// Checks one action.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for NaN and for levels that do not exist. Numbers beyond ±1 are accepted and clipped.
    pub fn check_action(&self, action: f64) -> Result<()> {
        action::check(action, self.rudder_levels)
    }

    /// The value in [−1, 1] of a checked action: the action clipped, or the value of its level.
    pub fn command(&self, action: f64) -> f64 {
        action::command(action, self.rudder_levels)
    }

    /// The rudder servo for control steps of this environment.
    pub fn servo(&self) -> Servo {
        Servo::new(
            self.rudder_lag_s,
            self.rudder_rate_per_s,
            1.0 / self.control_hz,
        )
    }

    /// Flaws of the leaders' camera; `None` if leaders see the flock as it is.
    pub(crate) fn lens(&self) -> Option<Lens> {
        Lens::new(self.dropout_rate, self.delay_frames)
    }
}
