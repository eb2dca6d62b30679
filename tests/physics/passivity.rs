//! Contacts are plastic: they take energy out of the boats they join. Nothing that a substep does to foresee
//! where curved hulls and walls will touch may drive a boat, however far it turns in the substep.
//!
//! The hard scene is a channel of 20 cm: hulls of 10 × 15 cm get wedged between its walls while they turn, and
//! a flank on the inner wall passes from one end of the hull to the other within 0.1 rad.
//!
//! On paper: without engines and drag, kinetic energy never grows, but for what opening overlaps takes; and no
//! free boat is driven past the spin at which c1·w³ = (c2·s − c3·w)·u·ẋ.

use crate::support::{
    OPEN_WATER, R, TOLERANCES, VELOCITY_SCHEMES, annulus, backing, deepest_overlap, disc_at,
    flock_of, inert, kinetic_energy, set_off, table_3, take_substeps,
};
use flockenv::geometry::Velocity;
use flockenv::parameters::{Pool, Scheme};
use flockenv::{Flock, FlockParameters};

const CHANNEL: Pool = annulus(80.0, 60.0);

fn substeps(scheme: Scheme) -> &'static [f64] {
    match scheme {
        Scheme::Leapfrog => &[0.02, 0.1, 0.5, 1.0],
        Scheme::Moreau | Scheme::Paper => &[0.02, 0.1],
    }
}

#[test]
fn rudders_thrown_about_in_a_channel_wedge_no_boat_out() {
    for scheme in VELOCITY_SCHEMES {
        for &dt_s in substeps(scheme) {
            for tolerance_cm in TOLERANCES {
                for seed in 0..2 {
                    let p = FlockParameters {
                        n_boats: 20,
                        n_leaders: 20,
                        pool: CHANNEL,
                        dt_s,
                        tolerance_cm,
                        scheme,
                        ..table_3()
                    };
                    let mut flock = Flock::new(p, seed).expect("room");
                    for step in 0..300 {
                        let rudder: Vec<_> = (0..20)
                            .map(|i| if (i + step) % 2 == 0 { 1.0 } else { -1.0 })
                            .collect();
                        flock.advance(0.1, Some(&rudder)).expect("finite motion");
                        let fastest = flock.velocities().iter();
                        let fastest = fastest.map(|v| v.linear.norm()).fold(0.0, f64::max);
                        // Twice what an engine gives.
                        assert!(
                            fastest < 30.0,
                            "{scheme:?} {dt_s} {tolerance_cm} {seed}: {fastest} cm/s"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn spinning_hulls_in_a_channel_never_gain_energy() {
    for scheme in VELOCITY_SCHEMES {
        for dt_s in [0.02, 0.1] {
            for tolerance_cm in TOLERANCES {
                let p = FlockParameters {
                    n_boats: 20,
                    pool: CHANNEL,
                    dt_s,
                    tolerance_cm,
                    ..inert(scheme)
                };
                let mut flock = set_off(p, 1, |boat, _| {
                    Velocity::new(0.0, 0.0, 4.0 * ((boat % 5) as f64 - 2.0))
                });
                let mut before = kinetic_energy(&flock);
                for step in 0..300 {
                    let overlap = deepest_overlap(&flock).min(0.01);
                    take_substeps(&mut flock, 1);
                    let kick = if step == 0 { 0.5 * dt_s } else { dt_s };
                    let impulses: f64 = flock.contacts().iter().map(|c| c.force * kick).sum();
                    let now = kinetic_energy(&flock);
                    let most = 1.01 * (before + impulses * overlap / dt_s);
                    assert!(
                        now <= most,
                        "{scheme:?} {dt_s} {tolerance_cm} {step}: {before} {now}"
                    );
                    before = now;
                }
            }
        }
    }
}

#[test]
fn a_flank_between_obstacles_is_not_turned_back() {
    // A post above the flank ahead of one below it: a counter-clockwise spin carries the hull into both, which stops it.
    // The smaller their distance along the hull, the further looking ahead along the curves would throw the spin back.
    for scheme in VELOCITY_SCHEMES {
        for (above, below) in [(0.25, -0.08), (0.4, 0.1), (2.4, -2.1), (-1.0, -1.6)] {
            for (radius, spin) in [(0.1, 4.0), (0.5, 1.6), (6.0, 3.0), (30.0, 0.7)] {
                let p = FlockParameters {
                    pool: OPEN_WATER,
                    discs: vec![
                        disc_at(below, -(R + radius), radius),
                        disc_at(above, R + radius, radius),
                    ],
                    dt_s: 0.02,
                    ..inert(scheme)
                };
                let mut flock = flock_of(&p, &[([0.0; 3], [0.0, 0.0, spin])]);
                let before = kinetic_energy(&flock);
                flock.advance(0.02, None).expect("finite motion");
                let kept = kinetic_energy(&flock) / before;
                assert!(kept < 1e-4, "{scheme:?} {below} {above} {radius}: {kept}");
            }
        }
    }
}

#[test]
fn no_backing_boat_is_driven_past_its_turn() {
    // Backing at 15 cm/s, s = 0: at most sqrt(c3·15/c1).
    let p = FlockParameters {
        reverse_speed_cm_s: 15.0,
        ..backing(Scheme::Leapfrog)
    };
    let most = (p.c3 * 15.0 / p.c1).sqrt();
    for dt_s in [0.02, 0.1, 0.5, 1.0] {
        for spin in [0.01, 0.3, 1.0, 1.5, 3.0] {
            let p = FlockParameters {
                dt_s,
                pool: OPEN_WATER,
                ..p.clone()
            };
            let mut flock = flock_of(&p, &[([0.0; 3], [-15.0, 0.0, spin])]);
            for _ in 0..20 {
                take_substeps(&mut flock, 1);
                let found = flock.velocities()[0].angular.abs();
                assert!(found <= most, "{dt_s} {spin}: {found} rad/s");
            }
        }
    }
}

#[test]
fn substeps_cut_for_their_contacts_go_on_from_a_snapshot() {
    let p = FlockParameters {
        n_boats: 20,
        pool: CHANNEL,
        dt_s: 0.5,
        tolerance_cm: 1e-6,
        ..table_3()
    };
    let mut flock = Flock::new(p, 3).expect("room");
    for _ in 0..60 {
        let mut copy = Flock::from_snapshot(&flock.snapshot(), None).expect("its own snapshot");
        for flock in [&mut flock, &mut copy] {
            flock.advance(0.5, None).expect("finite motion");
        }
        assert_eq!(flock.poses(), copy.poses());
        assert_eq!(flock.velocities(), copy.velocities());
    }
    // 60 of 0.5 s and 7 phase switches off their grid; the rest was cut for contacts.
    assert!(flock.statistics().substeps > 90, "{:?}", flock.statistics());
}
