//! Order parameters in the LAP frame: orientations and tangential velocities count clockwise as
//! positive, φ = wrap(θ − α).
//!
//! On paper: boats that all head outward have Ψ_o = 1, φ_o = 0; clockwise motion is φ_o = +π/2. And
//! always C = (N·Ψ² − mean|·|²)/(N − 1), which is (N·Ψ_o² − 1)/(N − 1) for unit vectors.

use crate::support::{cases, changed, near, table_3};
use flockenv::geometry::lap_frame::{LapFrame, orientation};
use flockenv::geometry::{Pose, Vec2, Velocity};
use flockenv::parameters::Target;
use flockenv::{Flock, FlockError, FlockParameters, OrderParameters};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Boats around the pool at 60 cm, each with LAP orientation φ and LAP velocity (outward, clockwise).
fn ring(boats: &[(f64, f64, [f64; 2])]) -> (Vec<Pose>, Vec<Velocity>) {
    boats
        .iter()
        .map(|&(polar, phi, [outward, clockwise])| {
            let (sin, cos) = f64::sin_cos(polar);
            // Clockwise at θ is along (sin θ, −cos θ).
            let velocity = Velocity::new(
                outward * cos + clockwise * sin,
                outward * sin - clockwise * cos,
                0.3,
            );
            (Pose::new(60.0 * cos, 60.0 * sin, polar - phi), velocity)
        })
        .unzip()
}

fn order_of(boats: &[(f64, f64, [f64; 2])]) -> OrderParameters {
    let (poses, velocities) = ring(boats);
    OrderParameters::from_poses(&poses, &velocities).expect("boats")
}

#[test]
fn perfect_states() {
    let places = [0.1, 1.3, 2.9, -2.5, -0.7];
    for (phi, velocity, phi_v, speed) in [
        (0.0, [0.0, 0.0], 0.0, 0.0),
        (FRAC_PI_2, [0.0, 12.0], FRAC_PI_2, 12.0),
        (-FRAC_PI_2, [0.0, -12.0], -FRAC_PI_2, 12.0),
        (FRAC_PI_4, [3.0, 4.0], 4_f64.atan2(3.0), 5.0),
        (PI, [-2.0, 0.0], PI, 2.0),
    ] {
        let order = order_of(&places.map(|polar| (polar, phi, velocity)));
        assert!(near(order.psi_o, 1.0) && near(order.c_o, 1.0));
        // −π and π are one direction.
        assert!(near((order.phi_o - phi).cos(), 1.0));
        assert!(near(order.psi_v, speed) && near(order.c_v, speed * speed));
        assert!(speed == 0.0 || near((order.phi_v - phi_v).cos(), 1.0));
        assert!(near(order.signed_order(Target::Clockwise), phi.sin()));
        assert!(near(
            order.signed_order(Target::CounterClockwise),
            -phi.sin()
        ));
        assert!(near(order.rotation(), phi.sin()));
        assert!(near(order.outward(), phi.cos()));
    }
}

#[test]
fn opposed_boats_cancel() {
    let order = order_of(&[
        (0.4, FRAC_PI_2, [0.0, 10.0]),
        (2.0, -FRAC_PI_2, [0.0, -10.0]),
    ]);
    assert!(near(order.psi_o, 0.0) && near(order.c_o, -1.0));
    assert!(near(order.psi_v, 0.0) && near(order.c_v, -100.0));
    // Three of four: Ψ = 1/2, and of six pairs three agree and three do not.
    let order = order_of(&[
        (0.4, 0.2, [1.0, 0.0]),
        (2.0, 0.2, [1.0, 0.0]),
        (3.0, 0.2, [1.0, 0.0]),
        (-2.0, 0.2 - PI, [-1.0, 0.0]),
    ]);
    assert!(near(order.psi_o, 0.5) && near(order.c_o, 0.0) && near(order.c_v, 0.0));
    assert!(near(order.phi_o, 0.2) && near(order.phi_v, 0.0));
}

#[test]
fn the_lap_frame_has_the_camera_s_signs() {
    // At the rightmost place, heading up: counter-clockwise, −π/2.
    let up = Pose::new(50.0, 0.0, FRAC_PI_2);
    assert!(near(orientation(&up), -FRAC_PI_2));
    let lap = LapFrame::at(up.position).components(Vec2::new(2.0, 7.0));
    assert!(near(lap.x, 2.0) && near(lap.y, -7.0));
    // At the top, heading right: clockwise, +π/2.
    let right = Pose::new(0.0, 50.0, 0.0);
    assert!(near(orientation(&right), FRAC_PI_2));
    let lap = LapFrame::at(right.position).components(Vec2::new(4.0, 0.0));
    assert!(near(lap.x, 0.0) && near(lap.y, 4.0));
    // Headings are not wrapped, orientations are.
    assert!(near(
        orientation(&Pose::new(0.0, 50.0, 6.0 * PI)),
        FRAC_PI_2
    ));
    assert!(near(orientation(&Pose::new(50.0, 0.0, PI)), PI));
}

#[test]
fn disorder_has_psi_of_order_one_over_the_root_of_n() {
    // Mean Ψ_o of N random unit vectors is sqrt(π/(4N)) = 0.886/sqrt(N) for large N.
    let n = 40;
    let mut sum = 0.0;
    for seed in 0..400 {
        let p = changed(table_3(), |p| p.n_boats = n);
        let flock = Flock::new(p, seed).expect("room");
        sum += flock.order_parameters(false).expect("boats").psi_o;
    }
    // Its standard deviation is 0.463/sqrt(N): the mean of 400 is good to 0.0037. Placement between
    // walls prefers tangential headings a little, evenly in both senses.
    let expected = 0.886 / f64::from(u32::try_from(n).expect("small")).sqrt();
    assert!((sum / 400.0 - expected).abs() < 0.015, "{}", sum / 400.0);
}

#[test]
fn of_the_normal_boats_only_unless_asked() {
    let p = FlockParameters {
        n_boats: 3,
        n_leaders: 2,
        ..table_3()
    };
    let mut flock = Flock::new(p.clone(), 1).expect("room");
    let scene = [
        (0.0, FRAC_PI_2, [0.0, 9.0]),
        (1.0, FRAC_PI_2, [0.0, 9.0]),
        (2.0, 0.3, [1.0, 0.0]),
    ]
    .map(|(polar, phi, v)| (polar, phi, v));
    let (mut poses, velocities) = ring(&scene);
    // In the wide pool water starts at 97 cm.
    poses.iter_mut().for_each(|pose| pose.position *= 2.3);
    flock
        .set_state(&poses, &velocities, 0.0, false)
        .expect("apart");
    let normal = flock.order_parameters(false).expect("a normal boat");
    assert!(near(normal.psi_o, 1.0) && near(normal.phi_o, 0.3) && near(normal.psi_v, 1.0));
    // One boat has no pairs.
    assert!(normal.c_o.is_nan() && normal.c_v.is_nan());
    let all = flock.order_parameters(true).expect("boats");
    assert!(all.psi_o < 1.0 && all.phi_o > 0.3 && all.c_o.is_finite());
    // None at all is refused.
    let leaders_only = Flock::new(FlockParameters { n_leaders: 3, ..p }, 1).expect("room");
    assert!(leaders_only.order_parameters(true).is_ok());
    let refused = leaders_only.order_parameters(false);
    assert!(matches!(refused, Err(FlockError::Parameter { .. })));
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn pair_means_follow_from_means(
        boats in prop::collection::vec(
            (-3.1..3.1_f64, -3.1..3.1_f64, [-20.0..20.0_f64, -20.0..20.0_f64]), 2..60),
    ) {
        let order = order_of(&boats);
        let n = boats.len() as f64;
        let identity = (n * order.psi_o.powi(2) - 1.0) / (n - 1.0);
        prop_assert!((order.c_o - identity).abs() < 1e-12);
        // And from the pairs themselves.
        let mut pairs = (0.0, 0.0, 0.0);
        for (i, a) in boats.iter().enumerate() {
            for b in &boats[..i] {
                pairs.0 += (a.1 - b.1).cos();
                pairs.1 += a.2[0] * b.2[0] + a.2[1] * b.2[1];
                pairs.2 += 1.0;
            }
        }
        prop_assert!((order.c_o - pairs.0 / pairs.2).abs() < 1e-11);
        prop_assert!((order.c_v - pairs.1 / pairs.2).abs() < 1e-8);
        prop_assert!((0.0..=1.0 + 1e-12).contains(&order.psi_o));
        prop_assert!(order.signed_order(Target::Clockwise).abs() <= order.psi_o + 1e-12);
        let squares = order.signed_order(Target::Clockwise).powi(2)
            + (order.psi_o * order.phi_o.cos()).powi(2);
        prop_assert!((squares - order.psi_o.powi(2)).abs() < 1e-12);
    }
}
