//! The error that an advance states is the error that it makes: the distance from where far shorter substeps lead, on
//! the same path of the noise.
//!
//! On paper: a boat at rest that a motor drives has x(t) = v0·(t − (1 − e^(−c0·t))/c0). A scheme of second order errs by
//! e in a step and by e/64 in its eighth, and states 63/64 of its error.

use crate::support::{
    RHO, SCHEMES, assert_near, bits, busy, changed, driven, flock_of, inert, refused_field,
    seeded_flock_of,
};
use flockenv::flock::State;
use flockenv::geometry::{Pose, Vec2, Velocity, rms_distance, turned_left};
use flockenv::parameters::{Noise, Pool, Scheme};
use flockenv::{Flock, FlockParameters};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// What a reference takes for substeps, in s.
const EXACT_S: f64 = 1e-4;

#[test]
fn a_boat_that_gets_under_way_states_its_error() {
    for dt_s in [0.1, 0.02] {
        let p = changed(driven(Scheme::Leapfrog), |p| p.dt_s = dt_s);
        let mut boat = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        let stated = boat.advance_with_error(1.0, None).unwrap();
        let right = p.speed_cm_s * f64::exp(-1.0);
        let error = (boat.poses()[0].position.x - right).abs();
        assert_near(stated / error, 63.0 / 64.0, 2e-3, dt_s);
        assert_eq!(boat.statistics().worst_error_cm, stated);
    }
}

/// A start, and how long it is followed.
struct Start {
    parameters: FlockParameters,
    state: State,
    seconds: f64,
}

/// One boat in `narrow` whose motor runs forward, without noise.
fn alone(pose: Pose, velocity: Velocity) -> Start {
    Start {
        parameters: changed(driven(Scheme::Leapfrog), |p| p.pool = Pool::NARROW),
        state: State {
            poses: vec![pose],
            velocities: vec![velocity],
            time_s: 0.0,
            allow_overlap: false,
        },
        seconds: 2.0,
    }
}

/// Its bow this far from the outer wall, heading outward of the tangent.
fn bow_at(away_cm: f64, outward: f64) -> Pose {
    let heading = FRAC_PI_2 - outward;
    let bow = Vec2::new(85.0 - away_cm, 0.0);
    let position = bow - Vec2::new(heading.cos(), heading.sin()) * 2.5;
    Pose { position, heading }
}

/// A boat circles the pool with its bow on the wall, as if fixed to a wheel.
fn slide(k: u64) -> Start {
    let pose = bow_at(0.0, 0.45 + 0.0175 * k as f64);
    let linear = turned_left(pose.position) * 0.12;
    alone(
        pose,
        Velocity {
            linear,
            angular: 0.12,
        },
    )
}

/// A boat hits the wall at its full speed, and slides on.
fn impact(k: u64) -> Start {
    let pose = bow_at(4.0 + 0.2 * k as f64, 0.45 + 0.1 * (k % 8) as f64);
    let (sin, cos) = pose.heading.sin_cos();
    alone(pose, Velocity::new(15.0 * cos, 15.0 * sin, 0.0))
}

/// 27 boats in `narrow` with noise, after 18 s and a share of the cycle.
fn crowd(drift_s: f64, k: u64) -> Start {
    let parameters = FlockParameters {
        n_boats: 27,
        pool: Pool::NARROW,
        tolerance_cm: 1e-9,
        nop1_s: drift_s,
        bw_s: 2.0 * drift_s,
        nop2_s: drift_s,
        ..FlockParameters::default()
    };
    let mut flock = Flock::new(parameters.clone(), 1 + k).unwrap();
    flock
        .advance(18.0 + 0.15 * drift_s * k as f64, None)
        .unwrap();
    Start {
        state: State {
            poses: flock.poses().to_vec(),
            velocities: flock.velocities().to_vec(),
            time_s: flock.time_s(),
            allow_overlap: true,
        },
        parameters,
        seconds: 0.5,
    }
}

/// In how many of the starts the stated error is within a factor of 3 of the distance from substeps of 1e-4 s.
fn honest_starts(starts: &[Start], dt_s: f64) -> usize {
    let is_honest = |start: &&Start| {
        let flock = |tolerance_cm| {
            let p = changed(start.parameters.clone(), |p| {
                (p.dt_s, p.tolerance_cm) = (dt_s, tolerance_cm);
            });
            Flock::from_state(p, 5, &start.state).unwrap()
        };
        let mut own = flock(1e-4);
        let stated = own.advance_with_error(start.seconds, None).unwrap();
        let mut exact = flock(1e-9);
        exact.set_step(EXACT_S).unwrap();
        exact.advance(start.seconds, None).unwrap();
        let error = rms_distance(own.poses(), exact.poses(), RHO);
        (error / 3.0..=3.0 * error).contains(&stated)
    };
    starts.par_iter().filter(is_honest).count()
}

#[test]
fn nine_tenths_of_stated_errors_are_within_a_factor_of_3() {
    let starts = |start: fn(u64) -> Start| (0..40).into_par_iter().map(start).collect::<Vec<_>>();
    for (name, starts) in [
        ("slide", starts(slide)),
        ("impact", starts(impact)),
        ("jam", starts(|k| crowd(0.0, k))),
        ("cycle", starts(|k| crowd(1.0, k))),
    ] {
        for dt_s in [0.1, 0.02] {
            let honest = honest_starts(&starts, dt_s);
            assert!(honest >= 36, "{name}, dt = {dt_s} s: {honest} of 40");
        }
    }
}

#[test]
fn the_noise_is_the_same_function_of_time_whatever_the_step() {
    // With moreau and without damping a spin is c4·W(t) at any t on the grid.
    let p = changed(inert(Scheme::Moreau), |p| p.c4 = 0.3);
    let spin = |steps: &[f64]| {
        let mut boat = seeded_flock_of(&p, &[([0.0; 3], [0.0; 3])], 9);
        for &dt_s in steps {
            boat.set_step(dt_s).unwrap();
            boat.advance(0.6, None).unwrap();
        }
        boat.velocities()[0].angular
    };
    let whole = spin(&[0.02, 0.02]);
    for steps in [[0.1, 0.003], [0.0025, 0.05], [1e-3, 1e-3]] {
        assert_near(spin(&steps), whole, 1e-13, steps);
    }
    let other = changed(p.clone(), |p| p.dt_s = 0.01);
    let mut other = seeded_flock_of(&other, &[([0.0; 3], [0.0; 3])], 9);
    other.advance(1.2, None).unwrap();
    assert!((other.velocities()[0].angular - whole).abs() > 1e-3);
}

#[test]
fn without_noise_a_flock_whose_step_was_set_is_one_that_was_made_with_it() {
    // Hulls that overlap part within a whole substep, so that its length shows.
    let states = [
        ([0.0, 0.0, 0.0], [0.0; 3]),
        ([14.996, 0.0, 0.0], [0.0; 3]),
        ([7.0, 9.997, 0.0], [0.0; 3]),
    ];
    for scheme in SCHEMES {
        let made = changed(driven(scheme), |p| p.dt_s = 0.01);
        let other = changed(driven(scheme), |p| p.dt_s = 0.1);
        let mut made = flock_of(&made, &states);
        let mut set = flock_of(&other, &states);
        set.set_step(0.01).unwrap();
        for _ in 0..20 {
            made.advance(0.0063, None).unwrap();
            set.advance(0.0063, None).unwrap();
            assert_eq!(bits(&set), bits(&made), "{scheme:?}");
        }
    }
}

#[test]
fn stating_an_error_changes_no_bit_of_the_motion() {
    for scheme in SCHEMES {
        let p = busy(scheme, Noise::White);
        let mut flock = Flock::new(p, 3).unwrap();
        let mut plain = flock.clone();
        let mut worst = 0.0_f64;
        for seconds in [0.5, 0.013, 1.0] {
            worst = worst.max(flock.advance_with_error(seconds, None).unwrap());
            plain.advance(seconds, None).unwrap();
            assert_eq!(bits(&flock), bits(&plain), "{scheme:?}");
        }
        assert!(worst > 0.0);
        let (mut with, without) = (*flock.statistics(), *plain.statistics());
        assert_eq!(with.worst_error_cm, worst);
        with.worst_error_cm = 0.0;
        assert_eq!(with, without);
    }
}

/// What a flock whose step changes comes to, cut by a snapshot or not, in a branch or not.
fn changed_on_the_way(seed: u64, is_cut: bool, noise_seed: Option<u64>) -> (Vec<u64>, u64) {
    let flock = Flock::new(busy(Scheme::Leapfrog, Noise::White), seed).unwrap();
    let mut flock = Flock::from_snapshot(&flock.snapshot(), noise_seed).unwrap();
    flock.advance(0.5, None).unwrap();
    flock.set_step(0.0071).unwrap();
    flock.advance(0.4, None).unwrap();
    if is_cut {
        flock = Flock::from_snapshot(&flock.snapshot(), None).unwrap();
    }
    let stated = flock.advance_with_error(0.3, None).unwrap();
    (bits(&flock), stated.to_bits())
}

#[test]
fn a_flock_whose_step_changed_has_the_same_bits_through_a_snapshot_and_on_any_number_of_threads() {
    let on = |threads: usize, is_cut: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let flocks = (0..8_u64).into_par_iter();
            let noise_seed = |seed| (seed % 2 == 1).then_some(seed);
            flocks
                .map(|seed| changed_on_the_way(seed, is_cut, noise_seed(seed)))
                .collect::<Vec<_>>()
        })
    };
    let one = on(1, false);
    assert_eq!(on(4, false), one);
    assert_eq!(on(2, true), one);
}

#[test]
fn steps_that_cannot_be_taken_are_refused_and_change_nothing() {
    let mut flock = Flock::new(busy(Scheme::Moreau, Noise::White), 1).unwrap();
    flock.advance(0.3, None).unwrap();
    let before = flock.snapshot();
    for dt_s in [f64::NAN, 0.0, -0.01, 9e-7, 0.11, f64::INFINITY] {
        assert_eq!(refused_field(flock.set_step(dt_s)), "dt_s");
        assert!(flock.snapshot() == before);
    }
    for seconds in [f64::NAN, -1.0] {
        assert_eq!(
            refused_field(flock.advance_with_error(seconds, None)),
            "seconds"
        );
    }
    let rudder = [0.0, 2.0, 0.0];
    assert_eq!(
        refused_field(flock.advance_with_error(0.1, Some(&rudder))),
        "rudder"
    );
    assert!(flock.snapshot() == before);
    flock.set_step(7.9e-6).unwrap();
    let before = flock.snapshot();
    assert_eq!(refused_field(flock.advance_with_error(1e-5, None)), "dt_s");
    assert!(flock.snapshot() == before);
    flock.set_step(8e-6).unwrap();
    flock.advance_with_error(1e-5, None).unwrap();
    let mut drawn = Flock::new(busy(Scheme::Moreau, Noise::PerStep), 1).unwrap();
    let before = drawn.snapshot();
    let field = refused_field(drawn.advance_with_error(0.1, None));
    assert_eq!(field, "noise_scheme");
    assert!(drawn.snapshot() == before);
}
