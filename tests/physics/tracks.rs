//! Velocities of tracked boats are differences of their poses, weighted by the steps in time.
//!
//! On paper: under a constant acceleration they are exact at any time between two others, however irregular the clock;
//! the mean of two slopes is not, but where both steps are equal.

use flockenv::analysis::samples::Samples;
use flockenv::geometry::{Pose, Vec2};

/// One boat at x = t², y = −t, turning by 0.5 t² rad.
fn accelerated(times: &[f64]) -> Samples {
    let at = |&t: &f64| Pose::new(t * t, -t, 0.5 * t * t);
    Samples::new(times.iter().map(at).collect(), 1)
}

#[test]
fn a_constant_acceleration_is_exact_on_an_irregular_clock() {
    let times = [0.0, 0.1, 0.5, 0.6, 1.4];
    let (found, broken) = accelerated(&times).velocities(&times, f64::INFINITY, f64::INFINITY);
    assert_eq!(broken, 0);
    for (row, time) in found.rows().iter().zip(times).take(4).skip(1) {
        assert!((row.position - Vec2::new(2.0 * time, -1.0)).norm_squared() < 1e-24);
        assert!((row.heading - time).abs() < 1e-12);
    }
    // One-sided at the ends: the mean velocity over a step.
    assert!((found.rows()[0].position.x - 0.1).abs() < 1e-12);
    assert!((found.rows()[4].position.x - 2.0).abs() < 1e-12);
}

#[test]
fn no_difference_crosses_a_gap_a_long_step_or_a_jump() {
    let (gone, far) = (Pose::new(f64::NAN, f64::NAN, f64::NAN), 900.0);
    let x = |x: f64| Pose::new(x, 0.0, 0.0);
    // Two boats: one is away at 2 s, the other one jumps at 3 s.
    let rows = [
        x(0.0),
        x(0.0),
        x(1.0),
        x(1.0),
        gone,
        x(2.0),
        x(3.0),
        x(far),
        x(5.0),
        x(far + 1.0),
    ];
    let times = [0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 5.0, 5.0];
    let samples = Samples::new(rows.to_vec(), 2);
    let (found, broken) = samples.velocities(&times, 1.5, 100.0);
    assert_eq!(broken, 1);
    let speeds: Vec<_> = found.rows().iter().map(|row| row.position.x).collect();
    let [a, b] = [0, 1].map(|boat| {
        speeds
            .iter()
            .skip(boat)
            .step_by(2)
            .copied()
            .collect::<Vec<_>>()
    });
    assert_eq!(a[..2], [1.0, 1.0]);
    assert!(a[2..].iter().all(|speed| speed.is_nan()));
    assert_eq!(b[..3], [1.0, 1.0, 1.0]);
    assert!(b[3..].iter().all(|speed| speed.is_nan()));
}

#[test]
fn a_step_of_just_the_longest_time_counts() {
    let times = [0.0, 0.5, 1.0];
    let (found, _) = accelerated(&times).velocities(&times, 0.5, 1e9);
    assert!((found.rows()[1].position.x - 1.0).abs() < 1e-12);
}

#[test]
fn boats_may_have_clocks_of_their_own() {
    let rows = vec![
        Pose::new(0.0, 0.0, 0.0),
        Pose::new(2.0, 0.0, 0.0),
        Pose::new(10.0, 0.0, 0.0),
        Pose::new(12.0, 0.0, 0.0),
    ];
    let (found, _) = Samples::new(rows, 2).velocities(&[0.0, 0.2, 1.0, 1.2], 2.0, 1e9);
    assert!(
        found
            .rows()
            .iter()
            .all(|row| (row.position.x - 10.0).abs() < 1e-12)
    );
}
