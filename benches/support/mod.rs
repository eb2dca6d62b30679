//! What the benches of the product share: scenes, and batches of environments that are stepped.
#![allow(dead_code, reason = "each bench uses a part")]

#[path = "../src/scene.rs"]
pub mod scene;

use flockenv::Result;
use flockenv::environment::{BatchRows, EnvBatch, EnvSettings, ResetRequest};
use flockenv::parameters::{FlockParameters, Physics, Pool, Preset};
use std::hint::black_box;
use std::ops::Range;

/// 27 boats, 4 leaders.
pub fn environment(pool: Pool, bw_s: f64) -> FlockParameters {
    FlockParameters {
        n_boats: 27,
        n_leaders: 4,
        pool,
        bw_s,
        ..FlockParameters::preset(Preset::Simulation)
    }
}

/// The same, stepped as for training.
pub fn training(pool: Pool, bw_s: f64) -> FlockParameters {
    let mut parameters = environment(pool, bw_s);
    if let Some((dt_s, relinearizations)) = Physics::Training.stepping() {
        (parameters.dt_s, parameters.relinearizations) = (dt_s, relinearizations);
    }
    parameters
}

/// A batch with an episode per seed, after 20 s, so that the flocks are where they usually are.
pub fn warm_batch(parameters: &FlockParameters, seeds: Range<u64>) -> Result<EnvBatch> {
    let requests: Vec<_> = seeds
        .map(|seed| {
            Some(ResetRequest {
                seed: Some(seed),
                ..ResetRequest::default()
            })
        })
        .collect();
    let members = vec![parameters.clone(); requests.len()];
    let mut batch = EnvBatch::new(EnvSettings::default(), members)?;
    batch.reset(&requests)?;
    control(&mut batch, 200)?;
    Ok(batch)
}

/// Control steps with the rudders held.
pub fn control(batch: &mut EnvBatch, steps: u64) -> Result<()> {
    let actions = vec![0.5; batch.rows()];
    let mut observations = vec![0.0; batch.rows() * batch.observation_size()];
    let mut rewards = vec![0.0; batch.rows()];
    let mut truncated = vec![false; batch.envs().len()];
    for _ in 0..steps {
        let rows = BatchRows {
            observations: &mut observations,
            rewards: &mut rewards,
            truncated: &mut truncated,
        };
        batch.step(&actions, rows)?;
    }
    black_box(&observations);
    Ok(())
}
