//! Time of one flock control step (10 Hz, five substeps) with observations and reward, one thread.

mod support;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use flockenv::environment::EnvBatch;
use flockenv::parameters::Pool;
use support::{control, environment, warm_batch};

fn main() {
    divan::main();
}

fn batch_of_16(pool: Pool, bw_s: f64) -> EnvBatch {
    warm_batch(&environment(pool, bw_s), 0..16).expect("the settings are accepted")
}

fn control_steps(bencher: Bencher, pool: Pool, bw_s: f64) {
    let mut batch = batch_of_16(pool, bw_s);
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    bencher
        .counter(ItemsCount::new(16_u32 * 100))
        .bench_local(|| one_thread.install(|| control(&mut batch, 100)));
}

#[divan::bench]
fn five_hundred_boats(bencher: Bencher) {
    control_steps(bencher, Pool::WIDE, 0.3);
}

#[divan::bench]
fn narrow(bencher: Bencher) {
    control_steps(bencher, Pool::NARROW, 0.4);
}

/// Observations alone, without physics.
#[divan::bench]
fn observe(bencher: Bencher) {
    let mut batch = batch_of_16(Pool::WIDE, 0.3);
    let mut observations = vec![0.0; batch.rows() * batch.observation_size()];
    bencher.counter(ItemsCount::new(16_u32)).bench_local(|| {
        batch.observe(&mut observations);
        black_box(observations[0])
    });
}
