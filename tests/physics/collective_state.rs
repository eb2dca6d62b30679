//! Collective states (Table 2) and the ordering time (eq. 7).
//!
//! On paper: a flock that points outward and stands jams; one that moves along the pool is ordered; one
//! without a common direction is disordered, or clusters if it sticks together.

use flockenv::OrderParameters;
use flockenv::analysis::collective_state::{CollectiveState, off_tangent, ordering_time};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

const SPEED: f64 = 15.0;

fn order(psi_o: f64, phi_o: f64, psi_v: f64) -> OrderParameters {
    OrderParameters {
        psi_o,
        phi_o,
        psi_v,
        ..OrderParameters::default()
    }
}

#[test]
fn states_are_those_of_table_2() {
    use CollectiveState::{
        Between, Clustering, Disordered, Jamming, OrderedClockwise, OrderedCounterClockwise,
    };
    for (psi_o, phi_o, psi_v, cluster, expected) in [
        (0.95, 0.0, 0.2, 0.9, Jamming),
        (0.95, -0.7, 0.2, 0.1, Jamming),
        (0.95, FRAC_PI_2, 9.0, 0.2, OrderedClockwise),
        (0.85, FRAC_PI_2 - 0.7, 4.0, 1.0, OrderedClockwise),
        (0.95, -FRAC_PI_2, 9.0, 0.2, OrderedCounterClockwise),
        (0.2, 1.0, 1.0, 0.2, Disordered),
        (0.2, FRAC_PI_2, 9.0, 0.7, Disordered),
        (0.2, 0.0, 1.0, 0.8, Clustering),
        // Ordered next to the wall without translational motion: on the way.
        (0.95, FRAC_PI_2, 1.0, 0.2, Between),
        (0.95, 0.0, 9.0, 0.2, Between),
        (0.95, PI, 0.2, 0.2, Between),
        (0.65, FRAC_PI_2, 9.0, 0.9, Between),
    ] {
        let found = CollectiveState::from_order(&order(psi_o, phi_o, psi_v), SPEED, cluster);
        assert_eq!(found, expected, "{psi_o} {phi_o} {psi_v} {cluster}");
    }
}

#[test]
fn a_time_without_boats_is_in_no_state_of_the_table() {
    let absent = order(f64::NAN, f64::NAN, f64::NAN);
    for cluster in [0.0, f64::NAN] {
        let found = CollectiveState::from_order(&absent, SPEED, cluster);
        assert_eq!(found, CollectiveState::Between);
    }
}

#[test]
fn mirrored_flocks_are_in_mirrored_states() {
    for psi_o in [0.1, 0.6, 0.9] {
        for phi_o in [0.1, 0.8, 1.5, 2.5] {
            for psi_v in [0.5, 8.0] {
                let state = |sign: f64| {
                    CollectiveState::from_order(&order(psi_o, sign * phi_o, psi_v), SPEED, 0.3)
                };
                let expected = match state(1.0) {
                    CollectiveState::OrderedClockwise => CollectiveState::OrderedCounterClockwise,
                    other => other,
                };
                assert_eq!(state(-1.0), expected);
            }
        }
    }
}

#[test]
fn off_tangent_is_the_angle_to_the_nearer_tangent() {
    for (phi, expected) in [
        (0.0, FRAC_PI_2),
        (FRAC_PI_2, 0.0),
        (-FRAC_PI_2, 0.0),
        (PI, FRAC_PI_2),
        (-FRAC_PI_4, FRAC_PI_4),
        (3.0 * FRAC_PI_4, FRAC_PI_4),
    ] {
        assert!((off_tangent(phi) - expected).abs() < 1e-15, "{phi}");
    }
}

/// Ordered from a time on, at an angle off the tangent.
fn run(from: f64, off: f64) -> (Vec<f64>, Vec<OrderParameters>) {
    let times: Vec<f64> = (0..=1000).map(|i| 0.1 * f64::from(i)).collect();
    let series = times.iter().map(|&time| {
        if time < from {
            order(0.3, 0.0, 0.0)
        } else {
            order(0.9, off - FRAC_PI_2, 9.0)
        }
    });
    let series = series.collect();
    (times, series)
}

#[test]
fn the_ordering_time_is_when_order_starts() {
    for from in [0.0, 20.0, 50.0] {
        let (times, series) = run(from, 0.1);
        let found = ordering_time(&times, &series, PI / 20.0);
        assert!((found - from).abs() < 1e-9);
    }
}

#[test]
fn a_run_without_order_in_its_second_half_has_an_infinite_ordering_time() {
    // Ordered from 60 of 100 s on: mean Ψ_o of the second half is 0.3·0.2 + 0.9·0.8 = 0.78.
    let (times, series) = run(60.0, 0.0);
    assert_eq!(ordering_time(&times, &series, PI / 20.0), f64::INFINITY);
    assert_eq!(ordering_time(&[], &[], PI / 20.0), f64::INFINITY);
}

#[test]
fn the_second_half_is_that_of_the_run_whenever_it_starts() {
    // Ordered from 40 of 100 s on: mean Ψ_o of the whole run is 0.66, of its second half 0.9.
    let (mut times, series) = run(40.0, 0.0);
    times.iter_mut().for_each(|time| *time += 500.0);
    let found = ordering_time(&times, &series, PI / 20.0);
    assert!((found - 540.0).abs() < 1e-9, "{found}");
}

#[test]
fn times_without_boats_are_left_out_of_the_ordering_time() {
    let (times, mut series) = run(20.0, 0.0);
    series[900] = order(f64::NAN, f64::NAN, f64::NAN);
    let found = ordering_time(&times, &series, PI / 20.0);
    assert!((found - 20.0).abs() < 1e-9, "{found}");
}

#[test]
fn the_wider_angle_finds_what_the_printed_one_misses() {
    // π/20 = 0.157.
    let (times, series) = run(20.0, 0.16);
    assert_eq!(ordering_time(&times, &series, PI / 20.0), f64::INFINITY);
    let found = ordering_time(&times, &series, FRAC_PI_4);
    assert!(found > 19.0 && found.is_finite());
}
