//! Time of one flock control step (10 Hz, five substeps) with observations and reward, one thread.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use flockenv::environment::{BatchRows, EnvBatch, EnvSettings, ResetRequest};
use flockenv::parameters::{FlockParameters, Pool, Preset};

fn main() {
    divan::main();
}

/// 27 boats, 4 leaders; warmed up for 20 s so that the flock is where it usually is.
fn warm_batch(flocks: usize, pool: Pool, bw_s: f64) -> EnvBatch {
    let parameters = FlockParameters {
        n_boats: 27,
        n_leaders: 4,
        pool,
        bw_s,
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut batch = EnvBatch::new(EnvSettings::default(), vec![parameters; flocks]).unwrap();
    let requests: Vec<_> = (0..flocks as u64)
        .map(|seed| {
            Some(ResetRequest {
                seed: Some(seed),
                ..ResetRequest::default()
            })
        })
        .collect();
    batch.reset(&requests).unwrap();
    let actions = vec![0.5; batch.rows()];
    for _ in 0..200 {
        step(&mut batch, &actions);
    }
    batch
}

fn step(batch: &mut EnvBatch, actions: &[f64]) -> Vec<f32> {
    let mut observations = vec![0.0; batch.rows() * batch.observation_size()];
    let mut rewards = vec![0.0; batch.rows()];
    let mut truncated = vec![false; batch.envs().len()];
    let rows = BatchRows {
        observations: &mut observations,
        rewards: &mut rewards,
        truncated: &mut truncated,
    };
    batch.step(actions, rows).unwrap();
    observations
}

fn control_steps(bencher: Bencher, pool: Pool, bw_s: f64) {
    let mut batch = warm_batch(16, pool, bw_s);
    let actions = vec![0.5; batch.rows()];
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    bencher
        .counter(ItemsCount::new(16_u32 * 100))
        .bench_local(|| {
            one_thread.install(|| {
                for _ in 0..100 {
                    black_box(step(&mut batch, &actions));
                }
            });
        });
}

#[divan::bench]
fn five_hundred_boats(bencher: Bencher) {
    control_steps(bencher, Pool::FIVE_HUNDRED_BOATS, 0.3);
}

#[divan::bench]
fn table_1(bencher: Bencher) {
    control_steps(bencher, Pool::TABLE_1, 0.4);
}

/// Observations alone, without physics.
#[divan::bench]
fn observe(bencher: Bencher) {
    let mut batch = warm_batch(16, Pool::FIVE_HUNDRED_BOATS, 0.3);
    let mut observations = vec![0.0; batch.rows() * batch.observation_size()];
    bencher.counter(ItemsCount::new(16_u32)).bench_local(|| {
        batch.observe(&mut observations);
        black_box(observations[0])
    });
}
