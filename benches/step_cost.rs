//! Times of steps for developers: `cargo bench`. Published numbers come from `make speed-vs-error`.

mod support;

use divan::{Bencher, black_box};
use flockenv::parameters::{Preset, Scheme};
use flockenv::{Flock, FlockParameters};
use support::scene::Scene;

fn scene(scene: Scene, boats: usize) -> FlockParameters {
    FlockParameters {
        dt_s: 0.01,
        ..scene.parameters(boats)
    }
}

fn warmed_up(parameters: FlockParameters) -> Flock {
    let mut flock = Flock::new(parameters, 1).expect("the boats fit");
    flock.advance(20.0, None).expect("the motion stays finite");
    flock
}

/// Six seconds, a cycle of phases: 600 steps.
fn advance_a_cycle(bencher: Bencher, parameters: FlockParameters) {
    let mut flock = warmed_up(parameters);
    bencher.counter(600_u32).bench_local(|| {
        flock
            .advance(black_box(Scene::BLOCK_S), None)
            .expect("the motion stays finite");
    });
}

#[divan::bench(args = [27, 50, 200, 1000], sample_count = 20, sample_size = 1)]
fn jam(bencher: Bencher, boats: usize) {
    advance_a_cycle(bencher, scene(Scene::Jam, boats));
}

#[divan::bench(args = [27, 50, 200, 1000], sample_count = 20, sample_size = 1)]
fn cycle(bencher: Bencher, boats: usize) {
    advance_a_cycle(bencher, scene(Scene::Cycle, boats));
}

#[divan::bench(args = [f64::INFINITY, 1e-4, 1e-6, 1e-9], sample_count = 50, sample_size = 1)]
fn jam_of_27_by_tolerance(bencher: Bencher, tolerance_cm: f64) {
    advance_a_cycle(
        bencher,
        FlockParameters {
            tolerance_cm,
            ..scene(Scene::Jam, 27)
        },
    );
}

#[divan::bench(args = Scheme::ALL.iter().map(|scheme| scheme.name()), sample_count = 50, sample_size = 1)]
fn jam_of_27_by_scheme(bencher: Bencher, scheme: &str) {
    let scheme: Scheme = scheme.parse().expect("a name of a scheme");
    advance_a_cycle(
        bencher,
        FlockParameters {
            scheme,
            ..scene(Scene::Jam, 27)
        },
    );
}

/// A control step of an environment: 0.1 s at the default step, two leaders' rudders held.
#[divan::bench]
fn control_step(bencher: Bencher) {
    let parameters = FlockParameters {
        n_leaders: 2,
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut flock = warmed_up(parameters);
    bencher.bench_local(|| {
        flock
            .advance(0.1, Some(black_box(&[0.5, -0.5])))
            .expect("the motion stays finite");
    });
}

fn main() {
    divan::main();
}
