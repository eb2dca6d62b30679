//! Shared by the product's benches: scenes, and batches of environments that are stepped.
#![allow(dead_code, reason = "each bench uses a part")]

#[path = "../src/scene.rs"]
pub mod scene;

use flockenv::Result;
use flockenv::environment::observation::{Block, ObservationLayout};
use flockenv::environment::{
    ActionMode, BatchRows, EnvBatch, EnvSettings, ResetRequest, RewardTerm, RewardWeights,
    TargetChoice, Weights,
};
use flockenv::parameters::{FlockParameters, Physics, Pool, Preset};
use std::hint::black_box;
use std::ops::Range;

/// Parameters of 27 boats, 4 of them leaders.
pub fn environment(pool: Pool, bw_s: f64) -> FlockParameters {
    FlockParameters {
        n_boats: 27,
        n_leaders: 4,
        pool,
        bw_s,
        ..FlockParameters::preset(Preset::Simulation)
    }
}

/// The same with the physics of trainings.
pub fn training(pool: Pool, bw_s: f64) -> FlockParameters {
    let mut parameters = environment(pool, bw_s);
    if let Some((dt_s, tolerance_cm)) = Physics::Training.stepping() {
        (parameters.dt_s, parameters.tolerance_cm) = (dt_s, tolerance_cm);
    }
    parameters
}

/// The environment of `flockenv train`.
pub fn leaning() -> EnvSettings {
    let mut reward = RewardWeights::default();
    reward.0[RewardTerm::ContactAlignment as usize] = 30.0;
    EnvSettings {
        target: TargetChoice::Random,
        mirror_to_target: true,
        observation: ObservationLayout::from_blocks(&[Block::LeanFeatures]),
        action_mode: ActionMode::Lean,
        decision_period_s: Some(1.0),
        reward: Weights::One(reward),
        reward_horizon_s: Some(40.0),
        ..EnvSettings::default()
    }
}

/// A batch with an episode for each seed, 20 s after its start.
pub fn warm_batch(
    settings: EnvSettings,
    parameters: &FlockParameters,
    seeds: Range<u64>,
) -> Result<EnvBatch> {
    let requests: Vec<_> = seeds
        .map(|seed| {
            Some(ResetRequest {
                seed: Some(seed),
                ..ResetRequest::default()
            })
        })
        .collect();
    let members = vec![parameters.clone(); requests.len()];
    let decisions = 200 / u64::from(settings.period_steps());
    let mut batch = EnvBatch::new(settings, members)?;
    batch.reset(&requests)?;
    control(&mut batch, decisions)?;
    Ok(batch)
}

/// Steps a batch by a number of decisions with constant actions.
pub fn control(batch: &mut EnvBatch, decisions: u64) -> Result<()> {
    let actions = vec![0.5; batch.rows()];
    let mut observations = vec![0.0; batch.rows() * batch.observation_size()];
    let mut rewards = vec![0.0; batch.rows()];
    let mut truncated = vec![false; batch.envs().len()];
    for _ in 0..decisions {
        let rows = BatchRows {
            observations: &mut observations,
            rewards: &mut rewards,
            truncated: &mut truncated,
        };
        batch.step(Some(&actions), rows)?;
    }
    black_box(&observations);
    Ok(())
}
