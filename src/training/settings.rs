//! The options of a training, each declared once, apart from the flocks' parameters.

use crate::clock::whole_steps;
use crate::environment::observation::{Block, ObservationLayout};
use crate::environment::{ActionMode, Autoreset, EnvSettings};
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, Range, declare_fields};

/// Control steps per second.
const CONTROL_HZ: f64 = 10.0;

declare_fields! {
    /// The settings of a training.
    pub struct BranchSettings;

    /// "lean": an action is an angle to the target's tangent, to which the tuned law steers, and the training starts from that law itself; "rudder": an action is a rudder, and the training starts from rudders of 0
    action_mode: ActionMode = ActionMode::Lean, "", Range::Any, "chosen";
    /// simulated time of the whole training in hours, summed over all flocks; rounded up to whole rounds
    flock_hours: f64 = 200.0, "h", Range::Within(1e-3, 1e6, "0.001 to 1e6 flock-hours"), "chosen";
    /// number of pairs of flocks in a round; the weights change after each round
    pairs: usize = 64, "", Range::Within(1.0, 65536.0, "1 to 65536 pairs"), "chosen";
    /// time in s from one decision to the next, a whole number of tenths
    decision_period_s: f64 = 1.0, "s", Range::Positive, "chosen";
    /// length of a branch in s
    branch_s: f64 = 64.0, "s", Range::Dependent("a whole number of decisions"), "chosen";
    /// time in s for which an offset is held
    hold_s: f64 = 16.0, "s", Range::Dependent("a whole number of decisions, at most branch_s"), "chosen";
    /// time in s from the start of a hold over which the features are averaged: a longer average is less noisy, but smooths out fast changes
    seen_s: f64 = 1.0, "s", Range::Dependent("a whole number of decisions, at most hold_s"), "chosen";
    /// time in s from the start of a branch in which leaders try offsets, one hold after another
    trial_s: f64 = 32.0, "s", Range::Dependent("a whole number of holds, at most branch_s"), "chosen";
    /// time in s from the start of a branch in which the order does not count, since an offset may at first change the order in the wrong direction
    blind_s: f64 = 8.0, "s", Range::Dependent("a whole number of decisions, less than branch_s"), "chosen";
    /// length of an episode in s, after which the pair starts at rest again
    episode_s: f64 = 480.0, "s", Range::Dependent("at least branch_s"), "chosen";
    /// size of an action's offset, as a fraction of the largest action
    offset: f64 = 0.33, "", Range::Within(1e-6, 1.0, "above 0, at most 1"), "chosen";
    /// root mean square change of the actions by the first round, as a fraction of the largest action; it falls to 0 over the training
    step: f64 = 0.0167, "", Range::Within(1e-9, 1.0, "above 0, at most 1"), "chosen";
    /// factor by which the weight of earlier rounds falls with each round
    memory: f64 = 0.93, "", Range::Within(0.0, 0.9999, "0 to 0.9999"), "chosen";
    /// ridge of the regression, as a fraction of the regressors' mean square
    ridge: f64 = 0.1, "", Range::Within(1e-6, 1e6, "1e-6 to 1e6"), "chosen";
}

/// Lengths of a training's periods, as numbers of decisions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decisions {
    /// Decisions in `branch_s`.
    pub branch: usize,
    /// Decisions in `hold_s`.
    pub hold: usize,
    /// Decisions in `seen_s`.
    pub seen: usize,
    /// Decisions in `trial_s`.
    pub trial: usize,
    /// Decisions in `blind_s`.
    pub blind: usize,
}

impl BranchSettings {
    /// The usual settings for an action mode.
    pub fn usual(action_mode: ActionMode) -> Self {
        match action_mode {
            ActionMode::Rudder => Self {
                action_mode,
                flock_hours: 100.0,
                pairs: 32,
                decision_period_s: 0.4,
                branch_s: 32.0,
                hold_s: 8.0,
                seen_s: 8.0,
                trial_s: 16.0,
                blind_s: 2.0,
                episode_s: 128.0,
                step: 0.05,
                ..Self::default()
            },
            ActionMode::Lean | ActionMode::Heading => Self {
                action_mode,
                ..Self::default()
            },
        }
    }

    /// Checks the settings together with the parameters of the flocks.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] names the first that is not accepted.
    pub fn check(&self, parameters: &FlockParameters) -> Result<()> {
        parameters.check()?;
        let accepted = "at least 1 leader, who learns";
        FlockError::unless(parameters.n_leaders > 0, "n_leaders", 0, accepted)?;
        Self::FIELDS
            .iter()
            .try_for_each(|field| field.check(self))?;
        let accepted = "\"lean\" or \"rudder\"";
        let is_learned = self.action_mode != ActionMode::Heading;
        FlockError::unless(is_learned, "action_mode", self.action_mode.name(), accepted)?;
        let Decisions {
            branch,
            hold,
            seen,
            trial,
            blind,
        } = self.decisions()?;
        let accepted = "at most branch_s";
        FlockError::unless(hold <= branch, "hold_s", self.hold_s, accepted)?;
        FlockError::unless(seen <= hold, "seen_s", self.seen_s, "at most hold_s")?;
        let is_whole_holds = trial > 0 && trial <= branch && trial.is_multiple_of(hold);
        let accepted = "a whole number of holds, at most branch_s";
        FlockError::unless(is_whole_holds, "trial_s", self.trial_s, accepted)?;
        FlockError::unless(
            blind < branch,
            "blind_s",
            self.blind_s,
            "less than branch_s",
        )?;
        let is_long_enough = self.episode_s >= self.branch_s && self.episode_s <= 1e6;
        let accepted = "at least branch_s, at most 1e6 s";
        FlockError::unless(is_long_enough, "episode_s", self.episode_s, accepted)?;
        self.env_settings().check(parameters)
    }

    /// The lengths of the periods in decisions.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] for times that are not whole numbers of decisions.
    pub(super) fn decisions(&self) -> Result<Decisions> {
        let rate_hz = 1.0 / self.decision_period_s;
        let count = |name, time_s| {
            whole_steps(name, time_s, rate_hz, "decisions").map(|count| count as usize)
        };
        Ok(Decisions {
            branch: count("branch_s", self.branch_s)?,
            hold: count("hold_s", self.hold_s)?,
            seen: count("seen_s", self.seen_s)?,
            trial: count("trial_s", self.trial_s)?,
            blind: if self.blind_s == 0.0 {
                0
            } else {
                count("blind_s", self.blind_s)?
            },
        })
    }

    /// Settings of the environment in which a branch is one episode and the order is the only reward.
    pub(super) fn env_settings(&self) -> EnvSettings {
        EnvSettings {
            episode_s: Some(self.branch_s),
            control_hz: CONTROL_HZ,
            action_mode: self.action_mode,
            decision_period_s: Some(self.decision_period_s),
            observation: ObservationLayout::from_blocks(&[Block::LeanFeatures]),
            mirror_to_target: true,
            // A decision's reward is the mean order of its control steps.
            reward_horizon_s: Some(self.decision_period_s),
            autoreset_mode: Autoreset::Disabled,
            ..EnvSettings::default()
        }
    }

    /// Simulated time of a round in hours, summed over all flocks.
    pub(super) fn round_hours(&self) -> f64 {
        2.0 * self.pairs as f64 * self.branch_s / 3600.0
    }

    /// Number of rounds in the training.
    pub(super) fn rounds(&self) -> usize {
        // Without the small number, rounding errors could add a round.
        let rounds = self.flock_hours / self.round_hours() - 1e-9;
        rounds.ceil().max(1.0) as usize
    }

    /// Number of branches in an episode.
    pub(super) fn branches(&self) -> usize {
        // Without the small number, rounding errors could lose a branch.
        (self.episode_s / self.branch_s + 1e-9) as usize
    }
}
