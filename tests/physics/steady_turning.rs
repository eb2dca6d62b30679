//! Steady turning: the velocity lags the heading by the angle whose tangent is w/c0, so that
//! u·ẋ = v0·c0²/(c0² + w²), and w solves c1·w³ + c3·w·(u·ẋ) = c2·s·(u·ẋ).
//!
//! On paper: backing without steering, w² = (−c0² + sqrt(c0⁴ + 4·c0²·c3·v0/c1))/2 = 1.845² (rad/s)²
//! for Table 3. Each scheme has a steady turn of its own, which is known on paper too.

use crate::reference::root;
use crate::support::{SCHEMES, assert_near, backing, changed, driven, flock_of};
use flockenv::boat::{misalignment, steering_law};
use flockenv::geometry::Vec2;
use flockenv::parameters::{Scheme, Target};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};

/// u·ẋ of a boat that turns steadily at w with speed v0 in continuous time (dt = 0) or as the scheme
/// has it: with z = exp(i·w·dt), Euler gives (z − 1)/dt·v = c0·(v0·u − v), and Crank–Nicolson with
/// velocities V·exp(±i·w·dt/2) gives 2i·sin(w·dt/2)/dt·V = c0·(v0·u − cos(w·dt/2)·V).
fn along(scheme: Scheme, w: f64, v0: f64, c0: f64, dt: f64) -> f64 {
    if dt == 0.0 {
        return v0 * c0 * c0 / (c0 * c0 + w * w);
    }
    match scheme {
        Scheme::Moreau | Scheme::Paper => {
            let (re, im) = (c0 + ((w * dt).cos() - 1.0) / dt, (w * dt).sin() / dt);
            v0 * c0 * re / (re * re + im * im)
        }
        Scheme::Leapfrog => {
            let (sin, cos) = (0.5 * w * dt).sin_cos();
            let (re, im) = (c0 * cos, 2.0 * sin / dt);
            cos * v0 * c0 * re / (re * re + im * im)
        }
    }
}

/// The steady turning rate in (low, high).
pub fn steady_rate(p: &FlockParameters, v0: f64, s: f64, dt: f64, (low, high): (f64, f64)) -> f64 {
    root(low, high, |w| {
        let along = along(p.scheme, w, v0, p.c0, dt);
        -p.c1 * w.powi(3) + (p.c2 * s - p.c3 * w) * along
    })
}

/// Where the rate of a boat is found that turns with its rudder.
pub fn turning_with(rudder: f64) -> (f64, f64) {
    if rudder > 0.0 {
        (0.0, 1.0)
    } else {
        (-1.0, 0.0)
    }
}

fn spin_after(flock: &mut Flock, seconds: f64, rudder: Option<&[f64]>) -> f64 {
    flock.advance(seconds, rudder).expect("finite motion");
    flock.velocities()[0].angular
}

#[test]
fn backing_prefers_one_of_two_turning_rates() {
    for scheme in SCHEMES {
        let p = backing(scheme);
        let paper_value = ((-1.0 + 61_f64.sqrt()) / 2.0).sqrt();
        let continuous = steady_rate(&p, -15.0, 0.0, 0.0, (0.5, 5.0));
        assert!((continuous - paper_value).abs() < 1e-12);
        let expected = steady_rate(&p, -15.0, 0.0, p.dt_s, (0.5, 5.0));
        for side in [1.0, -1.0] {
            let mut flock = flock_of(&p, &[([0.0; 3], [0.0, 0.0, side * 0.01])]);
            let spin = spin_after(&mut flock, 60.0, None);
            assert!((spin - side * expected).abs() < 1e-9, "{scheme:?}: {spin}");
            // d(ln w)/d(dt) is of order 1 for Euler; Crank–Nicolson errs by (w·dt)²/12.
            let bound = match scheme {
                Scheme::Leapfrog => 2e-3,
                _ => 5e-2,
            };
            assert_near(spin.abs(), paper_value, bound, scheme);
        }
    }
}

#[test]
fn backing_exactly_straight_stays_straight() {
    for scheme in SCHEMES {
        let p = backing(scheme);
        let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        assert_eq!(spin_after(&mut flock, 60.0, None), 0.0);
        assert!((flock.velocities()[0].linear.x + 15.0).abs() < 1e-9);
    }
}

#[test]
fn a_leader_turns_steadily() {
    for scheme in SCHEMES {
        for rudder in [1.0, -0.4] {
            let p = changed(driven(scheme), |p| p.n_leaders = 1);
            let range = turning_with(rudder);
            let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
            let spin = spin_after(&mut flock, 60.0, Some(&[rudder]));
            let expected = steady_rate(&p, 15.0, rudder, p.dt_s, range);
            assert!((spin - expected).abs() < 1e-10, "{scheme:?}: {spin}");
            let continuous = steady_rate(&p, 15.0, rudder, 0.0, range);
            assert!((spin - continuous).abs() < 1e-6, "{scheme:?}: {spin}");
            // "about 0.1 rad/s" at full rudder.
            assert!((continuous - 0.1 * rudder).abs() < 0.002);
        }
    }
}

#[test]
fn a_stopped_boat_does_not_steer() {
    for scheme in SCHEMES {
        let p = FlockParameters {
            n_leaders: 1,
            speed_cm_s: 0.0,
            ..driven(scheme)
        };
        let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        assert_eq!(spin_after(&mut flock, 5.0, Some(&[1.0])), 0.0);
    }
}

#[test]
fn a_normal_boat_keeps_no_turn_going_forward() {
    // c3·u·ẋ damps at 15/s: nothing is left of 1 rad/s after 10 s.
    for scheme in SCHEMES {
        let mut flock = flock_of(&driven(scheme), &[([0.0; 3], [15.0, 0.0, 1.0])]);
        assert!(spin_after(&mut flock, 10.0, None).abs() < 1e-12);
    }
}

#[test]
fn leaders_back_up_or_drift_as_set() {
    for scheme in SCHEMES {
        for leaders_reverse in [true, false] {
            let p = FlockParameters {
                n_leaders: 1,
                leaders_reverse,
                ..backing(scheme)
            };
            let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3]), ([0.0, 100.0, 0.0], [0.0; 3])]);
            flock.advance(10.0, Some(&[0.0])).expect("finite motion");
            let leader = flock.velocities()[0].linear.x;
            let normal = flock.velocities()[1].linear.x;
            // exp(−10) of the approach is left.
            assert!((normal + 15.0).abs() < 1e-3);
            assert_eq!(leader, if leaders_reverse { normal } else { 0.0 });
        }
    }
}

#[test]
fn the_steering_law_is_proportional_up_to_thirty_degrees() {
    assert_eq!(steering_law(0.0), 0.0);
    assert!((steering_law(0.5 * FRAC_PI_6) - 0.5).abs() < 1e-15);
    assert!((steering_law(-0.25 * FRAC_PI_6) + 0.25).abs() < 1e-15);
    assert!((steering_law(FRAC_PI_6) - 1.0).abs() < 1e-15);
    assert_eq!(steering_law(FRAC_PI_3), 1.0);
    assert_eq!(steering_law(-FRAC_PI_3), -1.0);
    // β − α = 1.9π is −0.1π the short way round.
    assert!((steering_law(1.9 * PI) + 0.6).abs() < 1e-12);
    // Straight back: either way is as short; wrap chooses +π.
    assert_eq!(steering_law(-PI), 1.0);
}

#[test]
fn leaders_head_along_the_target_s_tangent_at_their_own_place() {
    for polar in [0.0, 0.3, 2.9, -2.0] {
        let at = Vec2::new(40.0 * f64::cos(polar), 40.0 * f64::sin(polar));
        // Clockwise motion at the rightmost place goes down (−y).
        let tangent = polar - FRAC_PI_2;
        assert!(misalignment(at, tangent, Target::Clockwise).abs() < 1e-12);
        let back = misalignment(at, tangent, Target::CounterClockwise).abs();
        assert!((back - PI).abs() < 1e-12);
        // Heading outward: clockwise is a quarter turn clockwise, the other a quarter turn the other way.
        let outward = misalignment(at, polar, Target::Clockwise);
        assert!((outward + FRAC_PI_2).abs() < 1e-12);
        let outward = misalignment(at, polar, Target::CounterClockwise);
        assert!((outward - FRAC_PI_2).abs() < 1e-12);
    }
}

#[test]
fn without_a_command_a_leader_steers_by_the_law() {
    for scheme in SCHEMES {
        let p = changed(driven(scheme), |p| p.n_leaders = 1);
        // Moving outward at full speed: the law commands a full turn clockwise, as rudder −1 does.
        let states = [([50.0, 0.0, 0.0], [15.0, 0.0, 0.0])];
        let (mut law, mut held) = (flock_of(&p, &states), flock_of(&p, &states));
        assert_eq!(law.steering_law(0), -1.0);
        law.advance(1.0, None).expect("finite motion");
        held.advance(1.0, Some(&[-1.0])).expect("finite motion");
        assert_eq!(law.poses(), held.poses(), "{scheme:?}");
        law.set_target(Target::CounterClockwise).unwrap();
        assert_eq!(law.steering_law(0), 1.0);
    }
}
