//! Walls that share an end are one wall: a boat that slides along them feels their line, not their number.
//!
//! On paper: a straight wall cut into a hundred pieces is the same wall, and so is a circle of many pieces, up to the
//! sagitta R·(1 − cos(π/n)) of each. What lies beyond the end of a piece is nearer to the next one.

use crate::support::{
    R, VELOCITY_SCHEMES, changed, deepest_overlap, disc, disc_at, driven, flock_of, take_substeps,
    wall,
};
use flockenv::FlockParameters;
use flockenv::geometry::Pose;
use flockenv::parameters::{Scheme, Wall};
use std::f64::consts::TAU;

/// Walls from one point to the next.
fn chain(points: impl Iterator<Item = (f64, f64)>) -> Vec<Wall> {
    let points: Vec<_> = points.collect();
    points
        .windows(2)
        .map(|pair| wall(pair[0], pair[1]))
        .collect()
}

/// A straight wall along y = 0, in so many pieces.
fn straight(pieces: u32) -> Vec<Wall> {
    let place = |k: u32| (-10.0 + 300.0 * f64::from(k) / f64::from(pieces), 0.0);
    chain((0..=pieces).map(place))
}

/// A circle in so many pieces, whose middles touch the radius.
fn circle(radius: f64, pieces: u32) -> Vec<Wall> {
    let step = TAU / f64::from(pieces);
    let corner = radius / (0.5 * step).cos();
    let place = |k: u32| {
        let angle = step * f64::from(k % pieces);
        (corner * angle.cos(), corner * angle.sin())
    };
    chain((0..=pieces).map(place))
}

/// The substeps of trainings, and finer ones.
const STEPS: [(f64, f64); 3] = [(0.1, 1e-4), (0.1, f64::INFINITY), (0.02, f64::INFINITY)];

/// Where a boat is after so many seconds.
fn slid(p: &FlockParameters, pose: [f64; 3], seconds: f64) -> Pose {
    let mut flock = flock_of(p, &[(pose, [0.0; 3])]);
    flock.advance(seconds, None).expect("finite motion");
    let deepest = flock.statistics().worst_overlap_cm;
    assert!(deepest < 0.05, "{deepest}");
    flock.poses()[0]
}

fn distance(a: &Pose, b: &Pose) -> f64 {
    (a.position - b.position).norm() + R * (a.heading - b.heading).abs()
}

#[test]
fn a_straight_wall_in_pieces_is_the_whole_wall() {
    for (dt_s, tolerance_cm) in STEPS {
        for scheme in VELOCITY_SCHEMES {
            let along = |pieces| {
                let p = FlockParameters {
                    dt_s,
                    tolerance_cm,
                    walls: straight(pieces),
                    ..driven(scheme)
                };
                slid(&p, [0.0, 9.0, -0.5], 14.0)
            };
            let whole = along(1);
            assert!(whole.position.x > 150.0, "{whole:?}");
            for pieces in [2, 7, 100, 300] {
                let error = distance(&along(pieces), &whole);
                // Leapfrog takes the first substep on each piece for an impact, of which nothing is known before.
                let most = match scheme {
                    Scheme::Leapfrog => 0.05,
                    _ => 1e-12,
                };
                assert!(error < most, "{scheme:?} {dt_s} {pieces}: {error}");
            }
        }
    }
}

#[test]
fn a_ring_in_pieces_is_the_round_wall() {
    for (dt_s, tolerance_cm) in STEPS {
        let base = FlockParameters {
            dt_s,
            tolerance_cm,
            ..driven(Scheme::Leapfrog)
        };
        let rim = changed(base.clone(), |p| p.pool = disc(90.0));
        let post = changed(base.clone(), |p| p.discs = vec![disc_at(0.0, 0.0, 50.0)]);
        for (round, radius, start, seconds) in [
            (rim, 90.0, [80.0, 0.0, 1.2], 14.0),
            (post, 50.0, [56.0, 0.0, 2.0], 5.0),
        ] {
            let pieces = changed(base.clone(), |p| p.walls = circle(radius, 200));
            let error = distance(
                &slid(&round, start, seconds),
                &slid(&pieces, start, seconds),
            );
            assert!(error < 0.5, "{radius} cm, {dt_s} {tolerance_cm}: {error}");
        }
    }
}

#[test]
fn joined_ends_hold_boats_from_everywhere() {
    // A zigzag of sharp corners, hit from above with the bow at many places.
    let corners = [
        (-40.0, 0.0),
        (-20.0, 12.0),
        (0.0, 0.0),
        (20.0, 0.0),
        (30.0, 15.0),
        (50.0, 0.0),
    ];
    for (dt_s, tolerance_cm) in STEPS {
        for k in 0..60 {
            let p = FlockParameters {
                dt_s,
                tolerance_cm,
                walls: chain(corners.into_iter()),
                ..driven(Scheme::Leapfrog)
            };
            let x = -35.0 + 1.3 * f64::from(k);
            let mut flock = flock_of(&p, &[([x, 40.0, -1.55], [0.0; 3])]);
            for _ in 0..60 {
                flock.advance(0.1, None).expect("finite motion");
                let at = flock.poses()[0].position;
                let ends = at.x < -40.0 || at.x > 50.0;
                assert!(ends || at.y > 0.0, "{dt_s} from {x}: {at:?}");
            }
            let deepest = flock.statistics().worst_overlap_cm;
            assert!(deepest < 0.3, "{dt_s} from {x}: {deepest}");
        }
    }
}

/// A boat that slides into a corner of a few degrees may overlap the second wall, which is taken for the first one's
/// continuation.
#[test]
fn an_overlap_at_a_concave_joint_is_stated() {
    let mut deepest = 0.0_f64;
    for (angle_deg, dt_s) in [(2.0_f64, 0.02), (5.0, 0.05), (10.0, 0.1)] {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let p = changed(driven(Scheme::Leapfrog), |p| {
            p.dt_s = dt_s;
            p.walls = chain([(-150.0, 0.0), (0.0, 0.0), (150.0 * cos, 150.0 * sin)].into_iter());
        });
        let mut flock = flock_of(&p, &[([-40.0, R + 0.1, -0.02], [0.0; 3])]);
        let mut found = 0.0_f64;
        for _ in 0..(6.0 / dt_s) as usize {
            take_substeps(&mut flock, 1);
            found = found.max(deepest_overlap(&flock));
        }
        let stated = flock.statistics().worst_overlap_cm;
        assert!((stated - found).abs() < 1e-9, "{stated} {found}");
        deepest = deepest.max(found);
    }
    assert!(deepest > 0.1, "{deepest}");
}
