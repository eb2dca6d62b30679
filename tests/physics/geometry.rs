//! Gaps: the least gap found between two hulls is the distance of their core segments minus 2r, and
//! every gap changes as its normal and lever arms say.
//!
//! On paper: boats nose to tail, side by side, crossed and at right angles.

use crate::support::{H, R, cases, core_distance, displaced, near, pose, same_curve, velocity};
use flockenv::geometry::{
    Feature, Gap, Hull, HullPose, Pose, Vec2, inner_wall_gap, outer_wall_gap, pair_gap, pair_gaps,
    resized_gyration_radius_cm,
};
use flockenv::parameters::{FlockParameters, Preset};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const HULL: Hull = Hull {
    radius: R,
    half_length: H,
};

fn gaps(a: &Pose, b: &Pose, margin: f64) -> Vec<(Feature, Gap)> {
    let mut found = Vec::new();
    let [a, b] = [a, b].map(HullPose::new);
    pair_gaps((&a, HULL), (&b, HULL), margin, |f, g| found.push((f, g)));
    found
}

fn gyration_radius(radius: f64, half_length: f64) -> f64 {
    let hull = Hull {
        radius,
        half_length,
    };
    hull.gyration_radius()
}

#[test]
fn radii_of_gyration_known_on_paper() {
    // A disc: r/√2. A rod of length 2h: h/√3. Table 3's hull: 4.690 cm.
    assert!(near(gyration_radius(2.0, 0.0), 2.0 / 2.0_f64.sqrt()));
    assert!((gyration_radius(1e-4, 3.0) - 3.0_f64.sqrt()).abs() < 1e-3);
    assert!((HULL.gyration_radius() - 4.690).abs() < 5e-4);
}

#[test]
fn a_resized_hull_keeps_its_ratio_to_even_mass() {
    let paper = FlockParameters::preset(Preset::Simulation);
    let resized = |radius, shape| resized_gyration_radius_cm(&paper, radius, shape);
    assert_eq!(resized(R, H / R), 4.74);
    assert!(near(resized(2.0 * R, H / R), 2.0 * 4.74));
    let even_mass = gyration_radius(R, R) / gyration_radius(R, H);
    assert!(near(resized(R, 1.0) / 4.74, even_mass));
    // What is no hull is left to the check of the parameters.
    for (radius, shape) in [
        (f64::NAN, 0.5),
        (f64::INFINITY, 0.5),
        (0.0, 0.5),
        (5.0, f64::NAN),
    ] {
        assert_eq!(resized(radius, shape), 4.74);
    }
}

#[test]
fn gaps_known_on_paper() {
    let a = Pose::new(0.0, 0.0, 0.0);
    // Nose to tail, 1 cm apart: one contact along x without lever arms.
    let found = gaps(&a, &Pose::new(16.0, 0.0, 0.0), 2.0);
    assert_eq!(found.len(), 1);
    let gap = found[0].1;
    assert!(near(gap.gap, 1.0) && near(gap.normal.x, -1.0));
    assert!(near(gap.arm_i, 0.0) && near(gap.arm_j, 0.0));
    // Side by side and shifted by 1 cm: two contacts, at the ends of the stretch they share.
    for turn in [0.0, PI] {
        let found = gaps(&a, &Pose::new(1.0, 10.5, turn), 1.0);
        assert_eq!(found.len(), 2, "{turn}");
        let mut arms: Vec<f64> = found.iter().map(|(_, g)| g.arm_i).collect();
        arms.sort_by(f64::total_cmp);
        // Normal (0, −1): arm −x of the touch, at x = −1.5 and 2.5.
        assert!(near(arms[0], -2.5) && near(arms[1], 1.5), "{arms:?}");
        assert!(
            found
                .iter()
                .all(|(_, g)| near(g.gap, 0.5) && near(g.normal.y, -1.0))
        );
    }
    // Tip into side at offset 2.
    let found = gaps(&a, &Pose::new(2.0, 12.0, FRAC_PI_2), 1.0);
    assert_eq!(found.len(), 1);
    assert!(near(found[0].1.gap, -0.5) && near(found[0].1.arm_i, -2.0));
    // Crossed at right angles through the middle: out by 2.5 + 10.
    let found = gaps(&a, &Pose::new(0.0, 0.0, FRAC_PI_2), 1.0);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, Feature::Crossed);
    assert!(near(found[0].1.gap, -12.5));
}

#[test]
fn wall_gaps_known_on_paper() {
    let boat = HullPose::new(&Pose::new(80.0, 0.0, FRAC_PI_2));
    for side in [-1.0, 1.0] {
        let gap = outer_wall_gap(&boat, side, HULL, 90.0);
        let distance = 80_f64.hypot(2.5);
        assert!(near(gap.gap, 85.0 - distance));
        assert!(near(gap.normal.x, -80.0 / distance));
        // side·h·(ŷ × n) = side·h·80/distance.
        assert!(near(gap.arm_i, side * 2.5 * 80.0 / distance));
    }
    // Tangential on the obstacle: touched in the middle of the side, without a lever arm.
    let gap = inner_wall_gap(&boat, HULL, 48.5);
    assert!(near(gap.gap, 80.0 - 53.5) && near(gap.arm_i, 0.0) && near(gap.normal.x, 1.0));
    // Radial: touched at the stern.
    let boat = HullPose::new(&Pose::new(60.0, 0.0, 0.0));
    assert!(near(inner_wall_gap(&boat, HULL, 48.5).gap, 4.0));
}

/// d(gap)/d(direction) as the gap's normal and arms have it.
fn slope(gap: &Gap, first: bool, direction: usize) -> f64 {
    let (sign, arm) = if first {
        (1.0, gap.arm_i)
    } else {
        (-1.0, gap.arm_j)
    };
    sign * [gap.normal.x, gap.normal.y, arm][direction]
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn the_least_gap_is_the_distance_of_the_cores(a in pose(16.0, 4.0), b in pose(16.0, 4.0)) {
        let distance = core_distance(&a, &b, H);
        let found = gaps(&a, &b, 100.0);
        prop_assert!(!found.is_empty() && found.len() <= 2);
        let least = found.iter().map(|(_, g)| g.gap).fold(f64::INFINITY, f64::min);
        if distance == 0.0 {
            prop_assert!(found[0].0 == Feature::Crossed && least <= -2.0 * R);
        } else {
            prop_assert!((least - (distance - 2.0 * R)).abs() < 1e-9, "{least} {distance}");
        }
        for (_, gap) in &found {
            prop_assert!((gap.normal.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn gaps_do_not_depend_on_who_comes_first(a in pose(16.0, 4.0), b in pose(16.0, 4.0)) {
        let order = |mut gaps: Vec<(Feature, Gap)>| {
            gaps.sort_by(|x, y| x.1.gap.total_cmp(&y.1.gap));
            gaps
        };
        let (forth, back) = (order(gaps(&a, &b, 3.0)), order(gaps(&b, &a, 3.0)));
        prop_assert_eq!(forth.len(), back.len());
        for ((_, f), (_, g)) in forth.iter().zip(&back) {
            prop_assert!((f.gap - g.gap).abs() < 1e-9);
        }
    }

    #[test]
    fn a_gap_changes_as_its_normal_and_arms_say(a in pose(16.0, 4.0), b in pose(16.0, 4.0)) {
        let step = 1e-5;
        for (feature, gap) in gaps(&a, &b, 20.0) {
            // Curvature is at most 1/distance a unit of displacement squared; near crossing there is none.
            if feature == Feature::Crossed || gap.gap < -9.0 {
                continue;
            }
            for direction in 0..3 {
                let at = |s: f64| {
                    let (moved, b) = (HullPose::new(&displaced(&a, direction, s)), HullPose::new(&b));
                    pair_gap(feature, (&moved, HULL), (&b, HULL)).gap
                };
                let measured = (at(step) - at(-step)) / (2.0 * step);
                // A kink (an end passing the other's end) may lie within the step: slopes change by
                // no more than curvature·step there too.
                prop_assert!((measured - slope(&gap, true, direction)).abs() < 1e-3);
                let at = |s: f64| {
                    let (a, moved) = (HullPose::new(&a), HullPose::new(&displaced(&b, direction, s)));
                    pair_gap(feature, (&a, HULL), (&moved, HULL)).gap
                };
                let measured = (at(step) - at(-step)) / (2.0 * step);
                prop_assert!((measured - slope(&gap, false, direction)).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn wall_gaps_change_as_their_normals_and_arms_say(
        radius in 20.0..80.0_f64, polar in -4.0..4.0_f64, heading in -4.0..4.0_f64,
    ) {
        let at = Vec2::new(radius * polar.cos(), radius * polar.sin());
        let pose = Pose::new(at.x, at.y, heading);
        let walls = |pose: &Pose| {
            let boat = HullPose::new(pose);
            [
                outer_wall_gap(&boat, 1.0, HULL, 90.0),
                outer_wall_gap(&boat, -1.0, HULL, 90.0),
                inner_wall_gap(&boat, HULL, 10.0),
            ]
        };
        let step = 1e-5;
        for (wall, gap) in walls(&pose).iter().enumerate() {
            for direction in 0..3 {
                let ahead = walls(&displaced(&pose, direction, step))[wall].gap;
                let behind = walls(&displaced(&pose, direction, -step))[wall].gap;
                let measured = (ahead - behind) / (2.0 * step);
                prop_assert!((measured - slope(gap, true, direction)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn a_gap_curves_as_its_second_derivative_says(
        a in pose(16.0, 4.0), b in pose(16.0, 4.0), v in velocity(), w in velocity(),
    ) {
        let hulls = |s: f64| [a.moved(&v, s), b.moved(&w, s)].map(|pose| HullPose::new(&pose));
        let [first, second] = hulls(0.0);
        for (feature, gap) in gaps(&a, &b, 20.0) {
            if feature == Feature::Crossed || gap.gap < -9.0 {
                continue;
            }
            let stated = gap.second_derivative(HULL, gap.gap + 2.0 * R, (&first, &v), Some((&second, &w)));
            let at = |s: f64| {
                let [a, b] = hulls(s);
                pair_gap(feature, (&a, HULL), (&b, HULL))
            };
            same_curve(at, stated)?;
        }
    }

    #[test]
    fn wall_gaps_curve_as_their_second_derivatives_say(
        radius in 20.0..80.0_f64, polar in -4.0..4.0_f64, heading in -4.0..4.0_f64, v in velocity(),
    ) {
        let pose = Pose::new(radius * polar.cos(), radius * polar.sin(), heading);
        let boat = |s: f64| HullPose::new(&pose.moved(&v, s));
        let stated = |gap: Gap, from_center: f64| {
            gap.second_derivative(HULL, gap.gap + R + from_center, (&boat(0.0), &v), None)
        };
        for side in [-1.0, 1.0] {
            let at = |s: f64| outer_wall_gap(&boat(s), side, HULL, 90.0);
            same_curve(at, stated(at(0.0), -90.0))?;
        }
        let at = |s: f64| inner_wall_gap(&boat(s), HULL, 10.0);
        same_curve(at, stated(at(0.0), 10.0))?;
    }
}
