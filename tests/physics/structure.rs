//! Structure of boats: clusters, the wall, pairs, displacement and persistence.
//!
//! On paper: a boat that goes straight is displaced by (v·t)², one that circles by 4R²·sin²(w·t/2);
//! independent boats have the pair distribution 1.

use approx::assert_abs_diff_eq;
use flockenv::analysis::structure::{
    PairCounts, heading_correlation, jam_sizes, largest_cluster, mean_square_displacement,
    on_outer_wall, polarization,
};
use flockenv::geometry::Pose;
use flockenv::parameters::{Pool, Preset};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::FRAC_PI_2;

fn narrow() -> FlockParameters {
    FlockParameters {
        pool: Pool::NARROW,
        ..FlockParameters::preset(Preset::Simulation)
    }
}

#[test]
fn a_cluster_is_what_gaps_below_half_a_centimeter_join() {
    // Side by side: hulls are 10 cm wide.
    let row = |gap: f64, count: usize| -> Vec<Pose> {
        let place = |boat| Pose::new(0.0, (10.0 + gap) * boat as f64, 0.0);
        (0..count).map(place).collect()
    };
    let p = narrow();
    assert_eq!(largest_cluster(&row(0.4, 5), &p), 1.0);
    assert_eq!(largest_cluster(&row(0.6, 5), &p), 0.2);
    let mut two = row(0.4, 3);
    two.extend(
        row(0.4, 2)
            .iter()
            .map(|pose| Pose::new(100.0, pose.position.y, 0.0)),
    );
    assert_eq!(largest_cluster(&two, &p), 0.6);
    // Bow to bow, hulls are 15 cm long.
    let tandem = [Pose::new(0.0, 0.0, 0.0), Pose::new(15.4, 0.0, 0.0)];
    assert_eq!(largest_cluster(&tandem, &p), 1.0);
    let apart = [tandem[0], Pose::new(15.4, 0.0, FRAC_PI_2)];
    assert_eq!(largest_cluster(&apart, &p), 0.5);
}

#[test]
fn a_jam_is_three_boats_in_touch_that_face_outward() {
    let p = narrow();
    // Far from the center in two directions, 10.4 cm apart: the gap of hulls 10 cm wide is 0.4 cm.
    let row = |side: f64, count: i32, turned: f64| -> Vec<Pose> {
        let outward = if side > 0.0 {
            0.0
        } else {
            std::f64::consts::PI
        };
        let place = |boat| Pose::new(1e4 * side, 10.4 * f64::from(boat), outward + turned);
        (0..count).map(place).collect()
    };
    let sizes = |rows: &[Vec<Pose>]| {
        let mut sizes = jam_sizes(&rows.concat(), &p);
        sizes.sort_unstable();
        sizes
    };
    assert_eq!(sizes(&[row(1.0, 5, 0.0), row(-1.0, 3, 0.3)]), [3, 5]);
    assert_eq!(sizes(&[row(1.0, 2, 0.0), row(-1.0, 3, 1.1)]), [0; 0]);
    // A boat that faces along the wall parts a jam.
    let mut parted = row(1.0, 7, 0.0);
    parted[3].heading = FRAC_PI_2;
    assert_eq!(sizes(&[parted]), [3, 3]);
    assert_eq!(sizes(&[]), [0; 0]);
}

#[test]
fn polarization_is_the_length_of_the_mean_heading_wherever_boats_are() {
    let pose = |x: f64, heading: f64| Pose::new(x, 0.0, heading);
    assert_eq!(polarization(&[pose(60.0, 1.0), pose(-60.0, 1.0)]), 1.0);
    let apart = [pose(60.0, 1.0), pose(60.0, 1.0 + FRAC_PI_2)];
    assert_abs_diff_eq!(polarization(&apart), 0.5_f64.sqrt(), epsilon = 1e-15);
    assert!(polarization(&[]).is_nan());
}

#[test]
fn boats_on_the_wall_are_counted() {
    // Outer radius 90: headed outward a boat touches at 82.5 cm, along it at sqrt(85² − 2.5²) = 84.96.
    let p = narrow();
    let along = (85.0_f64.powi(2) - 2.5_f64.powi(2)).sqrt();
    let on = [
        Pose::new(82.4, 0.0, 0.0),
        Pose::new(-82.1, 0.0, 0.0),
        Pose::new(0.0, along - 0.4, 0.0),
    ];
    let off = [
        Pose::new(81.9, 0.0, 0.0),
        Pose::new(60.0, 0.0, 0.0),
        Pose::new(0.0, along - 0.6, 0.0),
    ];
    assert_eq!(on_outer_wall(&on, &p), 1.0);
    assert_eq!(on_outer_wall(&off, &p), 0.0);
    assert_eq!(on_outer_wall(&[on[0], off[0], off[1], on[2]], &p), 0.5);
}

/// Samples of boats, one row a time.
fn samples(count: usize, pose: impl Fn(f64) -> Pose) -> Vec<Vec<Pose>> {
    (0..count).map(|i| vec![pose(0.1 * i as f64)]).collect()
}

fn rows(samples: &[Vec<Pose>]) -> Vec<&[Pose]> {
    samples.iter().map(Vec::as_slice).collect()
}

#[test]
fn displacement_of_straight_and_of_circling_boats() {
    let straight = samples(50, |t| Pose::new(9.0 * t, 12.0 * t, 0.3));
    let circling = samples(50, |t| Pose::new(30.0 * t.cos(), 30.0 * t.sin(), t));
    for lag in [0, 1, 7, 49] {
        let t = 0.1 * lag as f64;
        let (straight, circling) = (rows(&straight), rows(&circling));
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{lag}");
        close(mean_square_displacement(&straight, lag), (15.0 * t).powi(2));
        close(
            mean_square_displacement(&circling, lag),
            3600.0 * (0.5 * t).sin().powi(2),
        );
        close(heading_correlation(&straight, lag), 1.0);
        close(heading_correlation(&circling, lag), t.cos());
        assert!(mean_square_displacement(&straight, 50).is_nan());
    }
}

#[test]
fn independent_boats_have_a_flat_pair_distribution() {
    // Places of one boat each in many flocks: independent, but for hulls that cannot overlap.
    let p = FlockParameters {
        n_boats: 1,
        ..narrow()
    };
    let place = |seed| Flock::new(p.clone(), seed).expect("room").poses()[0];
    let boats: Vec<Pose> = (0..600).map(place).collect();
    let mut counts = PairCounts::new(vec![0.0, 20.0, 60.0, 100.0, 140.0, 165.0]);
    counts.add(&boats);
    for (found, expected) in counts.found.iter().zip(&counts.expected) {
        // Pairs of 600 boats are not independent: some per cent of scatter.
        assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    }
    let all: f64 = counts.expected.iter().sum();
    assert!((all - 600.0 * 599.0 / 2.0).abs() < 0.01 * all);
}

#[test]
fn expected_pairs_follow_the_law_of_cosines() {
    // Both at 60 cm: nearer than 60 cm within ±60°, a third of all angles.
    let mut counts = PairCounts::new(vec![0.0, 60.0, 120.001]);
    counts.add(&[Pose::new(60.0, 0.0, 0.0), Pose::new(0.0, 60.0, 0.0)]);
    assert!((counts.expected[0] - 1.0 / 3.0).abs() < 1e-12);
    assert!((counts.expected[1] - 2.0 / 3.0).abs() < 1e-12);
    assert_eq!(counts.found, [0.0, 1.0]);
}
