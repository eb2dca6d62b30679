//! Water current (Section 4.5): a flock that goes round pushes the water the other way round, with the
//! speed −κ·(mean tangential velocity of all boats), at most the cap; drag and u·ẋ are relative to it.
//!
//! On paper: boats with preferred speeds v_i along the tangent end at v_i + w with w = −κ·mean(v_i)/(1 + κ): a
//! flock of equal boats at v0/(1 + κ), or at v0 − cap. Water with inertia approaches that speed within a time τ: of
//! equal boats dv/dt = c0·(v0 + w − v) and dw/dt = −(κ·v + w)/τ, which has a closed form.

use crate::reference::{equations_of_motion, runge_kutta};
use crate::support::{SCHEMES, assert_near, driven, flock_of};
use flockenv::flock::Change;
use flockenv::geometry::Vec2;
use flockenv::parameters::Scheme;
use flockenv::{Flock, FlockParameters};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// So far from the center (cm) that boats which go straight stay on the tangent.
const FAR: f64 = 1e8;

fn with_current(scheme: Scheme, current_gain: f64, current_cap_cm_s: f64) -> FlockParameters {
    FlockParameters {
        current_gain,
        current_cap_cm_s,
        ..driven(scheme)
    }
}

/// Boats at rest around the center, headed `turn` from outward.
fn ring(p: &FlockParameters, boats: usize, turn: f64) -> Flock {
    let places = (0..boats).map(|boat| TAU * boat as f64 / boats as f64);
    let states: Vec<_> = places
        .map(|angle| {
            let pose = [FAR * angle.cos(), FAR * angle.sin(), angle + turn];
            (pose, [0.0; 3])
        })
        .collect();
    flock_of(p, &states)
}

/// Counter-clockwise velocity of a boat in cm/s.
fn tangential(flock: &Flock, boat: usize) -> f64 {
    let position = flock.poses()[boat].position;
    let tangent = Vec2::new(-position.y, position.x) / position.norm();
    flock.velocities()[boat].linear.dot(&tangent)
}

/// What is left of an approach by exp(−c0·t), in cm/s.
const LEFT: f64 = 1e-4;

#[test]
fn a_flock_slows_itself_down() {
    for scheme in SCHEMES {
        for (turn, sign) in [(FRAC_PI_2, 1.0), (-FRAC_PI_2, -1.0)] {
            for gain in [0.1, 0.5, 1.0] {
                let mut flock = ring(&with_current(scheme, gain, 100.0), 5, turn);
                flock.advance(40.0, None).expect("finite motion");
                for boat in 0..5 {
                    let expected = sign * 15.0 / (1.0 + gain);
                    assert_near(tangential(&flock, boat), expected, LEFT, scheme);
                }
            }
        }
    }
}

#[test]
fn the_cap_caps_the_current() {
    for scheme in SCHEMES {
        for (cap, expected) in [(3.0, 12.0), (5.0, 10.0), (7.4, 7.6), (7.6, 7.5)] {
            let mut flock = ring(&with_current(scheme, 1.0, cap), 4, -FRAC_PI_2);
            flock.advance(40.0, None).expect("finite motion");
            assert_near(tangential(&flock, 2), -expected, LEFT, scheme);
        }
    }
}

#[test]
fn only_the_mean_tangential_velocity_moves_the_water() {
    for scheme in SCHEMES {
        let p = with_current(scheme, 1.0, 5.0);
        // Outward motion moves no water.
        let mut flock = ring(&p, 4, 0.0);
        flock.advance(40.0, None).expect("finite motion");
        for (pose, velocity) in flock.poses().iter().zip(flock.velocities()) {
            let speed = velocity.linear.dot(&pose.position.normalize());
            assert_near(speed, 15.0, LEFT, scheme);
        }
        // Nor do two boats that go opposite ways round.
        let opposite = [
            ([FAR, 0.0, FRAC_PI_2], [0.0; 3]),
            ([-FAR, 0.0, FRAC_PI_2], [0.0; 3]),
        ];
        let mut flock = flock_of(&p, &opposite);
        flock.advance(40.0, None).expect("finite motion");
        assert_near(tangential(&flock, 0), 15.0, LEFT, scheme);
        assert_near(tangential(&flock, 1), -15.0, LEFT, scheme);
    }
}

#[test]
fn a_boat_without_a_motor_drifts_with_the_water_and_does_not_steer() {
    // A leader that does not back up among 9 boats that do, at 10 cm/s clockwise; κ = 0.25:
    // w = 0.25·(9·10/10)/1.25 = 1.8 cm/s counter-clockwise.
    for scheme in SCHEMES {
        let p = FlockParameters {
            n_leaders: 1,
            leaders_reverse: false,
            fw_s: 0.0,
            bw_s: 1.0,
            reverse_speed_cm_s: 10.0,
            ..with_current(scheme, 0.25, 5.0)
        };
        let mut flock = ring(&p, 10, FRAC_PI_2);
        flock.advance(40.0, Some(&[0.0])).expect("finite motion");
        assert_near(tangential(&flock, 0), 1.8, LEFT, scheme);
        assert_near(tangential(&flock, 1), -8.2, LEFT, scheme);
        // Full rudder: nothing flows past it.
        flock.advance(10.0, Some(&[1.0])).expect("finite motion");
        assert!(flock.velocities()[0].angular.abs() < 1e-6, "{scheme:?}");
    }
}

#[test]
fn each_scheme_keeps_its_order_with_the_current_on() {
    for (scheme, least, most) in [
        (Scheme::Leapfrog, 3.6, 4.4),
        (Scheme::Moreau, 1.8, 2.2),
        (Scheme::Paper, 1.8, 2.2),
    ] {
        let error = |dt_s: f64| {
            let p = FlockParameters {
                n_leaders: 1,
                c2: 1.0,
                dt_s,
                ..with_current(scheme, 0.6, 50.0)
            };
            let start = [60.0, 0.0, 0.4 * PI, 0.0, 5.0, 0.0];
            let mut flock = flock_of(&p, &[([60.0, 0.0, 0.4 * PI], [0.0, 5.0, 0.0])]);
            flock.advance(6.0, Some(&[0.8])).expect("finite motion");
            let rate = |y: &_, _| equations_of_motion(&p, p.speed_cm_s, 0.8, y);
            let exact = runge_kutta(start, (0.0, 6.0), 6000, rate);
            let position = flock.poses()[0].position;
            (position - Vec2::new(exact[0], exact[1])).norm()
        };
        let (coarse, fine) = (error(0.04), error(0.02));
        let ratio = coarse / fine;
        assert!(
            least < ratio && ratio < most,
            "{scheme:?}: {coarse:e} to {fine:e}, {ratio}"
        );
    }
}

/// A ring whose water has inertia, without a cap that it meets.
fn inert(scheme: Scheme, gain: f64, relaxation_s: f64) -> FlockParameters {
    FlockParameters {
        current_relaxation_s: relaxation_s,
        ..with_current(scheme, gain, 100.0)
    }
}

/// Speeds of boats and of the water along the tangent after a time, both from rest: the distance from the final
/// speeds is e^(mean·t)·(cosh(root·t) + (A − mean)·sinh(root·t)/root) times that at the start.
fn approach(p: &FlockParameters, time_s: f64) -> (f64, f64) {
    let (c0, gain, rate) = (p.c0, p.current_gain, 1.0 / p.current_relaxation_s);
    let last = p.speed_cm_s / (1.0 + gain);
    let (v, w) = (-last, gain * last);
    let mean = -0.5 * (c0 + rate);
    let root = (mean * mean - c0 * rate * (1.0 + gain)).abs().sqrt();
    // Both roots are complex in the tests below.
    let (cosh, sinh) = ((root * time_s).cos(), (root * time_s).sin() / root);
    let decay = (mean * time_s).exp();
    (
        last + decay * (cosh * v + sinh * (-c0 * v + c0 * w - mean * v)),
        -gain * last + decay * (cosh * w + sinh * (-gain * rate * v - rate * w - mean * w)),
    )
}

#[test]
fn water_with_inertia_follows_the_flock_in_the_order_of_the_scheme() {
    for (scheme, least, most) in [
        (Scheme::Leapfrog, 3.6, 4.4),
        (Scheme::Moreau, 1.8, 2.2),
        (Scheme::Paper, 1.8, 2.2),
    ] {
        let p = inert(scheme, 0.9, 1.5);
        let rate = 1.0 / p.current_relaxation_s;
        assert!((p.c0 - rate).powi(2) < 4.0 * p.c0 * rate * p.current_gain);
        let error = |dt_s: f64| {
            let mut flock = ring(&FlockParameters { dt_s, ..p.clone() }, 3, -FRAC_PI_2);
            flock.advance(2.0, None).expect("finite motion");
            // Velocities of the leapfrog scheme are those of half a substep ago.
            let late_s = if scheme == Scheme::Leapfrog {
                0.5 * dt_s
            } else {
                0.0
            };
            let (boats, water) = approach(&p, 2.0 - late_s);
            let found = (tangential(&flock, 1), flock.current_cm_s());
            ((found.0 + boats).abs(), (found.1 + water).abs())
        };
        let ((boats, water), (finer_boats, finer_water)) = (error(0.04), error(0.02));
        for ratio in [boats / finer_boats, water / finer_water] {
            assert!(least < ratio && ratio < most, "{scheme:?}: {ratio}");
        }
        assert!(finer_boats < 0.2 && finer_water < 0.2, "{scheme:?}");
    }
}

#[test]
fn inertia_fades_with_the_relaxation_time() {
    for scheme in SCHEMES {
        let end = |relaxation_s| {
            let mut flock = ring(&inert(scheme, 0.5, relaxation_s), 5, FRAC_PI_2);
            flock.advance(1.0, None).expect("finite motion");
            tangential(&flock, 0)
        };
        assert_near(end(1e-9), end(0.0), 1e-9, scheme);
        assert!((end(3.0) - end(0.0)).abs() > 0.1, "{scheme:?}");
    }
}

/// Five boats that have moved water with inertia for 30 s: their parameters, the flock and the water's speed in cm/s.
fn moved_water(scheme: Scheme) -> (FlockParameters, Flock, f64) {
    let p = FlockParameters {
        n_boats: 5,
        ..inert(scheme, 0.5, 20.0)
    };
    let mut flock = ring(&p, 5, FRAC_PI_2);
    flock.advance(30.0, None).expect("finite motion");
    let water = flock.current_cm_s();
    (p, flock, water)
}

#[test]
fn water_with_inertia_runs_on_through_a_change_of_parameters() {
    for scheme in SCHEMES {
        let (p, mut flock, water) = moved_water(scheme);
        assert!(water < -3.0, "{scheme:?}: {water}");
        let mut change = |current_gain, current_cap_cm_s, current_relaxation_s| {
            flock
                .change(&Change::Parameters(Box::new(FlockParameters {
                    current_gain,
                    current_cap_cm_s,
                    current_relaxation_s,
                    ..p.clone()
                })))
                .expect("a change");
            flock.current_cm_s()
        };
        assert_eq!(change(0.0, 100.0, 20.0), water);
        assert_eq!(change(0.5, 2.0, 20.0), -2.0);
        // Water without inertia is what the boats drive now.
        let instant = change(0.5, 100.0, 0.0);
        assert_near(instant, -0.5 * tangential(&flock, 0), 1e-9, scheme);
    }
}

#[test]
fn water_runs_out_once_nothing_drives_it() {
    for scheme in SCHEMES {
        let (p, mut flock, water) = moved_water(scheme);
        let still = FlockParameters {
            current_gain: 0.0,
            ..p
        };
        flock
            .change(&Change::Parameters(Box::new(still)))
            .expect("a change");
        flock.advance(20.0, None).expect("finite motion");
        assert_near(flock.current_cm_s(), water * (-1.0_f64).exp(), 1e-2, scheme);
        // A state that is given starts in water at rest.
        let (poses, velocities) = (flock.poses().to_vec(), flock.velocities().to_vec());
        flock
            .set_state(&poses, &velocities, 0.0, false)
            .expect("a state");
        assert_eq!(flock.current_cm_s(), 0.0);
    }
}
