//! The work of a substep is bounded, and a long run can be ended between two substeps.
//!
//! On paper: n boats have 3·n ways to move, so that no more than 3·n contacts determine what they do; a set of more is
//! not worth a factor, whose rows would all be as long as the set. Where boats move by many lengths in a substep, every
//! pair is in reach, n²/2 of them: the substep is cut until a boat reaches a few.

use crate::support::{annulus, bits, changed, driven, table_3};
use flockenv::contact::Statistics;
use flockenv::geometry::{Pose, Vec2, Velocity};
use flockenv::integrator::Steering;
use flockenv::parameters::Scheme;
use flockenv::{Flock, FlockError, FlockParameters};
use std::sync::atomic::{AtomicU64, Ordering};

fn crowd(n_boats: usize) -> FlockParameters {
    changed(table_3(), |p| p.n_boats = n_boats)
}

/// What so many steps of `dt_s` did.
fn steps(p: &FlockParameters, count: u32) -> Statistics {
    let mut flock = Flock::new(p.clone(), 1).expect("room");
    for _ in 0..count {
        flock
            .advance(p.dt_s, None)
            .expect("contacts that can be solved");
    }
    *flock.statistics()
}

#[test]
fn boats_far_too_fast_for_their_substep_cost_about_what_others_do() {
    let fast = FlockParameters {
        speed_cm_s: 1e5,
        c1: 6.0,
        ..crowd(300)
    };
    let noisy = changed(crowd(300), |p| p.c4 = 1000.0);
    let long = FlockParameters {
        dt_s: 1.0,
        speed_cm_s: 100.0,
        ..crowd(300)
    };
    for p in [fast, noisy, long] {
        // Tried again and again for the tolerance, the contacts cost a few times as much.
        let done = steps(&p, 5);
        assert!(done.factored_rows < 600_000, "{done:?}");
        let linearized = changed(p, |p| p.tolerance_cm = f64::INFINITY);
        let done = steps(&linearized, 5);
        // A single round on all contacts that close would compute a thousand rows of a thousand entries and more.
        assert!(done.factored_rows < 150_000, "{done:?}");
        assert!(done.most_factor_entries < 10_000, "{done:?}");
        // At most two contacts for each of 32 pairs a boat, and three with the walls.
        assert!(done.contacts <= 67 * 300 * done.substeps, "{done:?}");
        assert!(done.worst_residual_cm_s < 1e-10, "{done:?}");
        assert_eq!(done.unsolved, 0, "{done:?}");
    }
}

#[test]
fn contacts_that_are_too_much_work_are_an_error_and_change_nothing() {
    // On one spot, each boat overlaps all others: 45 000 contacts that have to share what pushes them apart.
    let n = 300;
    let mut flock = Flock::new(crowd(n), 2).expect("room");
    flock.advance(0.1, None).expect("finite motion");
    let pose = |boat: usize| Pose {
        position: Vec2::new(140.0 + 1e-3 * boat as f64, 0.0),
        heading: 0.01 * boat as f64,
    };
    let poses: Vec<_> = (0..n).map(pose).collect();
    let at_rest = vec![Velocity::default(); n];
    flock
        .set_state(&poses, &at_rest, 0.0, true)
        .expect("overlaps that are allowed");
    let before = (bits(&flock), flock.time(), flock.snapshot());
    let failed = flock.advance(0.02, None);
    assert!(matches!(failed, Err(FlockError::Solver(_))), "{failed:?}");
    assert!((bits(&flock), flock.time(), flock.snapshot()) == before);
    // It is not left over: the next boats have nothing to do with these.
    let apart = Flock::new(crowd(n), 2).expect("room");
    flock
        .set_state(apart.poses(), &at_rest, 0.0, false)
        .expect("no overlap");
    flock
        .advance(0.02, None)
        .expect("contacts that can be solved");
}

/// Advances substep by substep until one is too much work, and returns what it took, if there is one.
fn first_that_is_too_much(p: &FlockParameters, most: u32) -> Option<u64> {
    let mut flock = Flock::new(p.clone(), 1).expect("room");
    (0..most).find_map(|_| {
        let before = (bits(&flock), flock.time(), flock.snapshot());
        let work = flock.contact_work();
        let failed = flock.advance(p.dt_s, None).err()?;
        assert!(matches!(failed, FlockError::Solver(_)), "{failed}");
        assert!((bits(&flock), flock.time(), flock.snapshot()) == before);
        Some(flock.contact_work() - work)
    })
}

#[test]
fn all_that_is_tried_for_a_substep_shares_one_room_of_work() {
    // 1e9 multiplications and 5e5 a boat, and the last round of what is given up.
    let most = 1_200_000_000;
    // Backing boats turn by thousands of rad/s: pushed apart, cut and solved again and again.
    let backing = FlockParameters {
        fw_s: 0.1,
        nop1_s: 0.0,
        c3: 1e6,
        ..crowd(300)
    };
    let trained = FlockParameters {
        dt_s: 0.05,
        tolerance_cm: 1e-6,
        ..backing.clone()
    };
    let noisy = FlockParameters {
        c4: 1e6,
        ..crowd(300)
    };
    for p in [backing, trained, noisy] {
        let work = first_that_is_too_much(&p, 30).expect("contacts that are too much work");
        assert!((500_000_000..most).contains(&work), "{work}");
    }
    // What the page and trainings do is far from it.
    for n_boats in [27, 300] {
        let p = FlockParameters {
            dt_s: 0.05,
            tolerance_cm: 1e-6,
            bw_s: 1.0,
            ..crowd(n_boats)
        };
        let mut flock = Flock::new(p, 1).expect("room");
        flock
            .advance(10.0, None)
            .expect("contacts that can be solved");
        assert!(flock.contact_work() < most / 10);
    }
}

#[test]
fn packed_flocks_are_far_from_the_bound() {
    // A ring of 3 000 boats that leave a tenth of it free, half a minute long without a pause.
    let p = FlockParameters {
        pool: annulus(440.0, 100.0),
        bw_s: 0.0,
        dt_s: 0.1,
        ..crowd(3000)
    };
    let done = steps(&p, 30);
    assert_eq!(done.unsolved, 0, "{done:?}");
    assert!(done.substeps >= 30, "{done:?}");
}

#[test]
fn a_long_run_can_be_ended_between_substeps_and_nothing_has_changed() {
    for (p, duration_s) in [(crowd(300), 60.0), (driven(Scheme::Leapfrog), 3600.0)] {
        let mut flock = Flock::new(p, 3).expect("room");
        flock.advance(1.0, None).expect("finite motion");
        let before = (bits(&flock), flock.time(), flock.snapshot());
        let end = flock.end_of(duration_s).expect("a duration");
        let asked = AtomicU64::new(0);
        let keep_going = || asked.fetch_add(1, Ordering::Relaxed) < 2;
        let ended = flock.advance_to(&keep_going, end, Steering::Law);
        assert_eq!(ended, Err(FlockError::Interrupted));
        assert_eq!(asked.into_inner(), 3);
        assert!((bits(&flock), flock.time(), flock.snapshot()) == before);
    }
}

#[test]
fn costly_substeps_are_asked_about_one_by_one() {
    let p = FlockParameters {
        speed_cm_s: 1e5,
        c1: 6.0,
        ..crowd(300)
    };
    let mut flock = Flock::new(p, 1).expect("room");
    let asked = AtomicU64::new(0);
    let keep_going = || asked.fetch_add(1, Ordering::Relaxed) < u64::MAX;
    let end = flock.end_of(0.1).expect("a duration");
    flock
        .advance_to(&keep_going, end, Steering::Law)
        .expect("contacts that can be solved");
    let done = flock.statistics();
    let most = done.contacts + done.factored_rows + 300 * done.substeps;
    let asked = asked.into_inner();
    assert!(
        asked >= 5 && asked >= most / 60_000,
        "{asked} of {most}, {done:?}"
    );
}
