//! Section 4.5's optional effects together: off, they do not exist; on, a run is still a function of
//! its parameters and seed, mirrored scenes included.
//!
//! On paper: zero bits of difference.

use crate::support::{NOISES, OPEN_WATER, SCHEMES, bits, busy, changed};
use flockenv::parameters::{Noise, Scheme};
use flockenv::{Flock, FlockParameters};

fn all_on(scheme: Scheme, noise: Noise) -> FlockParameters {
    FlockParameters {
        turning_bias: 0.3,
        speed_spread_cm_s: 4.0,
        current_gain: 0.4,
        current_cap_cm_s: 3.0,
        current_relaxation_s: 2.5,
        leader_speed_factor: 1.2,
        ..busy(scheme, noise)
    }
}

fn kinds() -> impl Iterator<Item = (Scheme, Noise)> {
    let with_noises = |scheme| NOISES.into_iter().map(move |noise| (scheme, noise));
    SCHEMES.into_iter().flat_map(with_noises)
}

fn run(p: &FlockParameters, seed: u64, durations: &[f64]) -> Vec<u64> {
    let mut flock = Flock::new(p.clone(), seed).expect("room");
    for &duration in durations {
        flock.advance(duration, None).expect("finite motion");
    }
    bits(&flock)
}

#[test]
fn a_cap_and_inertia_without_a_current_change_no_bit() {
    for (scheme, noise) in kinds() {
        let plain = busy(scheme, noise);
        let still = changed(plain.clone(), |p| {
            (p.current_cap_cm_s, p.current_relaxation_s) = (0.5, 2.5);
        });
        assert_eq!(run(&plain, 6, &[4.0]), run(&still, 6, &[4.0]));
    }
}

#[test]
fn each_effect_fades_with_its_parameter() {
    // Nothing jumps at 0: effects of 1e-12 move a lone boat by less than 1e-9 cm, but do move it.
    let turn_on: [fn(&mut FlockParameters); 3] = [
        |p| p.turning_bias = 1e-12,
        |p| p.speed_spread_cm_s = 1e-12,
        |p| p.current_gain = 1e-12,
    ];
    for (scheme, noise) in kinds() {
        let alone = FlockParameters {
            n_boats: 1,
            n_leaders: 0,
            pool: OPEN_WATER,
            ..busy(scheme, noise)
        };
        let end = |p: &FlockParameters| {
            let mut flock = Flock::new(p.clone(), 2).expect("room");
            flock.advance(6.0, None).expect("finite motion");
            flock.poses()[0]
        };
        let plain = end(&alone);
        for change in turn_on {
            let mut p = alone.clone();
            change(&mut p);
            let moved = end(&p);
            assert_ne!(moved, plain);
            assert!((moved.position - plain.position).norm() < 1e-9);
            assert!((moved.heading - plain.heading).abs() < 1e-9);
        }
    }
}

#[test]
fn with_all_effects_on_a_run_is_a_function_of_its_seed() {
    for (scheme, noise) in kinds() {
        let p = all_on(scheme, noise);
        let whole = run(&p, 7, &[4.0]);
        assert_eq!(whole, run(&p, 7, &[4.0]));
        assert_eq!(whole, run(&p, 7, &[1.0, 0.5, 2.5]));
        assert_ne!(whole, run(&p, 8, &[4.0]));
        assert_ne!(whole, run(&busy(scheme, noise), 7, &[4.0]));
    }
}

#[test]
fn with_all_effects_on_snapshots_continue_bit_for_bit() {
    for (scheme, noise) in kinds() {
        let p = all_on(scheme, noise);
        let mut flock = Flock::new(p.clone(), 11).expect("room");
        flock.advance(1.234_567, None).expect("finite motion");
        let mut copy = Flock::from_snapshot(&flock.snapshot(), None).expect("a snapshot");
        flock.advance(3.0, None).expect("finite motion");
        copy.advance(3.0, None).expect("finite motion");
        assert_eq!(bits(&flock), bits(&copy), "{scheme:?} {noise:?}");
        assert!(flock.snapshot() == copy.snapshot());
    }
}
