//! Turning bias (Section 4.5): a constant rudder of the normal boats, positive counter-clockwise while
//! they move forward.
//!
//! On paper: a biased boat turns as a leader with its rudder held there, at the w that solves
//! c1·w³ + c3·w·(u·ẋ) = c2·s·(u·ẋ) with u·ẋ = v0·c0²/(c0² + w²); backing, the bias sets the two
//! preferred rates apart.

use crate::steady_turning::{steady_rate, turning_with};
use crate::support::{SCHEMES, backing, bits, changed, driven, flock_of};
use flockenv::FlockParameters;
use flockenv::parameters::Scheme;

fn biased(scheme: Scheme, turning_bias: f64) -> FlockParameters {
    changed(driven(scheme), |p| p.turning_bias = turning_bias)
}

/// Turning rate of a lone boat from this one, after a minute.
fn final_spin(p: &FlockParameters, spin: f64) -> f64 {
    let mut flock = flock_of(p, &[([0.0; 3], [0.0, 0.0, spin])]);
    flock.advance(60.0, None).expect("finite motion");
    flock.velocities()[0].angular
}

#[test]
fn a_biased_boat_circles_at_the_steady_rate() {
    for scheme in SCHEMES {
        for bias in [0.3, 1.0, -0.7] {
            let p = biased(scheme, bias);
            let found = final_spin(&p, 0.0);
            let expected = steady_rate(&p, 15.0, bias, p.dt_s, turning_with(bias));
            assert!((found - expected).abs() < 1e-10, "{scheme:?}: {found}");
            // Table 3's boats: 0.1 rad/s at full rudder, in proportion below.
            assert!((found - 0.1 * bias).abs() < 0.002);
        }
    }
}

#[test]
fn backing_the_bias_sets_the_two_preferred_rates_apart() {
    for scheme in SCHEMES {
        let p = FlockParameters {
            c2: 1.0,
            turning_bias: 0.5,
            ..backing(scheme)
        };
        let (left, right) = (final_spin(&p, 0.01), final_spin(&p, -3.0));
        let expected_left = steady_rate(&p, -15.0, 0.5, p.dt_s, (0.6, 5.0));
        let expected_right = steady_rate(&p, -15.0, 0.5, p.dt_s, (-5.0, -0.6));
        assert!(expected_left < 1.7 && expected_right < -1.9);
        // 0.01 rad/s is below the rate from which a boat speeds up to the left.
        assert!((left - expected_right).abs() < 1e-9, "{scheme:?}: {left}");
        assert!((right - expected_right).abs() < 1e-9, "{scheme:?}: {right}");
        let found = final_spin(&p, 3.0);
        assert!((found - expected_left).abs() < 1e-9, "{scheme:?}: {found}");
    }
}

#[test]
fn a_biased_boat_is_a_leader_with_its_rudder_held_there() {
    for scheme in SCHEMES {
        let p = FlockParameters {
            c4: 0.3,
            nop1_s: 0.5,
            bw_s: 0.7,
            ..biased(scheme, 0.4)
        };
        let mut normal = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        normal.advance(20.0, None).expect("finite motion");
        let p = FlockParameters {
            n_leaders: 1,
            turning_bias: 0.0,
            ..p
        };
        let mut leader = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        leader.advance(20.0, Some(&[0.4])).expect("finite motion");
        assert_eq!(bits(&normal), bits(&leader), "{scheme:?}");
    }
}

#[test]
fn leaders_have_no_bias() {
    for scheme in SCHEMES {
        let run = |turning_bias| {
            let p = changed(biased(scheme, turning_bias), |p| p.n_leaders = 1);
            let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
            flock.advance(5.0, Some(&[0.2])).expect("finite motion");
            bits(&flock)
        };
        assert_eq!(run(0.9), run(0.0), "{scheme:?}");
    }
}
