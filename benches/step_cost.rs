//! Quick looks while developing: `cargo bench`. What is published comes from `make speed-vs-error`.

use divan::{Bencher, black_box};
use flockenv::parameters::{Pool, Preset, Scheme};
use flockenv::{Flock, FlockParameters};

/// Boats in pool `table-1`, scaled by sqrt(n/50) beyond 50; engines always forward if it is a jam.
fn scene(boats: usize, is_jam: bool) -> FlockParameters {
    let scale = (boats as f64 / 50.0).sqrt().max(1.0);
    let rest = if is_jam { 0.0 } else { 1.0 };
    FlockParameters {
        n_boats: boats,
        pool: Pool {
            outer_radius_cm: Pool::TABLE_1.outer_radius_cm * scale,
            inner_radius_cm: Pool::TABLE_1.inner_radius_cm * scale,
        },
        nop1_s: rest,
        bw_s: 2.0 * rest,
        nop2_s: rest,
        dt_s: 0.01,
        ..FlockParameters::preset(Preset::Simulation)
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
            .advance(black_box(6.0), None)
            .expect("the motion stays finite");
    });
}

#[divan::bench(args = [27, 50, 200, 1000], sample_count = 20, sample_size = 1)]
fn jam(bencher: Bencher, boats: usize) {
    advance_a_cycle(bencher, scene(boats, true));
}

#[divan::bench(args = [27, 50, 200, 1000], sample_count = 20, sample_size = 1)]
fn cycle(bencher: Bencher, boats: usize) {
    advance_a_cycle(bencher, scene(boats, false));
}

#[divan::bench(args = [0, 1, 2], sample_count = 50, sample_size = 1)]
fn jam_of_27_relinearized(bencher: Bencher, relinearizations: usize) {
    advance_a_cycle(
        bencher,
        FlockParameters {
            relinearizations,
            ..scene(27, true)
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
            ..scene(27, true)
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
