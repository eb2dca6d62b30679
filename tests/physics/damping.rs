//! Damping and drag take at most what there is: without motors, rudders and noise no substep of any length makes a boat
//! faster, turns its spin round or, unless it backs, makes it spin faster.
//!
//! On paper: a boat that drifts ahead at 15 cm/s with a spin of 4 rad/s loses c3·15·0.1 s = 1.5 times its spin by the
//! weathervane and c1·16·0.1 s = 1.6 times by the cubic term in an explicit step of 0.1 s, and stops turning. One that backs
//! spins up to the rate at which both terms cancel, c1·w² = c3·|u·v|, and no further.

use crate::support::{SCHEMES, cases, changed, driven, flock_of, kinetic_energy, take_substeps};
use flockenv::FlockParameters;
use flockenv::geometry::Velocity;
use flockenv::parameters::Scheme;
use proptest::prelude::*;

/// No motors: one boat in open water drifts.
fn drifting(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        fw_s: 0.0,
        nop1_s: 1.0,
        ..driven(scheme)
    }
}

#[test]
fn a_spin_ahead_dies_away_without_turning_round() {
    for scheme in SCHEMES {
        for (speed, spin, dt_s) in [(15.0, 4.0, 0.1), (60.0, 4.0, 0.02), (100.0, 30.0, 0.05)] {
            let p = changed(drifting(scheme), |p| p.dt_s = dt_s);
            let mut flock = flock_of(&p, &[([0.0; 3], [speed, 0.0, spin])]);
            let mut before = spin;
            for _ in 0..20 {
                take_substeps(&mut flock, 1);
                let now = flock.velocities()[0].angular;
                assert!(
                    (0.0..=before).contains(&now),
                    "{scheme:?} {speed}: {before} {now}"
                );
                before = now;
            }
        }
    }
}

#[test]
fn explicit_damping_that_would_overshoot_stops_the_spin() {
    for scheme in [Scheme::Moreau, Scheme::Paper] {
        let p = changed(drifting(scheme), |p| p.dt_s = 0.1);
        let mut flock = flock_of(&p, &[([0.0; 3], [15.0, 0.0, 4.0])]);
        take_substeps(&mut flock, 1);
        assert_eq!(flock.velocities()[0].angular, 0.0, "{scheme:?}");
    }
}

#[test]
fn a_backing_boat_spins_up_to_where_it_comes_to_rest() {
    for scheme in SCHEMES {
        // Its speed stays: it spins up to sqrt(c3·60/c1), whatever a step of 0.1 s would overshoot by.
        let p = changed(drifting(scheme), |p| (p.c0, p.dt_s) = (0.0, 0.1));
        let mut flock = flock_of(&p, &[([0.0; 3], [-60.0, 0.0, 0.1])]);
        let rest = 60.0_f64.sqrt();
        for _ in 0..20 {
            take_substeps(&mut flock, 1);
            let spin = flock.velocities()[0].angular;
            assert!(
                (0.0..=rest * (1.0 + 1e-12)).contains(&spin),
                "{scheme:?}: {spin}"
            );
        }
    }
}

/// Zero, or anything from 1e-3 to 1e6.
fn constant() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 6 => (-3.0..6.0).prop_map(|power| 10.0_f64.powf(power))]
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn no_substep_of_any_parameters_adds_to_what_drifts(
        scheme in prop_oneof![Just(Scheme::Leapfrog), Just(Scheme::Moreau), Just(Scheme::Paper)],
        (c0, c1, c3) in (constant(), constant(), constant()),
        dt_power in -6.0..0.0,
        gyration_radius_cm in 0.1..20.0,
        velocity in (-1e3..1e3, -1e3..1e3, -1e3..1e3),
        heading in -3.2..3.2,
    ) {
        let longest = scheme.longest_dt_s();
        let p = FlockParameters {
            c0,
            c1,
            c3,
            gyration_radius_cm,
            dt_s: (longest * 10.0_f64.powf(dt_power)).max(1e-6),
            ..drifting(scheme)
        };
        let (u, v, spin) = velocity;
        let mut flock = flock_of(&p, &[([0.0, 0.0, heading], [u, v, spin])]);
        for _ in 0..4 {
            let (energy, before) = (kinetic_energy(&flock), flock.velocities()[0]);
            let along = before.linear.dot(&flock.hulls()[0].axis);
            // Without c1 nothing ends the spinning up of a backing boat but the range of numbers.
            if flock.advance(flock.parameters().dt_s, None).is_err() {
                prop_assert!(along < 0.0 && c1 < 1e-3, "{before:?}");
                break;
            }
            let now = flock.velocities()[0];
            let more = 1.0 + 1e-12;
            prop_assert!(now.linear.norm() <= before.linear.norm() * more, "{before:?} {now:?}");
            prop_assert!(now.angular * before.angular >= 0.0, "{before:?} {now:?}");
            if along >= 0.0 {
                prop_assert!(kinetic_energy(&flock) <= energy * more, "{before:?} {now:?}");
            } else if c1 > 0.0 {
                let rest = (c3 * along.abs() / c1).sqrt();
                let most = before.angular.abs().max(rest) * more;
                prop_assert!(now.angular.abs() <= most, "{rest} {before:?} {now:?}");
            }
        }
    }
}

#[test]
fn boats_that_are_thrown_into_each_other_lose_energy() {
    for scheme in SCHEMES {
        let p = FlockParameters {
            n_boats: 40,
            pool: flockenv::parameters::Pool::NARROW,
            c3: 0.0,
            dt_s: 0.1,
            ..drifting(scheme)
        };
        let mut flock = crate::support::set_off(p, 3, |boat, _| {
            let angle = 2.4 * boat as f64;
            Velocity::new(40.0 * angle.cos(), 40.0 * angle.sin(), 0.0)
        });
        let mut before = kinetic_energy(&flock);
        for _ in 0..100 {
            take_substeps(&mut flock, 1);
            let now = kinetic_energy(&flock);
            assert!(now <= before * 1.01, "{scheme:?}: {before} {now}");
            before = now;
        }
    }
}
