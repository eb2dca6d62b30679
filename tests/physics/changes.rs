//! A change of parameters moves boats only if the water changes, and then keeps them between the walls.
//!
//! On paper: a boat at a relative distance s between walls at R_in and R_out lies at R_in + s (R_out − R_in).

use crate::support::{annulus, changed, crowded, disc, flock_of, inert};
use flockenv::flock::{Change, Recorder, Sampling};
use flockenv::parameters::Scheme;
use flockenv::{Flock, FlockError, FlockParameters};

fn to(parameters: &FlockParameters) -> Change {
    Change::Parameters(Box::new(parameters.clone()))
}

#[test]
fn boats_that_no_random_placement_fits_take_new_parameters() {
    let snug = FlockParameters {
        boat_shape: 0.0,
        pool: disc(5.2),
        ..inert(Scheme::Leapfrog)
    };
    assert!(matches!(
        Flock::new(snug.clone(), 1),
        Err(FlockError::Placement { .. })
    ));
    let mut flock = crowded(&snug, &[([0.0, 0.0, 1.0], [0.0; 3])]);
    let poses = flock.poses().to_vec();
    let noisy = changed(snug, |p| p.c4 = 1.0);
    flock.change(&to(&noisy)).expect("the same water");
    assert_eq!(flock.parameters(), &noisy);
    assert_eq!(flock.poses(), poses);
    let smaller = changed(noisy.clone(), |p| p.pool = disc(5.1));
    assert!(matches!(
        flock.change(&to(&smaller)),
        Err(FlockError::Placement { .. })
    ));
    assert_eq!(flock.parameters(), &noisy);
}

#[test]
fn a_boat_at_the_center_moves_into_another_pool() {
    let p = changed(inert(Scheme::Leapfrog), |p| p.pool = disc(60.0));
    let mut flock = flock_of(&p, &[([0.0, 0.0, 1.0], [0.0; 3])]);
    for (pool, radius) in [(disc(80.0), 0.0), (annulus(90.0, 30.0), 30.0)] {
        let other = changed(p.clone(), |p| p.pool = pool);
        flock.change(&to(&other)).expect("room");
        let pose = flock.poses()[0];
        assert_eq!((pose.position.x, pose.position.y), (radius, 0.0));
        assert_eq!(pose.heading, 1.0);
    }
}

#[test]
fn a_stop_after_any_amount_of_work_is_no_later_than_the_end() {
    let mut flock = flock_of(&inert(Scheme::Leapfrog), &[([0.0; 3], [0.0; 3])]);
    flock.advance(1.0, None).expect("rest");
    let end = 2 * flock.time();
    for work in [1 << 40, u64::MAX / 3, u64::MAX] {
        assert_eq!(flock.stop_towards(end, work), end);
    }
}

#[test]
fn a_run_keeps_its_numbers_of_boats_and_leaders() {
    let p = inert(Scheme::Leapfrog);
    let flock = flock_of(&p, &[([0.0; 3], [0.0; 3]), ([30.0, 0.0, 0.0], [0.0; 3])]);
    let run = |n_boats, n_leaders| {
        let other = changed(flock.parameters().clone(), |p| {
            (p.n_boats, p.n_leaders, p.c4) = (n_boats, n_leaders, 1.0);
        });
        let sampling = Sampling::new(1.0, 10.0).expect("a second");
        let recorder = Recorder::<f64>::new(flock.clone(), sampling).expect("memory");
        recorder.with_changes(vec![(0, to(&other))])
    };
    assert!(run(2, flock.parameters().n_leaders).is_ok());
    for (n_boats, n_leaders) in [(3, 0), (2, 2)] {
        let refused = run(n_boats, n_leaders).expect_err("other numbers");
        assert!(refused.to_string().contains("n_boats or n_leaders"));
    }
}
