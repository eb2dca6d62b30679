//! No step returns a boat outside the water: it fails and changes nothing, whatever the constants.
//!
//! On paper: noise of 1000 rad/s^1.5 turns a hull by some 30 rad in a substep of 0.1 s, in which a contact that is linear
//! in the motion holds nothing.

use crate::support::{bits, disc_at, table_3};
use flockenv::geometry::Pose;
use flockenv::parameters::{Physics, Pool};
use flockenv::{Flock, FlockError, FlockParameters};

/// A flock stepped as for training, with constants that no boat has.
fn absurd(change: impl FnOnce(&mut FlockParameters)) -> FlockParameters {
    let (dt_s, tolerance_cm) = Physics::Training.stepping().expect("a step of its own");
    let mut p = FlockParameters {
        n_boats: 27,
        n_leaders: 3,
        pool: Pool::NARROW,
        bw_s: 0.45,
        dt_s,
        tolerance_cm,
        ..table_3()
    };
    change(&mut p);
    p
}

fn is_in_water(p: &FlockParameters, pose: &Pose) -> bool {
    let distance = pose.position.norm();
    let is_dry = |disc: &flockenv::parameters::Disc| {
        (pose.position.x - disc.x_cm).hypot(pose.position.y - disc.y_cm) < disc.radius_cm
    };
    (p.pool.inner_radius_cm..=p.pool.outer_radius_cm).contains(&distance)
        && !p.discs.iter().any(is_dry)
}

/// How many of so many control steps fail.
fn failures(p: &FlockParameters, steps: usize) -> usize {
    let mut failed = 0;
    for seed in 0..4 {
        let mut flock = Flock::new(p.clone(), seed).expect("room");
        for step in 0..steps {
            let (before, statistics) = (bits(&flock), *flock.statistics());
            let rudder = [1.0, -1.0, if step % 2 == 0 { 1.0 } else { -1.0 }];
            match flock.advance(0.1, Some(&rudder)) {
                Ok(()) => {}
                Err(FlockError::Solver(_)) => {
                    assert_eq!(bits(&flock), before);
                    assert_eq!(*flock.statistics(), statistics);
                    failed += 1;
                    break;
                }
                other => panic!("{other:?}"),
            }
            for pose in flock.poses() {
                assert!(is_in_water(p, pose), "{seed} {step}: {pose:?}");
            }
        }
    }
    failed
}

#[test]
fn absurd_noise_leaves_boats_in_the_water_or_fails() {
    for tolerance_cm in [1e-4, f64::INFINITY] {
        let p = absurd(|p| (p.c4, p.tolerance_cm) = (1000.0, tolerance_cm));
        let failed = failures(&p, 300);
        // With a tolerance, substeps are halved until no contact is missed.
        assert_eq!(failed > 0, tolerance_cm == f64::INFINITY, "{failed}");
    }
}

#[test]
fn absurd_rudders_leave_boats_in_the_water_or_fail() {
    failures(
        &absurd(|p| (p.c2, p.tolerance_cm) = (1000.0, f64::INFINITY)),
        300,
    );
    failures(&absurd(|p| p.c2 = 1000.0), 300);
}

#[test]
fn a_disc_is_no_water() {
    let p = absurd(|p| {
        (p.c4, p.tolerance_cm) = (1000.0, f64::INFINITY);
        p.discs = vec![disc_at(70.0, 0.0, 12.0), disc_at(-70.0, 0.0, 12.0)];
        p.n_boats = 15;
    });
    failures(&p, 300);
}
