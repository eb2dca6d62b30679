//! Bad input is a named error before anything changes, and the object is still usable after.
//!
//! On paper: a snapshot taken before a refused call equals the one taken after it, byte for byte.

use crate::support::{bits, changed, driven, flock_of, refused_field, table_3};
use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::{Scheme, Solver, Target};
use flockenv::{Flock, FlockError, FlockParameters};

#[test]
fn a_bad_state_changes_nothing() {
    let p = changed(table_3(), |p| p.n_boats = 2);
    let mut flock = Flock::new(p, 1).expect("room");
    flock.advance(1.0, None).expect("finite motion");
    let before = flock.snapshot();
    let (good, rest) = (flock.poses().to_vec(), vec![Velocity::default(); 2]);
    let nan_pose = vec![good[0], Pose::new(f64::NAN, 0.0, 0.0)];
    let inf_heading = vec![Pose::new(120.0, 0.0, f64::INFINITY), good[1]];
    let far = vec![good[0], Pose::new(1e10, 0.0, 0.0)];
    let nan_velocity = vec![rest[0], Velocity::new(0.0, f64::NAN, 0.0)];
    let overlapping = vec![good[0], good[0]];
    let in_the_wall = vec![good[0], Pose::new(178.0, 0.0, 0.0)];
    let on_the_obstacle = vec![good[0], Pose::new(-100.0, 0.0, 1.0)];
    let mut refuse = |poses: &[Pose], velocities: &[Velocity], time: f64| {
        let error = flock.set_state(poses, velocities, time, false).err();
        assert!(flock.snapshot() == before);
        error.expect("an error")
    };
    let shape = |error| match error {
        FlockError::Shape { field, .. } => field,
        other => panic!("{other:?}"),
    };
    assert_eq!(shape(refuse(&good[..1], &rest, 0.0)), "pose");
    assert_eq!(shape(refuse(&good, &rest[..1], 0.0)), "velocity");
    let number = |error| match error {
        FlockError::Parameter { field, .. } => field,
        other => panic!("{other:?}"),
    };
    for poses in [nan_pose, inf_heading, far] {
        assert_eq!(number(refuse(&poses, &rest, 0.0)), "pose");
    }
    assert_eq!(number(refuse(&good, &nan_velocity, 0.0)), "velocity");
    for time in [-1.0, f64::NAN, f64::INFINITY, 2e9] {
        assert_eq!(number(refuse(&good, &rest, time)), "time_s");
    }
    for (poses, what) in [
        (overlapping, "boats 0 and 1"),
        (in_the_wall, "boat 1 and the outer wall"),
        (on_the_obstacle, "boat 1 and the inner wall"),
    ] {
        match refuse(&poses, &rest, 0.0) {
            FlockError::Overlap {
                what: found,
                overlap_cm,
            } => {
                assert_eq!(found, what);
                assert!(overlap_cm > 0.0);
            }
            other => panic!("{other:?}"),
        }
    }
    flock.advance(1.0, None).expect("still usable");
}

#[test]
fn bad_durations_and_rudders_change_nothing() {
    let p = changed(table_3(), |p| p.n_leaders = 2);
    let mut flock = Flock::new(p, 1).expect("room");
    let before = flock.snapshot();
    for duration in [-1.0, f64::NAN, f64::INFINITY, 2e9] {
        assert_eq!(refused_field(flock.advance(duration, None)), "seconds");
    }
    for rudder in [
        &[1.01, 0.0][..],
        &[0.0, -1.5],
        &[f64::NAN, 0.0],
        &[0.0],
        &[0.0; 3],
        &[],
    ] {
        assert_eq!(refused_field(flock.advance(0.1, Some(rudder))), "rudder");
    }
    assert!(flock.snapshot() == before);
    flock
        .advance(0.1, Some(&[1.0, -1.0]))
        .expect("the limits are allowed");
}

#[test]
fn corrupt_and_foreign_snapshots_change_nothing() {
    let p = FlockParameters {
        n_boats: 6,
        n_leaders: 1,
        ..table_3()
    };
    let mut flock = Flock::new(p.clone(), 1).expect("room");
    flock.advance(1.0, Some(&[0.2])).expect("finite motion");
    let bytes = flock.snapshot();
    let mut other = Flock::new(p.clone(), 2).expect("room");
    other.advance(0.3, None).expect("finite motion");
    let before = other.snapshot();
    let mut refuse = |bytes: &[u8]| {
        let result = other.restore(bytes, None);
        assert!(matches!(result, Err(FlockError::Snapshot(_))), "{result:?}");
        assert!(other.snapshot() == before);
    };
    for length in 0..bytes.len() {
        refuse(&bytes[..length]);
    }
    for place in 0..bytes.len() {
        let mut harmed = bytes.clone();
        harmed[place] ^= 1 << (place % 8);
        refuse(&harmed);
    }
    let mut longer = bytes.clone();
    longer.push(0);
    refuse(&longer);
    refuse(b"not a snapshot at all, but long enough to hold a header");
    // Whole and unharmed, but of another scene.
    for change in [
        (|p| p.bw_s = 0.31) as fn(&mut FlockParameters),
        |p| p.n_boats = 7,
        |p| p.n_leaders = 0,
        |p| p.scheme = Scheme::Moreau,
        |p| p.dt_s = 0.01,
    ] {
        let other_scene = Flock::new(changed(p.clone(), change), 1).expect("room");
        refuse(&other_scene.snapshot());
    }
    other.advance(0.3, None).expect("still usable");
    // Another target is no other scene.
    let mut turned = Flock::new(p, 3).expect("room");
    turned.set_target(Target::CounterClockwise).unwrap();
    turned.restore(&bytes, None).expect("the same scene");
    assert_eq!(bits(&turned), bits(&flock));
    assert_eq!(turned.parameters().target, Target::Clockwise.into());
}

/// Constants so wild that spins leave the range of numbers.
fn exploding(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        c0: 1e6,
        c1: 0.0,
        c2: 1e6,
        c3: 0.0,
        speed_cm_s: 1e6,
        turning_bias: 1.0,
        dt_s: 0.1,
        ..driven(scheme)
    }
}

/// Boats in a row, touching, so that contacts are solved while numbers explode.
fn explode(scheme: Scheme, solver: Solver, n: u32) {
    let states: Vec<_> = (0..n)
        .map(|i| ([15.0 * f64::from(i), 0.0, 0.0], [0.0, 0.0, 9.0]))
        .collect();
    let p = changed(exploding(scheme), |p| p.solver = solver);
    let mut flock = flock_of(&p, &states);
    let before = flock.snapshot();
    let result = flock.advance(500.0, None);
    assert!(
        matches!(result, Err(FlockError::Solver(_))),
        "{scheme:?} {solver:?} {n}"
    );
    assert!(flock.snapshot() == before);
}

#[test]
fn motion_that_leaves_the_finite_numbers_is_an_error_and_undone() {
    for scheme in [Scheme::Moreau, Scheme::Paper] {
        for n in [1, 3] {
            for solver in Solver::ALL.iter().copied() {
                explode(scheme, solver, n);
            }
        }
    }
}

#[test]
#[ignore = "half a minute: at such speeds every pair of boats is a contact"]
fn motion_of_many_boats_that_leaves_the_finite_numbers_is_an_error_and_undone() {
    // More than 64 boats are sorted into cells, whose number must stay finite.
    explode(Scheme::Moreau, Solver::BlockPivoting, 70);
    explode(Scheme::Paper, Solver::BlockPivoting, 70);
}
