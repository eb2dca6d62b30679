//! Scenes that no flock should be in, and what becomes of them: hulls that overlap, a pool that is too
//! small, substeps of a whole second, a full pool at rest.
//!
//! On paper: two boats at rest that overlap by g < 0.01 cm come apart at g/dt, each taking half; deeper
//! overlaps are undone by displacement and leave boats at rest.

use crate::support::{
    RHO, SCHEMES, TOLERANCES, VELOCITY_SCHEMES, assert_near, bits, changed, crowded,
    deepest_overlap, disc, driven, first_kick_s, inert, kinetic_energy, set_off, table_3,
    take_substeps,
};
use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::Pool;
use flockenv::{Flock, FlockParameters};
use std::f64::consts::TAU;

/// Two boats at rest, nose to tail, that overlap.
fn overlapping(p: &FlockParameters, overlap: f64) -> Flock {
    crowded(p, &[0.0, 15.0 - overlap].map(|x| ([x, 0.0, 0.0], [0.0; 3])))
}

#[test]
fn shallow_overlap_at_rest_opens_in_one_substep() {
    for scheme in VELOCITY_SCHEMES {
        let overlap = 0.004;
        let mut flock = overlapping(&inert(scheme), overlap);
        take_substeps(&mut flock, 1);
        let speed = 0.5 * overlap / 0.02;
        assert_near(flock.velocities()[1].linear.x, speed, 1e-10, scheme);
        assert_near(flock.velocities()[0].linear.x, -speed, 1e-10, scheme);
        assert!(deepest_overlap(&flock) < 1e-10);
    }
}

#[test]
fn deep_overlap_and_crossed_cores_come_apart_without_speed() {
    // What is left after the displacement, a thousandth of a centimeter, opens as a shallow overlap:
    // at most 0.001/dt a contact, half of it each.
    for scheme in SCHEMES {
        for states in [
            vec![([0.0, 0.0, 0.0], [0.0; 3]), ([10.0, 0.0, 0.0], [0.0; 3])],
            vec![([0.0, 0.0, 0.0], [0.0; 3]), ([0.0, 5.0, 0.1], [0.0; 3])],
            vec![([0.0, 0.0, 0.0], [0.0; 3]), ([0.5, 0.3, 1.5], [0.0; 3])],
            vec![([0.0, 0.0, 0.3], [0.0; 3]), ([0.0, 0.0, 0.3], [0.0; 3])],
            vec![([84.0, 0.0, 0.3], [0.0; 3]), ([88.0, 3.0, 1.0], [0.0; 3])],
            vec![([0.0, 0.0, 0.0], [0.0; 3]); 3],
        ] {
            let p = changed(inert(scheme), |p| p.pool = disc(90.0));
            let mut flock = crowded(&p, &states);
            let boats = states.len() as f64;
            for _ in 0..20 {
                take_substeps(&mut flock, 1);
                let bound = boats * (0.5 * 0.001_1 / 0.01_f64).powi(2);
                let energy = kinetic_energy(&flock);
                assert!(energy < bound, "{scheme:?} {energy}");
                assert!(flock.poses().iter().all(Pose::is_finite));
            }
            assert!(deepest_overlap(&flock) <= 0.0101, "{scheme:?} {states:?}");
            assert!(flock.statistics().depenetration_passes > 0);
        }
    }
}

#[test]
fn too_many_boats_for_the_pool_stay_bounded() {
    // 140 hulls cover 99.6 % of narrow and cannot be disjoint: velocities stay bounded by what engines
    // can give, nothing is NaN, and a status says so, or a boat would be pushed out of the water.
    for scheme in SCHEMES {
        let p = FlockParameters {
            pool: Pool::NARROW,
            c4: 0.1,
            ..driven(scheme)
        };
        let states: Vec<_> = (0..140)
            .map(|i| {
                let (ring, place) = (f64::from(i % 4), f64::from(i / 4));
                let (polar, radius) = (TAU * place / 35.0, 54.0 + 10.0 * ring);
                let at = [
                    radius * polar.cos(),
                    radius * polar.sin(),
                    polar * 3.0 + ring,
                ];
                (at, [0.0; 3])
            })
            .collect();
        let mut flock = crowded(&p, &states);
        for _ in 0..8 {
            let before = bits(&flock);
            if let Err(error) = flock.advance(0.02, None) {
                assert!(error.to_string().contains("leave the water"), "{error}");
                assert_eq!(bits(&flock), before);
                break;
            }
            for (pose, velocity) in flock.poses().iter().zip(flock.velocities()) {
                assert!(pose.is_finite() && velocity.is_finite());
                assert!(velocity.linear.norm() < 60.0, "{scheme:?}: {velocity:?}");
                assert!((48.5..=90.0).contains(&pose.position.norm()));
            }
        }
        let statistics = flock.statistics();
        assert!(statistics.depenetration_passes > 0 && statistics.worst_overlap_cm > 0.1);
        assert!(statistics.unsolved > 0, "{statistics:?}");
    }
}

#[test]
fn substeps_of_a_whole_second_are_stable() {
    for n_boats in [1, 12, 27] {
        let p = FlockParameters {
            n_boats,
            pool: Pool::NARROW,
            dt_s: 1.0,
            ..table_3()
        };
        let mut flock = Flock::new(p, 3).expect("room");
        for _ in 0..10 {
            flock.advance(10.0, None).expect("finite motion");
            // The engine never drives a boat beyond v0, nor any impulse a flock beyond n boats of v0.
            assert!(
                kinetic_energy(&flock)
                    < n_boats as f64 * 0.5 * (15.0_f64.powi(2) + (RHO * 4.0).powi(2))
            );
            assert!(flock.poses().iter().all(|p| p.position.norm() < 90.0));
        }
    }
}

#[test]
fn a_full_pool_with_its_engines_off_never_gains_energy() {
    // With the water's drag, not at all. Without it (c0 = 0) up to what opening overlaps of the
    // linearization takes, Σλ·overlap/dt, but never above the start.
    for scheme in VELOCITY_SCHEMES {
        for c0 in [1.0, 0.0] {
            let p = FlockParameters {
                n_boats: 114,
                c0,
                pool: Pool::NARROW,
                ..inert(scheme)
            };
            let mut flock = set_off(p, 2, |boat, _| {
                let phase = 2.4 * boat as f64;
                Velocity::new(10.0 * phase.cos(), 10.0 * phase.sin(), phase.sin())
            });
            let start = kinetic_energy(&flock);
            let mut before = start;
            for step in 0..500 {
                let overlap = deepest_overlap(&flock);
                take_substeps(&mut flock, 1);
                let kick = if step == 0 {
                    first_kick_s(scheme, 0.02)
                } else {
                    0.02
                };
                let impulses: f64 = flock.contacts().iter().map(|c| c.force * kick).sum();
                let undone = if c0 == 0.0 {
                    impulses * overlap / 0.02
                } else {
                    0.0
                };
                let now = kinetic_energy(&flock);
                let most = before * (1.0 + 1e-12) + undone;
                assert!(now <= most, "{scheme:?} {c0}: {before} {now}");
                assert!(now <= start);
                before = now;
            }
        }
    }
}

#[test]
fn part_of_a_substep_opens_its_part_of_an_overlap() {
    // An overlap has a whole substep to close in, however short the one at hand is: relinearization does not hurry it.
    for tolerance_cm in TOLERANCES {
        for scheme in VELOCITY_SCHEMES {
            let p = changed(inert(scheme), |p| p.tolerance_cm = tolerance_cm);
            let overlap = 0.004;
            let mut flock = overlapping(&p, overlap);
            flock.advance(0.005, None).expect("finite motion");
            let speed = 0.5 * overlap / 0.02;
            let found = flock.velocities()[1].linear.x;
            assert!((found - speed).abs() < 1e-9, "{scheme:?}: {found}");
            assert!((deepest_overlap(&flock) - 0.75 * overlap).abs() < 1e-9);
            // Hurried, it would be taken back, in ever shorter substeps.
            assert_eq!(flock.statistics().substeps, 1);
        }
    }
}
