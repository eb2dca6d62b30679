//! Drag brings boats to rest, and not only towards it.
//!
//! On paper: with its motor off a boat keeps exp(−c0·t) of its speed, 1e-130 of it after 300 relaxation times. After 750
//! of them that is no longer a number that a computer holds, and the boat stands still. Numbers below 2.2e-308 lie in
//! between, and take a processor ten times as long.

use crate::support::{SCHEMES, driven, flock_of};
use flockenv::FlockParameters;
use flockenv::geometry::Velocity;
use flockenv::parameters::Scheme;

fn coasting(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        speed_cm_s: 0.0,
        reverse_speed_cm_s: 0.0,
        c0: 1.0,
        dt_s: 0.05,
        ..driven(scheme)
    }
}

#[test]
fn a_boat_without_a_motor_slows_by_drag_alone_and_then_stands_still() {
    for scheme in SCHEMES {
        let p = coasting(scheme);
        let mut flock = flock_of(&p, &[([0.0; 3], [10.0, -10.0, 1e-200])]);
        for _ in 0..300 {
            flock.advance(1.0, None).expect("finite motion");
        }
        let speed = flock.velocities()[0].linear.x;
        let relaxations = (10.0 / speed).ln();
        // Euler's steps of 0.05 relaxation times take ln(1/0.95) each.
        assert!(
            (299.0..309.0).contains(&relaxations),
            "{scheme:?}: {speed:e}"
        );
        for second in 0..1000 {
            flock.advance(1.0, None).expect("finite motion");
            let Velocity { linear, angular } = flock.velocities()[0];
            let subnormal = [linear.x, linear.y, angular]
                .into_iter()
                .find(|speed| speed.is_subnormal());
            assert_eq!(subnormal, None, "{scheme:?} after {second} s");
        }
        assert_eq!(flock.velocities()[0], Velocity::default(), "{scheme:?}");
    }
}
