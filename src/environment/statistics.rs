//! Sums over an episode, and the summary at its end.

use super::reward::stored_terms;
use super::{EpisodeSchedule, RewardTerm, RewardTerms};
use crate::analysis::OrderParameters;
use crate::analysis::collective_state::OrderingWatch;
use crate::analysis::quantities::{Boats, SUMMARIZED, summarized, summarized_values};
use crate::by_name;
use crate::flock::Flock;
use crate::parameters::{Target, Value, named_fields};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::f64::consts::PI;

/// A flock with a signed order above this moves in the target direction.
pub const TOWARDS_TARGET: f64 = 0.5;
/// Largest angle in rad from the tangent at which a flock counts as ordered: the angle of eq. (7), and a wider one, since
/// boats that slide along the wall head somewhat outward.
pub const ORDERED_WITHIN: [f64; 2] = [PI / 20.0, PI / 4.0];

/// Means of the summarized quantities, or their sums while the episode runs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Averages([f64; SUMMARIZED]);

impl Averages {
    /// Names and values, in the order of the table.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        summarized().map(|quantity| quantity.name).zip(self.0)
    }
}

impl Serialize for Averages {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        by_name::write(self.named().collect::<Vec<_>>(), serializer)
    }
}

/// A quantity that is missing was not recorded: its mean is NaN.
impl<'de> Deserialize<'de> for Averages {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut averages = Self([f64::NAN; SUMMARIZED]);
        by_name::read(deserializer, "the averages of an episode", |name, value| {
            let index = summarized().position(|quantity| quantity.name == name);
            index.map(|index| averages.0[index] = value).is_some()
        })?;
        Ok(averages)
    }
}

/// Sums over the control steps of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct EpisodeStatistics {
    /// Sum of each reward term, mean over leaders.
    #[serde(with = "stored_terms")]
    terms: RewardTerms,
    /// Sum of the rewards, mean over leaders.
    reward: f64,
    /// Control steps in the analysis window.
    window_steps: u32,
    /// Sums of the summarized quantities over the steps in the window.
    averages: Averages,
    /// Number of steps in the window with a signed order above [`TOWARDS_TARGET`].
    steps_towards_target: u32,
    /// For each angle of [`ORDERED_WITHIN`], when the flock was ordered.
    ordering: [OrderingWatch; 2],
    /// Observed numbers that were clipped.
    clipped: u64,
    /// All observed numbers.
    observed: u64,
}

impl EpisodeStatistics {
    /// Adds a reward, mean over leaders, to the episode's sum.
    pub(super) fn add_reward(&mut self, reward: f64) {
        self.reward += reward;
    }

    /// Adds a leader's terms of one step. `share` is 1 over the number of leaders, so that leaders are averaged.
    pub(super) fn add_terms(&mut self, share: f64, terms: &RewardTerms) {
        for (sum, term) in self.terms.iter_mut().zip(terms) {
            *sum += share * term;
        }
    }

    /// Adds a step inside the analysis window.
    pub(super) fn add_window_step(&mut self, boats: &Boats, target: Target) {
        self.window_steps += 1;
        let values = summarized_values(boats, target);
        for (sum, value) in self.averages.0.iter_mut().zip(values) {
            *sum += value;
        }
        self.steps_towards_target += u32::from(boats.order.signed_order(target) > TOWARDS_TARGET);
    }

    /// Records the order for the ordering times, `time_s` after the episode's start. `is_second_half`: the step belongs
    /// to the second half of the episode, whose mean order decides whether the flock ordered.
    pub(super) fn record_order(
        &mut self,
        order: &OrderParameters,
        time_s: f64,
        is_second_half: bool,
    ) {
        for (watch, within) in self.ordering.iter_mut().zip(ORDERED_WITHIN) {
            watch.note(time_s, order, within, is_second_half);
        }
    }

    /// Adds to the counts of observed and of clipped numbers.
    pub(super) fn count_clipped(&mut self, clipped: u32, observed: usize) {
        self.clipped += u64::from(clipped);
        self.observed += observed as u64;
    }

    /// The summary of the episode with this schedule and flock.
    pub(super) fn summary(&self, schedule: &EpisodeSchedule, flock: &Flock) -> EpisodeSummary {
        let contact_statistics = flock.statistics();
        let steps = f64::from(schedule.step);
        let window_steps = f64::from(self.window_steps);
        EpisodeSummary {
            flock_seed: schedule.flock_seed,
            bw_s: flock.parameters().bw_s,
            steps: schedule.step,
            total_reward: self.reward,
            terms: self.terms.map(|sum| sum / steps),
            averages: Averages(self.averages.0.map(|sum| sum / window_steps)),
            share_towards_target: f64::from(self.steps_towards_target) / window_steps,
            ordering_times_s: self.ordering.map(|watch| watch.ordering_time_s()),
            clip_rate: self.clipped as f64 / self.observed.max(1) as f64,
            worst_overlap_cm: contact_statistics.worst_overlap_cm,
            unsolved: contact_statistics.unsolved,
            halved_substeps: contact_statistics.halved_substeps,
        }
    }
}

impl EpisodeSummary {
    /// The summary by name. If the episode did not reach the analysis window, its means are left out instead of NaN.
    pub fn named(&self) -> Value {
        let fields = named_fields!(self; flock_seed bw_s steps total_reward clip_rate
            worst_overlap_cm unsolved halved_substeps);
        let terms = ("reward_terms", RewardTerm::named(&self.terms).collect());
        let share = ("share_towards_target", self.share_towards_target);
        let means = self.averages.named().chain([share]);
        let means = means.filter(|(_, mean)| !mean.is_nan());
        let [narrow, wide] = self.ordering_times_s;
        let ordering_times = [("ordering_time_s", narrow), ("ordering_time_wide_s", wide)];
        let numbers = means
            .chain(ordering_times)
            .map(|(name, number)| (name, number.into()));
        fields.into_iter().chain([terms]).chain(numbers).collect()
    }
}

/// The summary of an episode.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EpisodeSummary {
    /// Seed of its flock.
    pub flock_seed: u64,
    /// Its backward duration: length of the backward phase in s.
    pub bw_s: f64,
    /// Control steps taken.
    pub steps: u32,
    /// Sum of the rewards over the episode, mean over leaders.
    pub total_reward: f64,
    /// Each reward term, mean over steps and leaders; NaN before the first step.
    #[serde(with = "stored_terms")]
    pub terms: RewardTerms,
    /// Means over the control steps in the analysis window after the first tenth of the episode; NaN if there are no
    /// such steps.
    pub averages: Averages,
    /// Fraction of the steps of `averages` in which the signed order exceeds [`TOWARDS_TARGET`].
    pub share_towards_target: f64,
    /// Ordering times (eq. 7) in s since the episode started, for each angle of [`ORDERED_WITHIN`]; infinite if the flock
    /// did not order.
    pub ordering_times_s: [f64; 2],
    /// Fraction of the observed numbers that were clipped at their bounds; 0 without leaders.
    pub clip_rate: f64,
    /// The flock's [`Statistics`](crate::contact::Statistics) of that name at the episode's end.
    pub worst_overlap_cm: f64,
    /// As for `worst_overlap_cm`.
    pub unsolved: u64,
    /// As for `worst_overlap_cm`.
    pub halved_substeps: u64,
}
