//! Summaries of episodes, as the dictionaries that infos hold.

use super::settings::term_names;
use crate::environment::{EpisodeSummary, LeaderSummary};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Adds what each leader with a target of its own has: arrays (k,).
pub(super) fn add_leaders(dict: &Bound<'_, PyDict>, leaders: &[LeaderSummary]) -> PyResult<()> {
    if leaders.is_empty() {
        return Ok(());
    }
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
        // As for the whole flock: infos hold no NaN.
        if !values.iter().any(|value| value.is_nan()) {
            dict.set_item(name, PyArray1::from_vec(dict.py(), values))?;
        }
    }
    Ok(())
}

/// A summary by name.
pub(super) fn summary_dict<'py>(
    py: Python<'py>,
    summary: &EpisodeSummary,
) -> PyResult<Bound<'py, PyDict>> {
    let terms = PyDict::new(py);
    for (name, mean) in term_names(py).iter().zip(summary.terms) {
        terms.set_item(name, mean)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("flock_seed", summary.flock_seed)?;
    dict.set_item("bw_s", summary.bw_s)?;
    dict.set_item("steps", summary.steps)?;
    dict.set_item("total_reward", summary.total_reward)?;
    dict.set_item("reward_terms", terms)?;
    let share = ("share_towards_target", summary.share_towards_target);
    for (name, mean) in summary.averages.named().chain([share]) {
        // A mean over an analysis window that the episode did not reach: infos hold no NaN.
        if !mean.is_nan() {
            dict.set_item(name, mean)?;
        }
    }
    let [printed, wide] = summary.ordering_times_s;
    dict.set_item("ordering_time_s", printed)?;
    dict.set_item("ordering_time_wide_s", wide)?;
    dict.set_item("clip_rate", summary.clip_rate)?;
    Ok(dict)
}
