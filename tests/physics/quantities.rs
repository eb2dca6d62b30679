//! The table of quantities: what is measured of boats at one time.
//!
//! On paper: boats that head against each other along one line have nematic order 1 and no order; boats at
//! right angles have neither. Milling is +1 where all circle clockwise, −1 counter-clockwise, 0 for motion
//! along the radius and at rest.

use flockenv::analysis::quantities::{Formula, QUANTITIES, RECORDED, quantity, recorded};
use flockenv::geometry::{HullPose, Pose, Velocity, turned_left};
use std::f64::consts::{FRAC_PI_2, PI};

/// A boat at a polar angle whose LAP orientation is φ, and which moves along its heading.
fn boat(radius: f64, polar: f64, phi: f64, speed: f64) -> (Pose, Velocity) {
    let heading = polar - phi;
    (
        Pose::new(radius * polar.cos(), radius * polar.sin(), heading),
        Velocity::new(speed * heading.cos(), speed * heading.sin(), 0.0),
    )
}

fn measured(name: &str, boats: &[(Pose, Velocity)]) -> f64 {
    let hulls: Vec<_> = boats.iter().map(|(pose, _)| HullPose::new(pose)).collect();
    let velocities: Vec<_> = boats.iter().map(|(_, velocity)| *velocity).collect();
    let values = recorded(&hulls, &velocities).expect("boats");
    let place = QUANTITIES.iter().position(|each| each.name == name);
    values[place.expect("a recorded quantity")]
}

/// Boats around the pool with these orientations.
fn ring(phis: &[f64]) -> Vec<(Pose, Velocity)> {
    let each = phis.iter().enumerate();
    each.map(|(i, &phi)| boat(140.0, 0.7 + 0.9 * i as f64, phi, 10.0))
        .collect()
}

#[test]
fn nematic_order_does_not_distinguish_bow_from_stern() {
    let opposed = ring(&[FRAC_PI_2, -FRAC_PI_2, FRAC_PI_2, -FRAC_PI_2]);
    assert!((measured("nematic", &opposed) - 1.0).abs() < 1e-12);
    assert!(measured("psi_o", &opposed) < 1e-12);
    let crossed = ring(&[0.0, FRAC_PI_2, 0.0, -FRAC_PI_2]);
    assert!(measured("nematic", &crossed) < 1e-12);
    // Of three boats, one across: |2 − 1|/3.
    let mostly = ring(&[0.0, 0.0, FRAC_PI_2]);
    assert!((measured("nematic", &mostly) - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn milling_is_the_share_of_motion_around_the_pool() {
    assert!((measured("milling", &ring(&[FRAC_PI_2; 5])) - 1.0).abs() < 1e-12);
    assert!((measured("milling", &ring(&[-FRAC_PI_2; 5])) + 1.0).abs() < 1e-12);
    assert!(measured("milling", &ring(&[0.0, PI, -FRAC_PI_2, FRAC_PI_2])).abs() < 1e-12);
    // Two boats against each other, the outer one three times as far out: (3 − 1)/(3 + 1).
    let against = [
        boat(120.0, 0.3, FRAC_PI_2, 10.0),
        boat(40.0, 2.0, -FRAC_PI_2, 10.0),
    ];
    assert!((measured("milling", &against) - 0.5).abs() < 1e-12);
    let mut at_rest = ring(&[FRAC_PI_2; 3]);
    at_rest
        .iter_mut()
        .for_each(|(_, velocity)| *velocity = Velocity::default());
    assert_eq!(measured("milling", &at_rest), 0.0);
}

#[test]
fn milling_counts_motion_and_not_the_heading() {
    let (pose, _) = boat(100.0, 0.4, 0.0, 0.0);
    // Clockwise motion of a boat that heads outward.
    let clockwise = -turned_left(pose.position) / 100.0 * 7.0;
    let velocity = Velocity::new(clockwise.x, clockwise.y, 0.0);
    assert!((measured("milling", &[(pose, velocity)]) - 1.0).abs() < 1e-12);
}

#[test]
fn names_are_found_and_values_lie_in_their_ranges() {
    for entry in QUANTITIES {
        assert_eq!(quantity(entry.name).expect("an entry").name, entry.name);
        assert!(!entry.label.is_empty() && !entry.meaning.is_empty());
    }
    let refused = quantity("nematik").map(|entry| entry.name);
    let message = refused.expect_err("no entry").to_string();
    assert!(message.contains("nematic"), "{message}");
    let boats = ring(&[0.3, 1.1, -2.0, 2.9]);
    for entry in &QUANTITIES[..RECORDED] {
        assert!(matches!(entry.formula, Formula::Recorded(_)));
        let value = measured(entry.name, &boats);
        let (low, high) = entry.range.unwrap_or((f64::MIN, f64::MAX));
        assert!((low..=high).contains(&value), "{} {value}", entry.name);
    }
}
