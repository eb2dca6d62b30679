//! Leaders' preferred speeds over those of the normal boats (Section 2.6).
//!
//! On paper: a lone boat of constant heading tends to v0 as 1 − exp(−c0·t), leader or not, so the displacements of a
//! leader and of a normal boat are in the proportion of their preferred speeds.

use crate::support::{SCHEMES, assert_near, bits, changed, driven, flock_of};
use flockenv::parameters::Scheme;
use flockenv::{Flock, FlockParameters};

fn alone(scheme: Scheme, n_leaders: usize, leader_speed_factor: f64) -> Flock {
    let p = FlockParameters {
        n_leaders,
        leader_speed_factor,
        ..driven(scheme)
    };
    let mut flock = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
    flock
        .advance(20.0, Some(&vec![0.0; n_leaders]))
        .expect("finite motion");
    flock
}

#[test]
fn a_leader_has_its_share_of_the_preferred_speed() {
    for scheme in SCHEMES {
        let normal = alone(scheme, 0, 1.3).poses()[0].position;
        let leader = alone(scheme, 1, 1.3).poses()[0].position;
        assert!(normal.norm() > 200.0, "{scheme:?}");
        assert_near((leader - normal * 1.3).norm(), 0.0, 1e-9, scheme);
    }
}

#[test]
fn a_factor_of_1_and_a_flock_without_leaders_are_left_alone() {
    for scheme in SCHEMES {
        assert_eq!(bits(&alone(scheme, 0, 0.5)), bits(&alone(scheme, 0, 1.0)));
        let p = changed(driven(scheme), |p| p.n_leaders = 1);
        let mut plain = flock_of(&p, &[([0.0; 3], [0.0; 3])]);
        plain.advance(20.0, Some(&[0.0])).expect("finite motion");
        assert_eq!(bits(&alone(scheme, 1, 1.0)), bits(&plain));
    }
}
