//! Noise, two conventions. `white`: increments c4·sqrt(dt)·N(0, 1), so that a free boat's spin is
//! c4·W(t), with variance c4²·t whatever dt. `per-step`: increments c4·dt·N(0, 1), variance c4²·t·dt.
//! White noise is one path per (seed, boat), read wherever time is cut.
//!
//! On paper: c1 = c2 = c3 = 0, then α̇(t) = c4·W(t) exactly. A boat under way damps its spin at
//! k = c3·v0: variance c4²/(2k) for good.

use crate::support::{
    NOISES, SCHEMES, assert_near, changed, driven, flock_of, inert, seeded_flock_of,
    time_of_velocities,
};
use flockenv::parameters::{Noise, Scheme};
use flockenv::random::BrownianPaths;
use flockenv::{Flock, FlockParameters};

/// Boats far apart, all at rest or all moving along.
fn spread_out(p: &FlockParameters, boats: usize, speed: f64, seed: u64) -> Flock {
    let places = (0..boats).map(|i| [60.0 * (i % 50) as f64, 60.0 * (i / 50) as f64, 0.0]);
    let states: Vec<_> = places.map(|pose| (pose, [speed, 0.0, 0.0])).collect();
    seeded_flock_of(p, &states, seed)
}

fn moments(values: &[f64]) -> (f64, f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let fourth = values.iter().map(|v| (v - mean).powi(4)).sum::<f64>() / n;
    (mean, variance, fourth / variance.powi(2))
}

fn spins(flock: &Flock) -> Vec<f64> {
    flock.velocities().iter().map(|v| v.angular).collect()
}

const BOATS: usize = 2000;
/// Five standard deviations of the sample variance of 2000 normal draws, sqrt(2/2000) each.
const FIVE_SIGMA: f64 = 5.0 * 0.031_6;

/// Moments of the spins that noise of c4 = 0.3 has given boats at rest after 2 s.
fn moments_after_2_s(scheme: Scheme, noise_scheme: Noise, dt_s: f64, seed: u64) -> (f64, f64, f64) {
    let p = FlockParameters {
        c4: 0.3,
        dt_s,
        noise_scheme,
        ..inert(scheme)
    };
    let mut flock = spread_out(&p, BOATS, 0.0, seed);
    flock.advance(2.0, None).expect("finite motion");
    moments(&spins(&flock))
}

#[test]
fn white_noise_has_the_variance_c4_squared_t_at_any_dt() {
    for scheme in SCHEMES {
        for dt_s in [0.1, 0.02, 0.005] {
            let (mean, variance, kurtosis) = moments_after_2_s(scheme, Noise::White, dt_s, 5);
            let expected = 0.09 * time_of_velocities(scheme, 2.0, dt_s);
            assert_near(variance / expected, 1.0, FIVE_SIGMA, (scheme, dt_s));
            assert!(mean.abs() < 5.0 * (expected / BOATS as f64).sqrt());
            // The sample kurtosis of a normal law is 3 ± sqrt(24/n).
            assert!((kurtosis - 3.0).abs() < 5.0 * (24.0 / BOATS as f64).sqrt());
        }
    }
}

#[test]
fn per_step_noise_has_a_variance_in_proportion_to_dt() {
    for scheme in SCHEMES {
        for dt_s in [0.1, 0.02, 0.005] {
            let substeps = 2.0 / dt_s;
            // Leapfrog's first kick lasts half a substep.
            let kicks = match scheme {
                Scheme::Leapfrog => substeps - 0.75,
                _ => substeps,
            };
            let expected = 0.09 * dt_s * dt_s * kicks;
            let (_, variance, _) = moments_after_2_s(scheme, Noise::PerStep, dt_s, 6);
            assert_near(variance / expected, 1.0, FIVE_SIGMA, (scheme, dt_s));
        }
    }
}

#[test]
fn boats_and_times_are_independent() {
    for noise in NOISES {
        let p = FlockParameters {
            c4: 1.0,
            noise_scheme: noise,
            ..inert(Scheme::Moreau)
        };
        let mut flock = spread_out(&p, BOATS, 0.0, 9);
        let mut last = spins(&flock);
        let mut steps: Vec<Vec<f64>> = Vec::new();
        for _ in 0..4 {
            flock.advance(0.02, None).expect("finite motion");
            let now = spins(&flock);
            steps.push(now.iter().zip(&last).map(|(a, b)| a - b).collect());
            last = now;
        }
        let correlation = |a: &[f64], b: &[f64]| {
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
        };
        let bound = 5.0 / (BOATS as f64).sqrt();
        for i in 0..4 {
            for j in 0..i {
                assert!(correlation(&steps[i], &steps[j]).abs() < bound);
            }
            for lag in [1, 2, 50] {
                assert!(correlation(&steps[i][lag..], &steps[i][..BOATS - lag]).abs() < bound);
            }
        }
    }
}

#[test]
fn no_noise_is_no_noise() {
    for scheme in SCHEMES {
        let p = changed(inert(scheme), |p| p.c4 = 0.0);
        let mut flock = spread_out(&p, 10, 1.0, 5);
        flock.advance(3.0, None).expect("finite motion");
        assert!(spins(&flock).iter().all(|&w| w == 0.0));
    }
}

#[test]
fn two_control_rates_meet_the_same_path() {
    // Control steps of 0.05 and 0.07 s cut substeps of 0.02 s; at common times whose last substep is a
    // whole one, spins agree to rounding.
    for scheme in SCHEMES {
        let p = FlockParameters {
            c4: 0.3,
            noise_scheme: Noise::White,
            ..inert(scheme)
        };
        let spins_at = |control: f64, end: f64| {
            let mut flock = spread_out(&p, 50, 0.0, 12);
            let steps = (end / control).round() as usize;
            for _ in 0..steps {
                flock.advance(control, None).expect("finite motion");
            }
            spins(&flock)
        };
        for (control, end) in [(0.05, 0.7), (0.07, 0.7), (0.02, 0.7), (0.007, 1.4)] {
            // 0.7 s is a multiple of both; the substep before it starts at 0.68 or at a cut of its own.
            let (cut, whole) = (spins_at(control, end), spins_at(0.1, end));
            let same_last = scheme != Scheme::Leapfrog || control != 0.007;
            for (a, b) in cut.iter().zip(&whole) {
                let error = (a - b).abs();
                if same_last {
                    assert!(error < 1e-14, "{scheme:?} {control}: {error:e}");
                } else {
                    // The last substep is 0.007 s, so the middles differ by 0.0065 s of noise.
                    assert!(error < 6.0 * 0.3 * 0.0065_f64.sqrt());
                }
            }
        }
    }
}

#[test]
fn two_policies_meet_the_same_path() {
    // What a leader does changes nothing in the noise of a boat it does not touch.
    for scheme in SCHEMES {
        for noise in NOISES {
            let p = FlockParameters {
                n_leaders: 1,
                c4: 0.5,
                noise_scheme: noise,
                ..driven(scheme)
            };
            let states = [([0.0; 3], [0.0; 3]), ([0.0, 500.0, 0.0], [0.0; 3])];
            let run = |rudder: f64| {
                let mut flock = flock_of(&p, &states);
                flock.advance(3.0, Some(&[rudder])).expect("finite motion");
                flock.poses().to_vec()
            };
            let (left, right) = (run(1.0), run(-1.0));
            assert_ne!(left[0], right[0]);
            assert_eq!(left[1], right[1], "{scheme:?} {noise:?}");
        }
    }
}

/// W(to) − W(from) for 300 boats, times in half ticks.
fn increments(paths: &mut BrownianPaths, from: u64, to: u64) -> Vec<f64> {
    let mut found = vec![f64::NAN; 300];
    paths.increments(from, to, &mut found);
    found
}

/// Share of four million increments below x, against erf(x/√2): binomial errors, five standard deviations.
#[test]
fn increments_have_the_normal_distribution_from_its_middle_to_its_tail() {
    // Over cells of 1 s.
    let (cell, boats, cells) = (2_000_000_000, 4000, 1000);
    let mut paths = BrownianPaths::new(6, boats, cell, 0);
    let (mut found, mut numbers) = (vec![0.0; boats], Vec::new());
    for k in 0..cells {
        paths.increments(k * cell, (k + 1) * cell, &mut found);
        numbers.extend_from_slice(&found);
    }
    let draws = numbers.len() as f64;
    for x in [
        -4.5, -4.0, -3.65, -3.0, -1.0, -0.1, 0.0, 0.2, 0.7, 2.0, 3.5, 4.0, 4.5,
    ] {
        let below = numbers.iter().filter(|&&number| number < x).count() as f64;
        let expected = 0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2);
        let error = (expected * (1.0 - expected) / draws).sqrt();
        let share = below / draws;
        assert!((share - expected).abs() < 5.0 * error, "{x}: {share}");
    }
}

#[test]
fn increments_over_parts_add_up_to_the_whole() {
    // Cells of 0.02 s, half a cell shifted as for leapfrog; cuts in a cell, across cells, odd ones.
    let cell = 40_000_000;
    for (shift, cell) in [(0, cell), (cell / 2, cell), (0, 1_999_999_999), (7, 2000)] {
        let mut paths = BrownianPaths::new(3, 300, cell, shift);
        let ends = [
            0,
            1,
            cell / 3,
            cell / 2,
            cell - 1,
            cell,
            cell + 1,
            5 * cell + 17,
            9 * cell,
        ];
        for (i, &from) in ends.iter().enumerate() {
            for (j, &to) in ends.iter().enumerate().skip(i + 1) {
                let whole = increments(&mut paths, from, to);
                for &middle in &ends[i + 1..j] {
                    let first = increments(&mut paths, from, middle);
                    let second = increments(&mut paths, middle, to);
                    let scale = ((cell as f64) * 0.5e-9).sqrt();
                    for ((w, a), b) in whole.iter().zip(&first).zip(&second) {
                        assert!((w - a - b).abs() < 1e-13 * scale.max(1e-3));
                    }
                }
            }
        }
    }
}

#[test]
fn increments_over_parts_of_a_cell_have_their_own_variance() {
    // 300 boats in 60 cells: 18 000 draws, of variance ± sqrt(2/18000) = 1.05 %.
    let cell: u64 = 40_000_000;
    let mut paths = BrownianPaths::new(8, 300, cell, 0);
    for (from, to) in [
        (0, cell),
        (0, cell / 2),
        (cell / 3, cell / 3 + 1_000_000),
        (cell / 4, 3 * cell / 4),
        (cell - 12_345, cell),
        (cell - 1_000_000, cell + 3_000_000),
    ] {
        let draws: Vec<f64> = (0..60)
            .flat_map(|k| increments(&mut paths, 2 * k * cell + from, 2 * k * cell + to))
            .collect();
        let expected = (to - from) as f64 * 0.5e-9;
        let (_, variance, kurtosis) = moments(&draws);
        assert_near(variance / expected, 1.0, 5.0 * 0.010_5, (from, to));
        assert!((kurtosis - 3.0).abs() < 5.0 * (24.0_f64 / 18_000.0).sqrt());
    }
}

#[test]
fn bridges_of_different_leaves_are_independent() {
    // A leaf is 1/1024 of a cell: the middle of one is off the mean of its ends by N(0, length/4).
    let (leaf, boats) = (2000, 300);
    let mut paths = BrownianPaths::new(5, boats, 1024 * leaf, 0);
    let mut bridge = |leaf_number: u64| {
        let start = leaf * leaf_number;
        let first = increments(&mut paths, start, start + leaf / 2);
        let second = increments(&mut paths, start + leaf / 2, start + leaf);
        let ends = first.iter().zip(&second);
        ends.map(|(a, b)| 0.5 * (a - b)).collect::<Vec<_>>()
    };
    let (one, other) = (bridge(3), bridge(700));
    let variance = leaf as f64 * 0.5e-9 / 4.0;
    let products = one.iter().zip(&other).map(|(a, b)| a * b / variance);
    let correlation = products.sum::<f64>() / boats as f64;
    assert_near(correlation, 0.0, 5.0 / (boats as f64).sqrt(), "two leaves");
}

#[test]
fn an_increment_does_not_depend_on_the_number_of_boats() {
    let mut few = BrownianPaths::new(4, 3, 40_000_000, 0);
    let mut many = BrownianPaths::new(4, 300, 40_000_000, 0);
    let mut found = [0.0; 3];
    few.increments(5_000_000, 90_000_000, &mut found);
    assert_eq!(found[..], increments(&mut many, 5_000_000, 90_000_000)[..3]);
}

#[test]
fn leapfrog_has_the_exact_stationary_spin_and_moreau_to_first_order() {
    // Under way at v0 the spin is an Ornstein–Uhlenbeck process of rate k = c3·v0 = 15/s. Crank–Nicolson
    // keeps its variance c4²/(2k) at any dt; Euler has c4²/(2k·(1 − k·dt/2)).
    for (scheme, dt_s, factor) in [
        (Scheme::Leapfrog, 0.08, 1.0),
        (Scheme::Leapfrog, 0.04, 1.0),
        (Scheme::Moreau, 0.08, 2.5),
        (Scheme::Moreau, 0.04, 1.0 / 0.7),
        (Scheme::Moreau, 0.01, 1.0 / 0.925),
    ] {
        let p = FlockParameters {
            c1: 0.0,
            c4: 0.01,
            dt_s,
            noise_scheme: Noise::White,
            ..driven(scheme)
        };
        let mut flock = spread_out(&p, 1000, 15.0, 21);
        let mut draws = Vec::new();
        // 0.8 s between samples: exp(−12) of correlation.
        for _ in 0..20 {
            flock.advance(0.8, None).expect("finite motion");
            draws.extend(spins(&flock));
        }
        let expected = 0.01_f64.powi(2) / 30.0 * factor;
        let (_, variance, _) = moments(&draws);
        // 20 000 draws: 1 % a standard deviation.
        assert_near(variance / expected, 1.0, 0.05, (scheme, dt_s));
    }
}
