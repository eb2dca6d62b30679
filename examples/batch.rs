//! A batch of environments, stepped in parallel with one action for each leader.
//!
//! `cargo run --release --example batch`

#![allow(clippy::print_stdout, reason = "an example prints what it found")]

use flockenv::Result;
use flockenv::environment::{BatchRows, EnvBatch, EnvSettings, ResetRequest};
use flockenv::parameters::{FlockParameters, Preset};

const FLOCKS: usize = 64;
const STEPS: usize = 600;

fn main() -> Result<()> {
    let parameters = FlockParameters {
        n_boats: 27,
        n_leaders: 4,
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut batch = EnvBatch::new(EnvSettings::default(), vec![parameters; FLOCKS])?;
    let requests: Vec<_> = (0..FLOCKS as u64)
        .map(|seed| {
            Some(ResetRequest {
                seed: Some(seed),
                ..ResetRequest::default()
            })
        })
        .collect();
    batch.reset(&requests)?;

    let (rows, size) = (batch.rows(), batch.observation_size());
    let mut observations = vec![0.0_f32; rows * size];
    let (mut rewards, mut truncated) = (vec![0.0; rows], vec![false; FLOCKS]);
    batch.observe(&mut observations);
    let mut total = 0.0;
    for _ in 0..STEPS {
        let actions = policy(&observations, size);
        batch.step(
            Some(&actions),
            BatchRows {
                observations: &mut observations,
                rewards: &mut rewards,
                truncated: &mut truncated,
            },
        )?;
        total += rewards.iter().sum::<f64>();
    }
    let steps = (rows * STEPS) as f64;
    println!("{FLOCKS} flocks, {rows} leaders, {size} numbers per observation");
    println!("mean reward per control step: {:.3}", total / steps);
    Ok(())
}

/// A rudder in [-1, 1] from each leader's observation; this one steers straight ahead.
fn policy(observations: &[f32], size: usize) -> Vec<f64> {
    observations.chunks_exact(size).map(|_| 0.0).collect()
}
