//! Boats that push and do not move: contact forces balance the engines, c0·v0 a boat.
//!
//! On paper: k boats in a row press on the wall with k·c0·v0, and the j-th joint from the tail carries
//! j·c0·v0. The `paper` scheme loses its accelerations in every substep with a contact: the half of
//! that on average, as long as every second substep has one.

use crate::support::{
    H, R, SCHEMES, VELOCITY_SCHEMES, annulus, assert_near, changed, disc, driven, flock_of,
    take_substeps,
};
use flockenv::contact::Partner;
use flockenv::parameters::Scheme;
use flockenv::{Flock, FlockParameters};

/// c0·v0 of Table 3.
const PUSH: f64 = 15.0;

/// k boats nose to tail along x, the first of them at the wall of a pool of radius 90 cm.
fn row(p: &FlockParameters, k: usize) -> Flock {
    let p = changed(p.clone(), |p| p.pool = disc(90.0));
    let states: Vec<_> = (0..k)
        .map(|i| ([82.5 - 15.0 * i as f64, 0.0, 0.0], [0.0; 3]))
        .collect();
    flock_of(&p, &states)
}

/// Forces of the row's contacts, from the tail to the wall.
fn forces(flock: &Flock, k: usize) -> Vec<f64> {
    let mut forces = vec![0.0; k];
    for contact in flock.contacts() {
        // Boat i pushes boat i − 1; boat 0 pushes the wall.
        match contact.contact.partner {
            Partner::OuterWall => forces[k - 1] += contact.force,
            Partner::Boat(behind) => forces[k - 1 - behind as usize] += contact.force,
            Partner::InnerWall | Partner::Obstacle(_) => panic!("there is none"),
        }
    }
    forces
}

#[test]
fn a_row_of_boats_pushes_the_wall() {
    for scheme in VELOCITY_SCHEMES {
        for k in [1, 2, 4, 6] {
            let mut flock = row(&driven(scheme), k);
            for _ in 0..50 {
                take_substeps(&mut flock, 1);
                for (joint, force) in forces(&flock, k).iter().enumerate() {
                    let expected = (joint + 1) as f64 * PUSH;
                    // The residual of 1e-10 cm/s over the kick of 0.01 s.
                    assert_near(*force, expected, 1e-7, (scheme, joint));
                }
            }
            for pose in flock.poses() {
                assert!(pose.position.y.abs() < 1e-12 && pose.heading.abs() < 1e-12);
            }
        }
    }
}

fn mean_forces(p: &FlockParameters, k: usize, substeps: usize) -> Vec<f64> {
    let mut flock = row(p, k);
    let mut sums = vec![0.0; k];
    for _ in 0..substeps {
        take_substeps(&mut flock, 1);
        let now = forces(&flock, k);
        sums.iter_mut().zip(now).for_each(|(sum, f)| *sum += f);
    }
    sums.iter().map(|sum| sum / substeps as f64).collect()
}

#[test]
fn the_paper_scheme_pushes_with_half_on_average() {
    // At rest at the wall: one substep gains dt·c0·v0, the next loses it to the projection.
    for dt_s in [0.1, 0.02, 0.001] {
        for k in [1, 3] {
            let p = FlockParameters {
                overlap_tolerance_cm: 0.0,
                dt_s,
                ..driven(Scheme::Paper)
            };
            for (joint, mean) in mean_forces(&p, k, 400).into_iter().enumerate() {
                let expected = 0.5 * (joint + 1) as f64 * PUSH;
                assert!((mean - expected).abs() < 1e-6, "{dt_s} {joint}: {mean}");
            }
        }
    }
}

/// Steps 1–6 of the appendix for one boat on a line that ends at 0: the mean force on the wall.
fn force_on_a_line(dt: f64, tolerance: f64, substeps: usize) -> f64 {
    let (mut x, mut v, mut impulses) = (0.0, 0.0, 0.0);
    for _ in 0..substeps {
        if x + dt * v <= tolerance {
            (x, v) = (x + dt * v, v + dt * (PUSH - v));
        } else {
            impulses += v + x / dt;
            (x, v) = (0.0, -x / dt);
        }
    }
    impulses / (dt * substeps as f64)
}

/// Long enough for means to converge to about 1e-3.
const SUBSTEPS: usize = 60_000;

#[test]
fn the_paper_scheme_s_force_creeps_up_once_a_push_fits_the_tolerance() {
    // A substep's push moves a boat by c0·v0·dt² in the next: beyond the tolerance of 0.01 cm for
    // dt > 0.0258 s, where the force is halved.
    let force = |dt_s| {
        let p = FlockParameters {
            overlap_tolerance_cm: 0.01,
            dt_s,
            // No phase switch cuts a substep short.
            fw_s: 1e4,
            ..driven(Scheme::Paper)
        };
        mean_forces(&p, 1, SUBSTEPS)[0]
    };
    for dt in [0.05, 0.03, 0.02, 0.01, 0.005] {
        let (found, expected) = (force(dt), force_on_a_line(dt, 0.01, SUBSTEPS));
        // The map is chaotic: rounding decides its course, and only the mean over many substeps is
        // its own.
        assert_near(found, expected, 2e-3 * PUSH, dt);
        if dt > 0.026 {
            assert!((found - 0.5 * PUSH).abs() < 1e-6);
        }
    }
    // Far below, being pushed out at 0.01 cm/dt makes the boat bounce, which adds drag: not exact either.
    assert!((force(0.001) - PUSH).abs() < 0.1 * PUSH);
    assert!(force(0.02) < 0.8 * PUSH);
}

#[test]
fn a_radial_boat_in_a_channel_of_its_own_length() {
    // Both walls are touched and oppose each other exactly: forward presses outward, backing inward.
    for scheme in VELOCITY_SCHEMES {
        for (forward, reverse) in [(true, false), (false, true)] {
            let p = FlockParameters {
                pool: annulus(60.0 + 2.0 * (H + R), 60.0),
                fw_s: f64::from(u8::from(forward)),
                bw_s: f64::from(u8::from(reverse)),
                ..driven(scheme)
            };
            let mut flock = flock_of(&p, &[([60.0 + H + R, 0.0, 0.0], [0.0; 3])]);
            for _ in 0..100 {
                take_substeps(&mut flock, 1);
                for contact in flock.contacts() {
                    let pressed = match contact.contact.partner {
                        Partner::OuterWall => forward,
                        _ => reverse,
                    };
                    // The stern's disc is far from the outer wall and no contact of this substep.
                    let expected = if pressed { PUSH } else { 0.0 };
                    assert!((contact.force - expected).abs() < 1e-7, "{scheme:?}");
                }
            }
            assert_eq!(flock.statistics().unsolved, 0);
            let pose = flock.poses()[0];
            assert!((pose.position.x - 67.5).abs() < 1e-9 && pose.heading.abs() < 1e-12);
        }
    }
}

#[test]
fn a_boat_flung_about_in_a_channel_of_its_own_length_stops() {
    // Both walls at once stop any radial motion, and leave the tangential one.
    for scheme in VELOCITY_SCHEMES {
        for radial in [10.0, -10.0] {
            let p = FlockParameters {
                speed_cm_s: 0.0,
                c0: 0.0,
                pool: annulus(75.0, 60.0),
                ..driven(scheme)
            };
            let mut flock = flock_of(&p, &[([67.5, 0.0, 0.0], [radial, 0.0, 0.0])]);
            take_substeps(&mut flock, 1);
            assert!(flock.velocities()[0].linear.norm() < 1e-10);
            assert!(flock.statistics().worst_residual_cm_s < 1e-10);
        }
    }
}

#[test]
fn clearance_without_contact_gives_exactly_zero_force() {
    // A millionth of a millimeter is no contact for boats that stay or drift along.
    for scheme in SCHEMES {
        let p = changed(driven(scheme), |p| p.pool = disc(90.0));
        let clear = 1e-7;
        let states = [
            ([0.0, 0.0, 0.0], [0.0; 3]),
            ([1.0, 2.0 * R + clear, 0.0], [0.0; 3]),
            ([-1.0, -2.0 * R - clear, 0.0], [0.0; 3]),
        ];
        let mut flock = flock_of(&p, &states);
        take_substeps(&mut flock, 50);
        assert!(!flock.contacts().is_empty());
        assert!(flock.contacts().iter().all(|c| c.force == 0.0));
        // To the last bit as if alone.
        for (pose, state) in flock.poses().iter().zip(states) {
            let mut alone = flock_of(&p, &[state]);
            take_substeps(&mut alone, 50);
            assert_eq!(*pose, alone.poses()[0], "{scheme:?}");
        }
    }
}

#[test]
fn no_solve_without_a_contact() {
    for scheme in SCHEMES {
        let mut flock = flock_of(
            &driven(scheme),
            &[([0.0; 3], [0.0; 3]), ([0.0, 40.0, 0.0], [0.0; 3])],
        );
        take_substeps(&mut flock, 200);
        let statistics = flock.statistics();
        assert_eq!(statistics.substeps, 200);
        assert_eq!((statistics.solves, statistics.contacts), (0, 0));
        assert_eq!(statistics.solver_iterations, 0);
        assert!(flock.contacts().is_empty());
    }
}
