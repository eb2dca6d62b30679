//! Gates and channels of walls and discs: too narrow, wide enough, and exactly as wide as the hull.
//!
//! On paper: as `obstacle_hard_cases`.

use crate::obstacle_hard_cases::{PUSH, assert_wedged};
use crate::support::{
    R, SCHEMES, VELOCITY_SCHEMES, assert_near, assert_solved, changed, crowded, disc_at, driven,
    wall,
};
use flockenv::FlockParameters;

#[test]
fn a_boat_before_a_gate_that_is_too_narrow() {
    // Two walls' ends, or two discs of radius d, leave 2·g < 2·r between them: the bow's disc rests where its center
    // is r + d from both.
    for scheme in VELOCITY_SCHEMES {
        for (g, d) in [
            (4.5_f64, 0.0),
            (1.0, 0.0),
            (4.5, 7.0),
            (0.0, 7.0),
            (4.9, 0.01),
        ] {
            let (side, reach) = (g + d, R + d);
            let before = (reach * reach - side * side).sqrt();
            let mut p = driven(scheme);
            if d == 0.0 {
                p.walls = vec![wall((0.0, g), (0.0, 60.0)), wall((0.0, -60.0), (0.0, -g))];
            } else {
                p.discs = vec![disc_at(0.0, side, d), disc_at(0.0, -side, d)];
            }
            let each = PUSH * reach / (2.0 * before);
            assert_wedged(&p, (-before, 0.0), each, 2, &format!("{scheme:?} {g} {d}"));
        }
    }
}

#[test]
fn a_gate_wider_than_the_boat_is_no_hindrance() {
    // Half a millimeter on each side.
    for scheme in SCHEMES {
        let (half, depth) = (R + 0.05, 8.0);
        let gates = [
            FlockParameters {
                walls: vec![
                    wall((0.0, half), (0.0, 60.0)),
                    wall((0.0, -half), (0.0, -60.0)),
                ],
                ..driven(scheme)
            },
            FlockParameters {
                discs: [1.0, -1.0]
                    .map(|s| disc_at(0.0, s * (half + depth), depth))
                    .to_vec(),
                ..driven(scheme)
            },
        ];
        for p in gates {
            let start = [([-40.0, 0.0, 0.0], [15.0, 0.0, 0.0])];
            let (mut through, mut free) = (crowded(&p, &start), crowded(&driven(scheme), &start));
            through.advance(6.0, None).expect("finite motion");
            free.advance(6.0, None).expect("finite motion");
            let [found, expected] = [&through, &free].map(|flock| flock.poses()[0].position.x);
            assert_near(found, expected, 1e-9, scheme);
            assert!(found > 40.0, "{scheme:?} {found}");
        }
    }
}

#[test]
fn a_channel_exactly_as_wide_as_the_hull_lets_it_slide() {
    // Four contacts and no room: the boat speeds up as in open water, and nothing turns it.
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            walls: vec![
                wall((-100.0, R), (100.0, R)),
                wall((100.0, -R), (-100.0, -R)),
            ],
            c4: 0.1,
            ..driven(scheme)
        };
        let start = [([-60.0, 0.0, 0.0], [0.0; 3])];
        let mut inside = crowded(&p, &start);
        let mut free = crowded(&changed(driven(scheme), |p| p.c4 = 0.0), &start);
        inside.advance(5.0, None).expect("finite motion");
        free.advance(5.0, None).expect("finite motion");
        let (found, expected) = (inside.poses()[0], free.poses()[0]);
        assert_near(found.position.x, expected.position.x, 1e-4, scheme);
        assert_near(found.position.y, 0.0, 1e-9, scheme);
        assert_near(found.heading, 0.0, 1e-9, scheme);
        assert_solved(&inside);
    }
}
