//! Structure of boats: clusters and jams, the wall, and headings.

use crate::support::{changed, table_3};
use approx::assert_abs_diff_eq;
use flockenv::FlockParameters;
use flockenv::analysis::structure::{jam_sizes, largest_cluster, on_outer_wall, polarization};
use flockenv::geometry::Pose;
use flockenv::parameters::Pool;
use std::f64::consts::FRAC_PI_2;

fn narrow() -> FlockParameters {
    changed(table_3(), |p| p.pool = Pool::NARROW)
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
