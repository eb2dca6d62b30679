//! A touch is where two cores are nearest, not the end that it is named after: it keeps its contact while hulls turn past
//! a right angle or an end slides past the other hull's end, and nobody ends deeper in another than the tolerance.
//!
//! On paper: a boat that stands across another one's flank, backs towards it and turns past the right angle, touches it
//! with one end throughout. Two inert boats pressed end to flank carry the same impulse on either side of the right angle.

use crate::support::{
    OPEN_WATER, R, VELOCITY_SCHEMES, deepest_overlap, disc_at, driven, flock_of, inert, table_3,
    take_substeps, wall,
};
use approx::assert_abs_diff_eq;
use flockenv::flock::State;
use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::{Pool, Preset, Scheme};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

/// The tolerances that promise something, the default among them.
const PROMISED: [f64; 3] = [1e-4, 1e-6, 1e-9];

/// Two boats alone, backing, in whose next 0.1 s the second turns past a right angle to the first.
fn two_boats(tolerance_cm: f64, dt_s: f64) -> Flock {
    let p = FlockParameters {
        n_boats: 2,
        pool: OPEN_WATER,
        bw_s: 2.0,
        c4: 0.0,
        dt_s,
        tolerance_cm,
        ..table_3()
    };
    let state = State {
        poses: vec![
            Pose::new(74.9982, 3.7936, -3.2166),
            Pose::new(73.3165, -8.7149, -2.1674),
        ],
        velocities: vec![
            Velocity::new(7.9817, -6.3569, 3.062),
            Velocity::new(8.6359, -3.9823, 1.7518),
        ],
        time_s: 28.7,
        allow_overlap: false,
    };
    Flock::from_state(p, 1, &state).expect("no overlap")
}

#[test]
fn a_touch_that_changes_ends_is_not_lost() {
    for tolerance_cm in PROMISED {
        let mut flock = two_boats(tolerance_cm, 0.1);
        flock.advance(0.1, None).expect("finite motion");
        let overlap = deepest_overlap(&flock);
        assert!(overlap <= tolerance_cm, "{tolerance_cm}: {overlap} cm");
        let pushed = flock.contacts().iter().any(|contact| contact.force > 0.0);
        assert!(pushed, "{tolerance_cm}");
    }
}

#[test]
fn what_is_reported_of_a_contact_is_of_its_own_touch() {
    // The contact that carries the force is the one at which the boats touch.
    let mut flock = two_boats(1e-6, 0.1);
    flock.advance(0.1, None).expect("finite motion");
    let contacts = flock.contacts();
    let pushing: Vec<_> = contacts.iter().filter(|c| c.force > 0.0).collect();
    assert!(!pushing.is_empty());
    for contact in pushing {
        assert!(contact.contact.gap.gap < 1e-3, "{contact:?}");
    }
}

/// A boat whose stern turns about a wall's end, or the other way round: in it the same exchange of ends happens.
fn beside_wall(dt_s: f64, tolerance_cm: f64, spin: f64, angle: f64) -> Flock {
    let p = FlockParameters {
        walls: vec![wall((0.0, 0.0), (60.0, 0.0))],
        dt_s,
        tolerance_cm,
        ..inert(VELOCITY_SCHEMES[0])
    };
    let pose = [30.0, 7.55 - 2.5 * (1.0 - angle.cos()), FRAC_PI_2 + angle];
    flock_of(&p, &[(pose, [2.0, -8.0, spin])])
}

#[test]
fn a_boat_that_turns_upright_at_a_straight_wall_stays_out_of_it() {
    for tolerance_cm in PROMISED {
        for spin in [-4.0, -3.0, 3.0, 4.0] {
            for step in -8..=8 {
                let angle = 0.04 * f64::from(step);
                let mut flock = beside_wall(0.05, tolerance_cm, spin, angle);
                for _ in 0..10 {
                    take_substeps(&mut flock, 1);
                    let overlap = deepest_overlap(&flock);
                    assert!(
                        overlap <= tolerance_cm,
                        "{tolerance_cm} {spin} {angle}: {overlap} cm"
                    );
                }
            }
        }
    }
}

#[test]
fn a_contact_keeps_its_touch_past_the_right_angle() {
    // A boat stands on the flank of another one, 0.2 cm off, and turns past the right angle without touching it. Its far end
    // is 5 cm farther. At 60 cm/s both ends are contacts.
    for scheme in VELOCITY_SCHEMES {
        for turn in [-1.0, 1.0] {
            let p = FlockParameters {
                dt_s: 0.1,
                ..inert(scheme)
            };
            let states = [
                ([0.0, 0.0, 0.0], [60.0, 0.0, 0.0]),
                ([0.0, 12.7, FRAC_PI_2 - 0.05 * turn], [60.0, 0.0, turn]),
            ];
            let mut flock = flock_of(&p, &states);
            let is_near_first = turn > 0.0;
            take_substeps(&mut flock, 1);
            let contacts = flock.contacts();
            let gaps: Vec<_> = contacts.iter().map(|c| c.contact.gap.gap).collect();
            let expected = if is_near_first {
                [0.2, 5.2]
            } else {
                [5.2, 0.2]
            };
            assert_eq!(gaps.len(), 2, "{scheme:?} {turn}");
            for (gap, expected) in gaps.iter().zip(expected) {
                assert!((gap - expected).abs() < 0.1, "{scheme:?} {turn}: {gaps:?}");
            }
        }
    }
}

#[test]
fn an_impulse_stays_with_its_touch_past_the_right_angle() {
    // A boat presses its bow into the flank of one without a motor, and turns past the right angle. The guess for the next
    // substep is right, so that each solve takes one round, also where the end's name changes. At 60 cm/s its stern is a
    // contact, too, which never touches.
    let p = FlockParameters {
        n_leaders: 1,
        leader_speed_factor: 0.0,
        speed_cm_s: 60.0,
        c1: 0.0,
        c2: 0.0,
        c3: 0.0,
        dt_s: 0.1,
        tolerance_cm: f64::INFINITY,
        ..driven(VELOCITY_SCHEMES[0])
    };
    let states = [
        ([0.0, 0.0, 0.0], [0.0, -20.0, 0.0]),
        ([0.0, 12.5, -FRAC_PI_2 + 0.02], [0.0, -20.0, -0.1]),
    ];
    let mut flock = flock_of(&p, &states);
    take_substeps(&mut flock, 1);
    let first = *flock.statistics();
    take_substeps(&mut flock, 6);
    let turned = flock.poses()[1].heading - flock.poses()[0].heading + FRAC_PI_2;
    assert!(turned < 0.0, "{turned}");
    let then = flock.statistics();
    assert_eq!(then.contacts, 14, "{then:?}");
    assert_eq!(
        then.solver_iterations - first.solver_iterations,
        6,
        "{then:?}"
    );
}

#[test]
fn no_minute_of_a_crowded_cycle_overlaps_by_more_than_the_tolerance() {
    // Of two hundred minutes a third did where touches were known by their ends.
    for (dt_s, tolerance_cm) in [(0.1, 1e-4), (0.1, 1e-9), (0.05, 1e-4)] {
        for seed in 3000..3030 {
            let p = FlockParameters {
                n_boats: 27,
                pool: Pool::NARROW,
                bw_s: 2.0,
                dt_s,
                tolerance_cm,
                ..FlockParameters::preset(Preset::Simulation)
            };
            let mut flock = Flock::new(p, seed).expect("room");
            for _ in 0..600 {
                flock.advance(0.1, None).expect("finite motion");
            }
            let statistics = flock.statistics();
            let overlap = statistics.worst_overlap_cm;
            assert!(overlap <= tolerance_cm, "{dt_s} {seed}: {overlap} cm");
            assert_eq!(statistics.unsolved, 0, "{dt_s} {seed}");
        }
    }
}

#[test]
fn a_boat_that_others_push_far_meets_nothing_unseen() {
    // Discs: two that meet at 60 cm/s squeeze a third out between them, at 0.577 of their speed. In 0.1 s it moves by
    // 3.46 cm; contacts were looked for within half of the fastest one's 6 cm. A post stands 3.2 cm away.
    let (sin, cos) = FRAC_PI_3.sin_cos();
    let across = 2.0 * R * sin;
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            boat_shape: 0.0,
            dt_s: 0.1,
            tolerance_cm: 1e-4,
            discs: vec![disc_at(2.0 * R * cos + 2.0 * R + 3.2, 0.0, R)],
            ..inert(scheme)
        };
        let states = [
            ([0.0, across, 0.0], [0.0, -60.0, 0.0]),
            ([0.0, -across, 0.0], [0.0, 60.0, 0.0]),
            ([2.0 * R * cos, 0.0, 0.0], [0.0; 3]),
        ];
        let mut flock = flock_of(&p, &states);
        take_substeps(&mut flock, 1);
        assert!(flock.statistics().halved_substeps > 0, "{scheme:?}");
        assert!(deepest_overlap(&flock) <= 1e-4, "{scheme:?}");
        assert_eq!(flock.statistics().unsolved, 0);
    }
}

#[test]
fn no_run_of_a_crowd_overlaps_what_was_not_looked_for() {
    // At 344.5 s others push a boat that far. It would overlap another one by 0.03 cm.
    let p = FlockParameters {
        n_boats: 27,
        pool: Pool::NARROW,
        bw_s: 0.45,
        dt_s: 0.1,
        scheme: Scheme::Moreau,
        ..FlockParameters::preset(Preset::Simulation)
    };
    let mut flock = Flock::new(p, 12035).expect("room");
    flock.advance(345.0, None).expect("finite motion");
    assert!(flock.statistics().worst_overlap_cm <= 1e-4);
    assert_eq!(flock.statistics().unsolved, 0);
}

#[test]
fn a_halved_substep_takes_both_halves() {
    // Two boats meet so fast that a substep is halved, and a third one far away drifts on undisturbed.
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            dt_s: 0.1,
            tolerance_cm: 1e-4,
            ..inert(scheme)
        };
        let mut flock = flock_of(
            &p,
            &[
                ([0.0, 0.0, 0.0], [1500.0, 0.0, 0.0]),
                ([40.0, 3.0, 2.0], [-1500.0, 0.0, 0.0]),
                ([0.0, 400.0, 0.0], [7.0, -3.0, 0.0]),
            ],
        );
        take_substeps(&mut flock, 1);
        assert!(flock.statistics().halved_substeps > 0, "{scheme:?}");
        assert_eq!(flock.time_s(), 0.1, "{scheme:?}");
        let x = flock.poses()[2].position;
        assert_abs_diff_eq!(x.x, 0.7, epsilon = 1e-9);
        assert_abs_diff_eq!(x.y, 399.7, epsilon = 1e-9);
    }
}

#[test]
fn overlaps_that_no_pass_and_no_halving_close_are_counted() {
    // Boats that move by their length and more even in the shortest part of a substep stay entangled here and there.
    let mut counted = 0;
    for speed in [1e3, 3e3, 1e4] {
        let p = FlockParameters {
            n_boats: 27,
            pool: Pool::NARROW,
            bw_s: 2.0,
            dt_s: 1.0,
            speed_cm_s: speed,
            reverse_speed_cm_s: speed,
            ..table_3()
        };
        let mut flock = Flock::new(p, 1).expect("room");
        for _ in 0..20 {
            if flock.advance(1.0, None).is_err() {
                break;
            }
            let now = *flock.statistics();
            // What is met in a substep was left by one before.
            if now.worst_overlap_cm > 1.01e-4 {
                assert!(now.unsolved > 0, "{now:?}");
                counted += 1;
            }
        }
    }
    assert!(counted > 0, "no overlap was left");
}
