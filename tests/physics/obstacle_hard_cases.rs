//! Hard cases of contacts with discs and walls, each with its answer from a formula. Walls have no thickness: once a
//! boat's core were through one, no gap would show on which side it was.
//!
//! On paper: a boat wedged between two contacts whose normals are at ±γ to its engine's push presses on each with
//! c0·v0/(2·cos γ).

use crate::obstacles::arena;
use crate::support::{
    H, R, SCHEMES, VELOCITY_SCHEMES, assert_near, assert_solved, bits, changed, core, crowded,
    deepest_overlap, disc, disc_at, driven, inert, segment_distance, take_substeps, wall,
    wall_ends,
};
use flockenv::contact::Partner;
use flockenv::parameters::{Noise, Scheme};
use flockenv::{Flock, FlockError, FlockParameters};

/// c0·v0 of Table 3.
pub const PUSH: f64 = 15.0;

/// Forces of obstacles, largest first.
fn obstacle_forces(flock: &Flock) -> Vec<f64> {
    let contacts = flock.contacts();
    let pushing = contacts.iter().filter(|c| c.force > 0.0);
    let mut forces: Vec<f64> = pushing
        .filter(|c| matches!(c.contact.partner, Partner::Obstacle(_)))
        .map(|c| c.force)
        .collect();
    forces.sort_by(|a, b| b.total_cmp(a));
    forces
}

/// A boat whose bow is at a place, heading along x at rest.
fn bow_at(x: f64, y: f64) -> ([f64; 3], [f64; 3]) {
    ([x - H, y, 0.0], [0.0; 3])
}

/// A thin wall across the way of boats that head along x.
fn before_a_wall(p: FlockParameters, dt_s: f64) -> FlockParameters {
    FlockParameters {
        dt_s,
        walls: vec![wall((0.0, -50.0), (0.0, 50.0))],
        ..p
    }
}

/// Every wall's distance from every core: nothing is through a wall where this is above 0.
fn nearest_core_to_a_wall(flock: &Flock) -> f64 {
    let p = flock.parameters();
    let mut nearest = f64::INFINITY;
    for pose in flock.poses() {
        for wall in &p.walls {
            let distance = segment_distance(core(pose, p.half_length_cm()), wall_ends(wall));
            nearest = nearest.min(distance);
        }
    }
    nearest
}

/// Rests for 50 substeps with these forces of the obstacles.
pub fn assert_wedged(p: &FlockParameters, bow: (f64, f64), each: f64, count: usize, what: &str) {
    let start = bow_at(bow.0, bow.1);
    let mut flock = crowded(p, &[start]);
    for _ in 0..50 {
        take_substeps(&mut flock, 1);
        let forces = obstacle_forces(&flock);
        assert_eq!(forces.len(), count, "{what}: {forces:?}");
        for force in forces {
            assert_near(force, each, 1e-6 * each.max(1.0), what);
        }
    }
    let pose = flock.poses()[0];
    assert_near(pose.position.x, start.0[0], 1e-8, what);
    assert!(pose.position.y.abs() < 1e-9 && pose.heading.abs() < 1e-9);
    assert_solved(&flock);
}

#[test]
fn head_on_at_a_thin_wall_a_boat_stops_at_it() {
    // However fast it comes and however long the substep is.
    for scheme in SCHEMES {
        for dt_s in [0.02, 0.1] {
            for speed in [15.0, 300.0, 20_000.0] {
                let p = before_a_wall(inert(scheme), dt_s);
                let mut flock = crowded(&p, &[([-40.0, 0.0, 0.3], [speed, 0.0, 0.0])]);
                flock.advance(4.0, None).expect("finite motion");
                assert!(
                    nearest_core_to_a_wall(&flock) > R - 1e-3,
                    "{scheme:?} {dt_s} {speed}"
                );
                assert!(flock.poses()[0].position.x < 0.0);
                assert!(deepest_overlap(&flock) < 1e-3);
            }
        }
    }
}

#[test]
fn a_boat_driven_at_a_thin_wall_presses_on_it() {
    for scheme in VELOCITY_SCHEMES {
        for dt_s in [0.02, 0.1] {
            let p = before_a_wall(driven(scheme), dt_s);
            let mut flock = crowded(&p, &[([-30.0, 0.0, 0.0], [15.0, 0.0, 0.0])]);
            flock.advance(20.0, None).expect("finite motion");
            assert!((flock.poses()[0].position.x + R + H).abs() < 1e-9);
            let forces = obstacle_forces(&flock);
            assert_eq!(forces.len(), 1);
            assert!((forces[0] - PUSH).abs() < 1e-6, "{forces:?}");
            assert_solved(&flock);
        }
    }
}

#[test]
fn a_boat_too_fast_for_a_wall_is_a_named_error() {
    for scheme in SCHEMES {
        let p = before_a_wall(inert(scheme), 0.02);
        let mut flock = crowded(&p, &[([-40.0, 0.0, 0.0], [1e7, 0.0, 0.0])]);
        let before = (flock.snapshot(), bits(&flock));
        match flock.advance(1.0, None) {
            Err(FlockError::Solver(message)) => assert!(message.contains("through a wall")),
            other => panic!("{scheme:?}: {other:?}"),
        }
        assert_eq!((flock.snapshot(), bits(&flock)), before);
        // Discs have a thickness: nothing is lost.
        let p = changed(inert(scheme), |p| p.discs = vec![disc_at(0.0, 80.0, 5.0)]);
        let mut flock = crowded(&p, &[([-40.0, 0.0, 0.0], [1e7, 0.0, 0.0])]);
        flock.advance(1.0, None).expect("finite motion");
    }
}

#[test]
fn a_spinning_long_hull_stays_on_its_side() {
    for scheme in SCHEMES {
        for spin in [3.0, 30.0, -200.0] {
            let p = FlockParameters {
                boat_radius_cm: 1.0,
                boat_shape: 20.0,
                gyration_radius_cm: 12.0,
                dt_s: 0.1,
                walls: vec![wall((0.0, -60.0), (0.0, 60.0))],
                ..inert(scheme)
            };
            let mut flock = crowded(&p, &[([-18.0, 0.0, 1.5], [5.0, 0.0, spin])]);
            for _ in 0..20 {
                flock.advance(0.1, None).expect("finite motion");
                assert!(nearest_core_to_a_wall(&flock) > 0.3, "{scheme:?} {spin}");
                assert!(flock.poses()[0].position.x < 0.0);
            }
        }
    }
}

#[test]
fn a_row_of_boats_squeezes_the_first_against_a_wall() {
    // k engines press on the wall with k·c0·v0, through the boats between.
    for scheme in VELOCITY_SCHEMES {
        for dt_s in [0.02, 0.1] {
            for k in [2_usize, 6] {
                let p = before_a_wall(driven(scheme), dt_s);
                let row: Vec<_> = (0..k).map(|i| bow_at(-R - 15.0 * i as f64, 0.0)).collect();
                let mut flock = crowded(&p, &row);
                take_substeps(&mut flock, 50);
                let forces = obstacle_forces(&flock);
                assert_eq!(forces.len(), 1);
                assert!((forces[0] - k as f64 * PUSH).abs() < 1e-6, "{forces:?}");
                assert_solved(&flock);
            }
        }
    }
}

#[test]
fn a_crowd_stays_on_its_side_of_a_wall() {
    // A chord without a gate: noisy boats that start above it are above it ever after.
    for scheme in SCHEMES {
        for dt_s in [0.02, 0.1] {
            let p = FlockParameters {
                n_boats: 20,
                n_leaders: 0,
                bw_s: 0.3,
                dt_s,
                pool: disc(70.0),
                discs: vec![],
                walls: vec![wall((-80.0, 0.0), (80.0, 0.0))],
                ..arena(scheme, Noise::White)
            };
            let rows = (0..4).flat_map(|row| {
                (0..5).map(move |column| {
                    let (x, y) = (f64::from(column) * 16.0 - 32.0, 6.0 + 11.0 * f64::from(row));
                    ([x, y, 0.0], [0.0; 3])
                })
            });
            let mut flock = crowded(&p, &rows.collect::<Vec<_>>());
            for _ in 0..30 {
                flock.advance(1.0, None).expect("finite motion");
                assert!(flock.poses().iter().all(|pose| pose.position.y > 0.0));
                assert!(
                    nearest_core_to_a_wall(&flock) > 0.9 * R,
                    "{scheme:?} {dt_s}"
                );
            }
        }
    }
}

#[test]
fn a_boat_wedged_in_a_corner_of_two_walls() {
    // Walls at ±β to the boat's course: its bow's disc rests r/sin β before their meeting point.
    for scheme in VELOCITY_SCHEMES {
        for beta in [0.1_f64, 0.35, 0.8, 1.4] {
            let (sin, cos) = beta.sin_cos();
            let reach = 150.0;
            let p = FlockParameters {
                walls: vec![
                    wall((0.0, 0.0), (-reach * cos, reach * sin)),
                    wall((-reach * cos, -reach * sin), (0.0, 0.0)),
                ],
                ..driven(scheme)
            };
            let case = format!("{scheme:?} {beta}");
            assert_wedged(&p, (-R / sin, 0.0), PUSH / (2.0 * sin), 2, &case);
        }
    }
}

#[test]
fn a_boat_bow_on_to_the_end_of_a_wall() {
    for scheme in VELOCITY_SCHEMES {
        let p = changed(driven(scheme), |p| {
            p.walls = vec![wall((0.0, 0.0), (60.0, 0.0))];
        });
        assert_wedged(&p, (-R, 0.0), PUSH, 1, scheme.name());
        let p = changed(driven(scheme), |p| p.discs = vec![disc_at(4.0, 0.0, 4.0)]);
        assert_wedged(&p, (-R, 0.0), PUSH, 1, scheme.name());
    }
}

#[test]
fn sliding_past_the_end_of_a_wall_costs_nothing() {
    for scheme in SCHEMES {
        for dt_s in [0.02, 0.1] {
            for boat_shape in [0.0, 0.5] {
                let p = FlockParameters {
                    dt_s,
                    boat_shape,
                    walls: vec![wall((-100.0, 0.0), (0.0, 0.0))],
                    ..inert(scheme)
                };
                let start = ([-30.0, R, 0.0], [12.0, 0.0, 0.0]);
                let mut flock = crowded(&p, &[start]);
                flock.advance(5.0, None).expect("finite motion");
                let (pose, velocity) = (flock.poses()[0], flock.velocities()[0]);
                assert!((pose.position.x - 30.0).abs() < 1e-9, "{scheme:?} {pose:?}");
                assert!((pose.position.y - R).abs() < 1e-9 && pose.heading.abs() < 1e-9);
                assert!((velocity.linear.x - 12.0).abs() < 1e-10);
            }
        }
    }
}

#[test]
fn the_joint_of_two_walls_in_line_lifts_a_boat_a_little() {
    // The second wall's end lies ahead, and a gap that is linearized closes sooner than it does: at a speed v the boat
    // leaves the joint with less than half of v²·dt/r across, and loses nothing else.
    for dt_s in [0.02, 0.01, 0.005] {
        let p = FlockParameters {
            dt_s,
            boat_shape: 0.0,
            walls: vec![
                wall((-100.0, 0.0), (0.0, 0.0)),
                wall((0.0, 0.0), (100.0, 0.0)),
            ],
            ..inert(Scheme::Leapfrog)
        };
        let mut flock = crowded(&p, &[([-30.0, R, 0.0], [12.0, 0.0, 0.0])]);
        flock.advance(5.0, None).expect("finite motion");
        let (pose, velocity) = (flock.poses()[0], flock.velocities()[0].linear);
        let lifted = 144.0 * dt_s / R;
        assert!(
            velocity.y >= 0.0 && velocity.y < 0.5 * lifted,
            "{velocity:?}"
        );
        assert!(velocity.x <= 12.0 + 1e-9 && velocity.x > 12.0 - 0.2 * lifted);
        assert!(pose.position.x > 29.0);
    }
}

#[test]
fn a_boat_flat_between_a_wall_and_a_disc_opposite() {
    // Held at both ends and in its middle, it cannot move at all, whatever it comes with. (A spin contradicts the flank
    // on the disc, and counts as unsolved before it is stopped.)
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            walls: vec![wall((-50.0, -R), (50.0, -R))],
            discs: vec![disc_at(0.0, R + 6.0, 6.0)],
            ..inert(scheme)
        };
        for velocity in [[0.0, 8.0, 0.0], [0.0, -8.0, 1.0], [0.0, 5.0, -2.0]] {
            let mut flock = crowded(&p, &[([0.0; 3], velocity)]);
            take_substeps(&mut flock, 20);
            let pose = flock.poses()[0];
            assert!(
                pose.position.norm() < 1e-8 && pose.heading.abs() < 1e-8,
                "{pose:?}"
            );
            if velocity[2] == 0.0 {
                assert_solved(&flock);
            }
        }
    }
}

#[test]
fn a_noisy_crowd_among_obstacles_overlaps_them_no_more_than_walls() {
    for scheme in SCHEMES {
        let p = arena(scheme, Noise::White);
        let mut flock = Flock::new(p, 11).expect("room");
        let mut deepest = 0.0_f64;
        for _ in 0..60 {
            flock.advance(0.5, None).expect("finite motion");
            deepest = deepest.max(deepest_overlap(&flock));
            assert!(nearest_core_to_a_wall(&flock) > 0.9 * R);
        }
        assert!(deepest < 0.05, "{scheme:?}: {deepest}");
        assert_solved(&flock);
    }
}

#[test]
fn a_boat_between_the_rim_and_a_wall() {
    // A wall along a chord, the rim beyond: the boat is held with its bow between both, and at rest.
    let q: f64 = 90.0 - R;
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            pool: disc(90.0),
            walls: vec![
                wall((-90.0, 60.0), (90.0, 60.0)),
                wall((-90.0, -60.0), (90.0, -60.0)),
            ],
            ..driven(scheme)
        };
        // The corner of chord and rim: r from the chord, r from the rim.
        let y: f64 = 60.0 + R;
        let x = (q * q - y * y).sqrt();
        let mut flock = crowded(&p, &[([x - H - 0.5, y, 0.0], [0.0; 3])]);
        flock.advance(60.0, None).expect("finite motion");
        let speed = flock.velocities()[0].linear.norm();
        assert!(speed < 1e-3, "{scheme:?} {speed}");
        assert!(deepest_overlap(&flock) < 0.01);
        assert_solved(&flock);
    }
}
