//! Gaps between boats and obstacles: on paper beside a wall, at its end and at a disc; and against their own slopes
//! and the distance of segments at random poses.

use crate::support::{
    H, R, cases, core, disc_at, displaced, near, pose, segment_distance, wall, wall_ends,
};
use flockenv::geometry::{Feature, Gap, Hull, HullPose, Obstacle, Pose, Vec2};
use flockenv::parameters::Wall;
use proptest::prelude::*;

const HULL: Hull = Hull {
    radius: R,
    half_length: H,
};

fn gaps(boat: &Pose, obstacle: &Obstacle, margin: f64) -> Vec<(Feature, Gap)> {
    let mut found = Vec::new();
    obstacle.gaps(&HullPose::new(boat), HULL, margin, &mut |feature, gap| {
        found.push((feature, gap));
    });
    found
}

#[test]
fn gaps_known_on_paper() {
    // Flat along a wall 1 cm away: one contact for each end, pushed straight off it, with opposite arms.
    let along = Obstacle::from(&wall((-50.0, -6.0), (50.0, -6.0)));
    let found = gaps(&Pose::new(0.0, 0.0, 0.0), &along, 2.0);
    assert_eq!(found.len(), 2);
    for ((feature, gap), side) in found.iter().zip([-1.0, 1.0]) {
        assert_eq!(*feature as u8, u8::from(side > 0.0));
        assert!(near(gap.gap, 1.0) && near(gap.normal.y, 1.0) && near(gap.normal.x, 0.0));
        assert!(near(gap.along, side * H) && near(gap.arm_i, side * H));
        assert!(gap.bend == 0.0 && gap.arm_j == 0.0);
    }
    // The wall's end at the flank: one contact, whichever way the wall is drawn and the boat leans.
    for ends in [
        wall((1.5, -6.0), (1.5, -90.0)),
        wall((1.5, -90.0), (1.5, -6.0)),
    ] {
        for heading in [0.0, 1e-9, -1e-9] {
            let found = gaps(&Pose::new(0.0, 0.0, heading), &Obstacle::from(&ends), 2.0);
            assert_eq!(found.len(), 1, "{heading}");
            let gap = found[0].1;
            assert!((gap.gap - 1.0).abs() < 1e-8 && (gap.arm_i - 1.5).abs() < 1e-8);
            assert!((gap.bend + 6.0).abs() < 1e-8);
        }
    }
    // Bow on to the end of a wall, and to a disc.
    let ahead = Pose::new(-8.5, 0.0, 0.0);
    for obstacle in [
        Obstacle::from(&wall((0.0, 0.0), (40.0, 0.0))),
        Obstacle::from(&disc_at(30.0, 0.0, 30.0)),
    ] {
        let found = gaps(&ahead, &obstacle, 2.0);
        assert_eq!(found.len(), 1);
        let gap = found[0].1;
        assert!(near(gap.gap, 1.0) && near(gap.normal.x, -1.0) && near(gap.arm_i, 0.0));
        assert!(near(gap.along, H) && gap.bend == 0.0);
    }
    // A core across a wall counts as crossed: back over the wall by the shorter end, and by r more.
    let found = gaps(
        &Pose::new(-1.0, 0.0, 0.0),
        &Obstacle::from(&wall((0.0, -9.0), (0.0, 9.0))),
        2.0,
    );
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, Feature::Crossed);
    assert!(near(found[0].1.gap, -(H - 1.0) - R) && near(found[0].1.normal.x, -1.0));
}

#[test]
fn distances_known_on_paper() {
    let ring = Obstacle::from(&disc_at(10.0, 0.0, 4.0));
    assert!(near(ring.distance(Vec2::new(10.0, 7.0)), 3.0));
    assert!(near(ring.distance(Vec2::new(10.0, 1.0)), -3.0));
    let beam = Obstacle::from(&wall((0.0, 0.0), (10.0, 0.0)));
    assert!(near(beam.distance(Vec2::new(4.0, -2.0)), 2.0));
    assert!(near(beam.distance(Vec2::new(13.0, 4.0)), 5.0));
}

fn slope(gap: &Gap, direction: usize) -> f64 {
    [gap.normal.x, gap.normal.y, gap.arm_i][direction]
}

/// Walls shorter and longer than the hull.
fn any_wall() -> impl Strategy<Value = Wall> {
    let end = || (-40.0..40.0_f64, -40.0..40.0_f64);
    let long = (end(), end()).prop_map(|(a, b)| wall(a, b));
    let short = ((-5.0..5.0_f64, -5.0..5.0_f64), 0.01..4.0_f64, 0.0..7.0_f64)
        .prop_map(|((x, y), l, a)| wall((x, y), (x + l * a.cos(), y + l * a.sin())));
    prop_oneof![long, short].prop_filter("a length", |wall| wall.length_cm() > 0.01)
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn the_least_gap_to_a_wall_is_the_distance_of_core_and_wall(a in pose(15.0, 7.0), w in any_wall()) {
        let distance = segment_distance(core(&a, H), wall_ends(&w));
        let found = gaps(&a, &Obstacle::from(&w), 100.0);
        prop_assert!(!found.is_empty() && found.len() <= 2);
        let least = found.iter().map(|(_, g)| g.gap).fold(f64::INFINITY, f64::min);
        if distance == 0.0 {
            prop_assert!(found[0].0 == Feature::Crossed && least <= -R);
        } else {
            prop_assert!((least - (distance - R)).abs() < 1e-9, "{least} {distance}");
        }
    }

    #[test]
    fn the_gap_to_a_disc_is_the_distance_of_core_and_disc(
        a in pose(15.0, 7.0), x in -30.0..30.0_f64, y in -30.0..30.0_f64, radius in 0.1..40.0_f64,
    ) {
        let center = Vec2::new(x, y);
        let distance = segment_distance(core(&a, H), (center, center));
        let found = gaps(&a, &Obstacle::from(&disc_at(x, y, radius)), 100.0);
        prop_assert_eq!(found.len(), 1);
        prop_assert!((found[0].1.gap - (distance - R - radius)).abs() < 1e-9);
    }

    #[test]
    fn a_gap_changes_as_its_normal_and_arm_say(a in pose(15.0, 7.0), w in any_wall()) {
        let (step, obstacle) = (1e-5, Obstacle::from(&w));
        for (feature, gap) in gaps(&a, &obstacle, 20.0) {
            // Curvature is at most 1/distance a unit of displacement squared; near crossing there is none.
            if feature == Feature::Crossed || gap.gap < -4.0 {
                continue;
            }
            for direction in 0..3 {
                let at = |s: f64| {
                    let moved = HullPose::new(&displaced(&a, direction, s));
                    obstacle.gap(feature, &moved, HULL).gap
                };
                let measured = (at(step) - at(-step)) / (2.0 * step);
                prop_assert!((measured - slope(&gap, direction)).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn the_bend_is_the_gap_s_second_derivative_at_a_wall_s_end(
        t in -2.4..2.4_f64, d in 5.0..9.0_f64, heading in -3.0..3.0_f64,
    ) {
        // The wall leaves the boat at a right angle from a point at t along the core and d beside it.
        let (sin, cos) = f64::sin_cos(heading);
        let at = |along: f64, beside: f64| (along * cos - beside * sin, along * sin + beside * cos);
        let obstacle = Obstacle::from(&wall(at(t, d), at(t, d + 40.0)));
        let boat = Pose::new(0.0, 0.0, heading);
        let found = gaps(&boat, &obstacle, 20.0);
        prop_assert_eq!(found.len(), 1);
        let (step, gap) = (1e-3, found[0].1);
        let [behind, ahead] = [-step, step].map(|s| {
            gaps(&displaced(&boat, 2, s), &obstacle, 20.0)[0].1.gap
        });
        let bend = (ahead - 2.0 * gap.gap + behind) / (step * step);
        prop_assert!((bend - gap.bend).abs() < 1e-3, "{bend} {}", gap.bend);
    }
}
