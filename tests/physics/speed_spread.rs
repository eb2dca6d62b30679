//! Speed spread (Table 1: 15 ± 5 cm/s): each boat's motor has a factor of its own, drawn once from the
//! seed, uniform in 1 ± spread/v0, forwards and backwards alike.
//!
//! On paper: a boat under way for long has the speed v0·factor; the factors' distribution function is
//! a straight line; its mean is 1 and its variance (spread/v0)²/3.

use crate::support::{SCHEMES, assert_near, changed, driven, seeded_flock_of};
use flockenv::FlockParameters;
use flockenv::parameters::Scheme;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SPREAD: f64 = 5.0;

/// Speeds along the heading after 40 s, when exp(−c0·t) is below rounding; every boat on its own row.
fn final_speeds(p: &FlockParameters, boats: usize, seed: u64) -> Vec<f64> {
    let rows = (0..boats).map(|row| ([0.0, 40.0 * row as f64, 0.0], [0.0; 3]));
    let mut flock = seeded_flock_of(p, &rows.collect::<Vec<_>>(), seed);
    flock.advance(40.0, None).expect("finite motion");
    flock.velocities().iter().map(|v| v.linear.x).collect()
}

fn spread(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        speed_spread_cm_s: SPREAD,
        dt_s: 0.1,
        ..driven(scheme)
    }
}

#[test]
fn speeds_are_uniform_between_10_and_20() {
    let speeds = final_speeds(&spread(Scheme::Leapfrog), 4000, 3);
    let mut sorted = speeds.clone();
    sorted.sort_by(f64::total_cmp);
    assert!(sorted[0] >= 10.0 - 1e-9 && sorted[3999] <= 20.0 + 1e-9);
    // Kolmogorov–Smirnov: 1.95/sqrt(n) is exceeded once in a thousand.
    for (place, speed) in sorted.iter().enumerate() {
        let expected = (speed - 10.0) / 10.0;
        assert!((place as f64 / 4000.0 - expected).abs() < 1.95 / 4000_f64.sqrt());
    }
    // Neighbors are independent: correlation below five standard deviations.
    let part = |v: f64| (v - 15.0) / SPREAD;
    let pairs = speeds.windows(2).map(|pair| part(pair[0]) * part(pair[1]));
    assert!((pairs.sum::<f64>() / 3999.0 * 3.0).abs() < 5.0 / 4000_f64.sqrt());
}

#[test]
fn speeds_belong_to_the_seed_in_every_scheme() {
    let reference = final_speeds(&spread(Scheme::Leapfrog), 50, 3);
    for scheme in SCHEMES {
        let p = spread(scheme);
        let speeds = final_speeds(&p, 50, 3);
        for (a, b) in speeds.iter().zip(&reference) {
            assert!((a - b).abs() < 1e-9, "{scheme:?}: {a} {b}");
        }
        assert_eq!(speeds[..20], final_speeds(&p, 20, 3));
        let other = final_speeds(&p, 50, 4);
        let same = other.iter().zip(&speeds).filter(|(a, b)| a == b).count();
        assert_eq!(same, 0, "{scheme:?}");
    }
}

#[test]
fn a_boat_that_is_fast_forwards_is_fast_backwards() {
    for scheme in SCHEMES {
        let p = changed(spread(scheme), |p| p.reverse_speed_cm_s = 6.0);
        let forwards = final_speeds(&p, 30, 8);
        let backing = FlockParameters {
            fw_s: 0.0,
            bw_s: 1.0,
            ..p
        };
        for (there, back) in forwards.iter().zip(final_speeds(&backing, 30, 8)) {
            assert_near(back, -0.4 * there, 1e-9, scheme);
        }
    }
}

#[test]
fn the_width_is_the_parameter() {
    let factors = |spread_cm_s: f64| -> Vec<f64> {
        let p = changed(spread(Scheme::Leapfrog), |p| {
            p.speed_spread_cm_s = spread_cm_s;
        });
        let speeds = final_speeds(&p, 20, 5);
        speeds.iter().map(|v| (v - 15.0) / spread_cm_s).collect()
    };
    for (wide, narrow) in factors(15.0).iter().zip(factors(0.5)) {
        assert!((wide - narrow).abs() < 1e-9);
    }
}

#[test]
fn factors_are_drawn_from_a_stream_of_their_own() {
    let mut key = [0; 32];
    key[0] = 3;
    key[8..20].copy_from_slice(b"speed-spread");
    let mut words = ChaCha8Rng::from_seed(key);
    for speed in final_speeds(&spread(Scheme::Leapfrog), 20, 3) {
        let expected = 15.0 + SPREAD * words.random_range(-1.0..=1.0);
        assert!((speed - expected).abs() < 1e-9, "{speed} {expected}");
    }
}
