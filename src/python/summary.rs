//! Episodes and their summaries, as the dictionaries that infos hold.

use super::value::written;
use crate::environment::{EpisodeSchedule, EpisodeSummary, LeaderSummary, RewardTerm};
use crate::parameters::Value;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An episode's target, backward duration, seed and step.
pub(super) fn episode_dict<'py>(
    py: Python<'py>,
    schedule: &EpisodeSchedule,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("target", written(&Value::from(&schedule.targets()), py)?)?;
    dict.set_item("bw_s", schedule.bw_s)?;
    dict.set_item("flock_seed", schedule.flock_seed)?;
    dict.set_item("step", schedule.step)?;
    Ok(dict)
}

/// A summary by name, with what each leader with a target of its own has: arrays (k,). Means over an analysis window
/// that the episode did not reach are left out: infos hold no NaN.
pub(super) fn summary_dict<'py>(
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
        ("leader_targets", |leader| leader.target.sign()),
        ("leader_total_rewards", |leader| leader.total_reward),
        ("leader_signed_orders", |leader| leader.signed_order),
        ("leader_shares_towards_target", |leader| {
            leader.share_towards_target
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
