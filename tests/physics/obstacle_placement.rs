//! Boats start beside obstacles, and what would put one into the other is a named error.

use crate::obstacles::arena;
use crate::support::{
    OPEN_WATER, deepest_overlap, disc, disc_at, flock_of, inert, refused_field, table_3, wall,
};
use flockenv::flock::{Change, State};
use flockenv::geometry::Pose;
use flockenv::parameters::{Disc, Noise, Scheme, Wall};
use flockenv::{Flock, FlockError, FlockParameters};

#[test]
fn boats_never_start_inside() {
    for seed in 0..40 {
        let flock = Flock::new(arena(Scheme::Leapfrog, Noise::White), seed).expect("room");
        assert!(deepest_overlap(&flock) == 0.0, "{seed}");
    }
    // So many that they are grown into their places.
    let p = FlockParameters {
        n_boats: 130,
        n_leaders: 0,
        ..arena(Scheme::Leapfrog, Noise::White)
    };
    for seed in 0..3 {
        let flock = Flock::new(p.clone(), seed).expect("room");
        assert!(deepest_overlap(&flock) == 0.0, "{seed}");
    }
}

/// Walls 9 cm apart in both directions that reach so far from the center.
fn grid(reach_cm: f64) -> impl Iterator<Item = Wall> {
    let places = (-7..=7).map(|i| 9.0 * f64::from(i));
    places.flat_map(move |at| {
        [
            wall((at, -reach_cm), (at, reach_cm)),
            wall((-reach_cm, at), (reach_cm, at)),
        ]
    })
}

#[test]
fn boats_start_near_the_center_of_open_water_whatever_stands_there() {
    // Twenty boats without obstacles start within sqrt(20·25·128.5 cm²/π) = 143 cm. A disc about the center moves them
    // outward, and one far away not at all; the room between two discs of a kilometer is 20 cm wide at the center.
    let scenes = [
        (vec![disc_at(0.0, 0.0, 500.0)], vec![], 500.0, 530.0),
        (vec![disc_at(0.0, 0.0, 1e5)], vec![], 1e5, 1.001e5),
        (vec![disc_at(3e5, 0.0, 1e5)], vec![], 0.0, 143.0),
        (vec![disc_at(-1e5, 0.0, 1e5)], vec![], 0.0, 250.0),
        (
            vec![disc_at(-1.0001e5, 0.0, 1e5), disc_at(1.0001e5, 0.0, 1e5)],
            vec![],
            0.0,
            3e3,
        ),
        (vec![], grid(63.0).collect(), 60.0, 190.0),
    ];
    for (number, (discs, walls, nearest, farthest)) in scenes.into_iter().enumerate() {
        let p = FlockParameters {
            pool: OPEN_WATER,
            n_boats: 20,
            discs,
            walls,
            ..table_3()
        };
        for seed in 0..5 {
            let flock = Flock::new(p.clone(), seed).expect("water without end");
            assert!(deepest_overlap(&flock) == 0.0);
            for pose in flock.poses() {
                let distance = pose.position.norm();
                assert!(
                    (nearest..farthest).contains(&distance),
                    "scene {number}: {distance}"
                );
            }
        }
    }
}

#[test]
fn no_room_is_a_named_error() {
    let crowd = |n_boats, discs, walls| FlockParameters {
        n_boats,
        discs,
        walls,
        pool: disc(60.0),
        ..table_3()
    };
    // A disc over the whole pool, or one that leaves a ring narrower than a boat.
    for radius in [100.0, 51.0] {
        let p = crowd(1, vec![disc_at(0.0, 0.0, radius)], vec![]);
        let none = FlockError::Placement {
            requested: 1,
            placed: 0,
        };
        assert_eq!(Flock::new(p, 1).err(), Some(none), "{radius}");
    }
    // Walls 9 cm apart leave no place for a boat of 10 cm. Those that miss the pool are no walls of it.
    let through = |w: &Wall| w.x0_cm.abs().min(w.y0_cm.abs()) < 60.0;
    let error = Flock::new(crowd(2, vec![], grid(70.0).filter(through).collect()), 1).err();
    assert!(matches!(error, Some(FlockError::Placement { .. })));
    // Without the discs there is room for 50 boats, with them there is not.
    assert!(Flock::new(crowd(50, vec![], vec![]), 1).is_ok());
    let posts = [-30.0, 30.0].map(|x| disc_at(x, 0.0, 28.0)).to_vec();
    let error = Flock::new(crowd(50, posts, vec![]), 1).err();
    assert!(matches!(
        error,
        Some(FlockError::Placement { requested: 50, .. })
    ));
}

#[test]
fn a_state_inside_an_obstacle_is_refused() {
    let p = FlockParameters {
        n_boats: 1,
        discs: vec![disc_at(30.0, 0.0, 10.0)],
        walls: vec![wall((-30.0, -20.0), (-30.0, 20.0))],
        ..inert(Scheme::Leapfrog)
    };
    for (x, obstacle) in [(30.0, "disc 0"), (-30.0, "wall 0"), (-35.0, "wall 0")] {
        let state = State {
            poses: vec![Pose::new(x, 0.0, 0.0)],
            velocities: vec![Default::default()],
            time_s: 0.0,
            allow_overlap: false,
        };
        match Flock::from_state(p.clone(), 1, &state) {
            Err(FlockError::Overlap { what, .. }) => {
                assert_eq!(what, format!("boat 0 and {obstacle}"));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn an_obstacle_that_appears_on_a_boat_is_refused() {
    let mut flock = flock_of(
        &inert(Scheme::Leapfrog),
        &[([5.0, 0.0, 0.0], [1.0, 0.0, 0.0])],
    );
    let before = flock.snapshot();
    let with = |discs| {
        let p = flock.parameters().clone();
        Change::Parameters(Box::new(FlockParameters { discs, ..p }))
    };
    let (on_it, beside) = (
        with(vec![disc_at(0.0, 0.0, 9.0)]),
        with(vec![disc_at(0.0, 40.0, 9.0)]),
    );
    assert!(matches!(
        flock.change(&on_it),
        Err(FlockError::Overlap { .. })
    ));
    assert_eq!(flock.snapshot(), before);
    flock.change(&beside).expect("no overlap");
    assert_eq!(flock.parameters().discs.len(), 1);
}

#[test]
fn bad_obstacles_are_named() {
    let with = |discs: Vec<Disc>, walls: Vec<Wall>| {
        FlockParameters {
            discs,
            walls,
            ..table_3()
        }
        .check()
    };
    // The pool's radii are 180 and 97 cm.
    for bad in [
        disc_at(f64::NAN, 0.0, 5.0),
        disc_at(0.0, f64::INFINITY, 5.0),
        disc_at(140.0, 0.0, -1.0),
        disc_at(140.0, 0.0, 0.0),
        disc_at(140.0, 0.0, f64::NAN),
        disc_at(140.0, 0.0, 2e6),
        disc_at(186.0, 0.0, 5.0),
        disc_at(0.0, 10.0, 50.0),
    ] {
        let field = refused_field(with(vec![disc_at(140.0, 0.0, 5.0), bad], vec![]));
        assert_eq!(field, "discs", "{bad:?}");
    }
    for bad in [
        wall((f64::NAN, 0.0), (140.0, 0.0)),
        wall((0.0, 0.0), (f64::NEG_INFINITY, 0.0)),
        wall((140.0, 1.0), (140.0, 1.0)),
        wall((140.0, 1.0), (140.0, 1.0001)),
        wall((200.0, -50.0), (200.0, 50.0)),
        wall((-40.0, 0.0), (40.0, 0.0)),
    ] {
        assert_eq!(refused_field(with(vec![], vec![bad])), "walls", "{bad:?}");
    }
    assert_eq!(
        refused_field(with(vec![disc_at(140.0, 0.0, 1.0); 1001], vec![])),
        "discs"
    );
    assert_eq!(
        refused_field(with(vec![], vec![wall((100.0, 0.0), (140.0, 0.0)); 1001])),
        "walls"
    );
    // Reaching over the rim, the inner wall and each other is no mistake.
    let over = vec![
        wall((0.0, 0.0), (200.0, 0.0)),
        wall((140.0, -9.0), (140.0, 9.0)),
    ];
    assert!(
        with(
            vec![disc_at(181.0, 0.0, 5.0), disc_at(0.0, 95.0, 5.0)],
            over
        )
        .is_ok()
    );
}
