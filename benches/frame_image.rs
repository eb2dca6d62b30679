//! Frames per second of 600 × 600 pixels with 50 boats, one thread.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use flockenv::parameters::{FlockParameters, Pool, Preset};
use flockenv::{Flock, FrameRenderer};

fn main() {
    divan::main();
}

fn frames(bencher: Bencher, pool: Pool) {
    let parameters = FlockParameters {
        n_boats: 50,
        n_leaders: 5,
        pool,
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut flock = Flock::new(parameters, 7).unwrap();
    flock.advance(30.0, None).unwrap();
    let mut renderer = FrameRenderer::new(600, 600).unwrap();
    bencher
        .counter(ItemsCount::new(1_u32))
        .bench_local(|| renderer.draw(black_box(&flock)));
}

#[divan::bench]
fn wide(bencher: Bencher) {
    frames(bencher, Pool::WIDE);
}

#[divan::bench]
fn open_water(bencher: Bencher) {
    frames(
        bencher,
        Pool {
            outer_radius_cm: f64::INFINITY,
            inner_radius_cm: 0.0,
        },
    );
}
