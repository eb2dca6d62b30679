//! Time of one flock control step (10 Hz, five substeps) with observations and reward, one thread.

mod support;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use flockenv::environment::{EnvBatch, EnvSettings};
use flockenv::parameters::{FlockParameters, Pool};
use support::{control, environment, training, warm_batch};

fn main() {
    divan::main();
}

fn batch_of_16(parameters: &FlockParameters) -> EnvBatch {
    warm_batch(EnvSettings::default(), parameters, 0..16).expect("the settings are accepted")
}

fn control_steps(bencher: Bencher, parameters: &FlockParameters) {
    let mut batch = batch_of_16(parameters);
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    bencher
        .counter(ItemsCount::new(16_u32 * 100))
        .bench_local(|| one_thread.install(|| control(&mut batch, 100)));
}

#[divan::bench]
fn wide(bencher: Bencher) {
    control_steps(bencher, &environment(Pool::WIDE, 0.3));
}

#[divan::bench]
fn narrow(bencher: Bencher) {
    control_steps(bencher, &environment(Pool::NARROW, 0.4));
}

/// Stepped as for training, where phases switch off the grid of substeps.
#[divan::bench]
fn training_wide(bencher: Bencher) {
    control_steps(bencher, &training(Pool::WIDE, 0.31));
}

#[divan::bench]
fn training_narrow(bencher: Bencher) {
    control_steps(bencher, &training(Pool::NARROW, 0.45));
}

/// Observations alone, without physics.
#[divan::bench]
fn observe(bencher: Bencher) {
    let mut batch = batch_of_16(&environment(Pool::WIDE, 0.3));
    let mut observations = vec![0.0; batch.rows() * batch.observation_size()];
    bencher.counter(ItemsCount::new(16_u32)).bench_local(|| {
        batch.observe(&mut observations);
        black_box(observations[0])
    });
}
