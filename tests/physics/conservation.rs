//! Contacts act between two bodies along one line: in open water momentum and angular momentum are
//! conserved. They are plastic: no impact adds energy.
//!
//! On paper: two boats that meet head on with opposite speeds stop, with nothing left of either.

use crate::support::{
    OPEN_WATER, R, SCHEMES, VELOCITY_SCHEMES, angular_momentum, assert_near, cases, changed,
    core_distance, crowded, deepest_overlap, disc, first_kick_s, flock_of, inert, kinetic_energy,
    momentum, set_off, take_substeps,
};
use flockenv::contact::Partner;
use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::{Pool, Scheme};
use flockenv::{Flock, FlockParameters};
use proptest::prelude::*;

#[test]
fn opposite_momenta_cancel() {
    for scheme in SCHEMES {
        let states = [
            ([0.0, 0.0, 0.0], [9.0, 0.0, 0.0]),
            ([15.0, 0.0, 0.0], [-9.0, 0.0, 0.0]),
        ];
        let mut flock = flock_of(&inert(scheme), &states);
        take_substeps(&mut flock, 10);
        assert!(momentum(&flock).norm() < 1e-12);
        assert!(kinetic_energy(&flock) < 1e-20);
    }
}

#[test]
fn angular_momentum_that_overlaps_cost_is_counted() {
    // Side by side, 9 cm apart in place of 10, and sliding past each other at ±6 cm/s: the least
    // displacement takes each half a centimeter outward, which adds 2·0.5·6 = 6 cm²/s. It stops a
    // thousandth of a centimeter short of touching.
    for scheme in VELOCITY_SCHEMES {
        let states = [
            ([0.0, 4.5, 0.0], [6.0, 0.0, 0.0]),
            ([0.0, -4.5, 0.0], [-6.0, 0.0, 0.0]),
        ];
        let mut flock = crowded(&inert(scheme), &states);
        let before = angular_momentum(&flock);
        take_substeps(&mut flock, 1);
        let counted = flock.statistics().displaced_angular_momentum_cm2_s;
        let gained = angular_momentum(&flock) - before;
        assert_near(gained.abs(), counted, 1e-9, scheme);
        assert!((counted - 6.0).abs() < 0.01, "{scheme:?}: {counted}");
    }
}

/// A boat's random velocity, up to `speed` in each component. A fixed recipe in place of a generator:
/// irrational steps around the circle.
fn random_velocity(boat: usize, seed: u64, speed: f64) -> Velocity {
    let phase = 2.399_963 * (boat as f64 + seed as f64 * 0.618);
    let rate = speed * (0.3 + 0.7 * (0.755 * boat as f64).fract());
    Velocity::new(rate * phase.cos(), rate * phase.sin(), (3.0 * phase).sin())
}

/// A flock placed at random with random velocities.
fn scattered(p: &FlockParameters, n_boats: usize, seed: u64, speed: f64) -> Flock {
    let p = changed(p.clone(), |p| p.n_boats = n_boats);
    set_off(p, seed, |boat, _| random_velocity(boat, seed, speed))
}

/// Boats in open water drawn together towards the middle, so that they collide there.
fn imploding(scheme: Scheme, n_boats: usize, seed: u64) -> Flock {
    let p = FlockParameters {
        n_boats,
        pool: OPEN_WATER,
        ..inert(scheme)
    };
    set_off(p, seed, |boat, pose| {
        let mut velocity = random_velocity(boat, seed, 3.0);
        velocity.linear -= pose.position * 0.5;
        velocity
    })
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn momentum_and_angular_momentum_are_conserved(seed in 0_u64..1000, n in 2_usize..24) {
        for scheme in SCHEMES {
            let mut flock = imploding(scheme, n, seed);
            let (before, spin_before) = (momentum(&flock), angular_momentum(&flock));
            take_substeps(&mut flock, 250);
            prop_assert!(flock.statistics().solves > 0 || n < 4);
            // Rounding: some 1e4 impulses of order 100 cm/s, and lever arms of 100 cm.
            prop_assert!((momentum(&flock) - before).norm() < 1e-9);
            // Moving poses out of deep overlaps changes angular momentum, which is counted.
            let counted = flock.statistics().displaced_angular_momentum_cm2_s;
            prop_assert!(counted == 0.0 || flock.statistics().depenetration_passes > 0);
            let gained = angular_momentum(&flock) - spin_before;
            prop_assert!(gained.abs() < 1e-7 + counted);
        }
    }

    #[test]
    fn no_impact_adds_energy(seed in 0_u64..1000, n in 2_usize..28) {
        // Without drag, so that nothing hides a gain. Where hulls overlap by rounding or by what the
        // linearization leaves, gaps g < 0 have to open, and a flank that turns by dt·ω on the inner
        // wall has to lift off by (R_in + r)·(dt·ω)²/2: with v⁺ = v⁻ + M⁻¹·Jᵀ·λ the energy changes by
        // λ·J·v⁺ − λ·A·λ/2 ≤ Σλ·(−g + lift)/dt, and by nothing more.
        for scheme in VELOCITY_SCHEMES {
            let p = FlockParameters { pool: Pool::NARROW, ..inert(scheme) };
            let mut flock = scattered(&p, n, seed, 12.0);
            let start = kinetic_energy(&flock);
            let mut before = start;
            for step in 0..150 {
                let spins = flock.velocities().iter().map(|v| v.angular.abs());
                let turn = 0.02 * spins.fold(0.0, f64::max);
                let lift = 0.5 * (p.pool.inner_radius_cm + R + 1e-2) * turn * turn;
                let overlap = deepest_overlap(&flock);
                take_substeps(&mut flock, 1);
                let kick = if step == 0 { first_kick_s(scheme, 0.02) } else { 0.02 };
                let contacts = flock.contacts();
                let impulses: f64 = contacts.iter().map(|c| c.force * kick).sum();
                let lifting = contacts.iter().filter(|c| c.contact.partner == Partner::InnerWall);
                let lifting: f64 = lifting.map(|c| c.force * kick).sum();
                let now = kinetic_energy(&flock);
                let most = before * (1.0 + 1e-13) + (impulses * overlap + lifting * lift) / 0.02;
                prop_assert!(now <= most, "{scheme:?}: {before} to {now}, at most {most}");
                prop_assert!(now <= start * (1.0 + 1e-13));
                before = now;
            }
        }
    }

    #[test]
    fn hulls_stay_apart(seed in 0_u64..1000, n in 2_usize..28) {
        // Overlap after a substep is what the linearization leaves: at most |d²gap/dt²|·dt²/2. A core
        // end moves at 60 cm/s at the very most here, past something of radius 10 cm or more.
        for scheme in VELOCITY_SCHEMES {
            let p = FlockParameters { pool: Pool::NARROW, ..inert(scheme) };
            let mut flock = scattered(&p, n, seed, 12.0);
            for _ in 0..30 {
                take_substeps(&mut flock, 5);
                let bound = 0.5 * 60.0_f64.powi(2) / (2.0 * R) * 0.02_f64.powi(2);
                prop_assert!(deepest_overlap(&flock) < bound);
                for (i, a) in flock.poses().iter().enumerate() {
                    for b in &flock.poses()[..i] {
                        prop_assert!(core_distance(a, b, 2.5) > 2.0 * R - bound);
                    }
                }
            }
        }
    }
}

#[test]
fn a_lone_boat_keeps_its_energy_along_a_round_wall_but_for_the_chords() {
    // A disc that slides inside a circle of radius Q turns by δ = v·dt/Q a substep. The first chord
    // leaves the circle by Q·δ²/2; from then on the wall turns an outward δ·v/2 into an inward one on
    // each chord, which costs nothing. So v² shrinks by 1 − δ² + δ²/4 once, and by O(δ⁴) a substep.
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            pool: disc(90.0),
            boat_shape: 0.0,
            ..inert(scheme)
        };
        let mut flock = flock_of(&p, &[([85.0, 0.0, 0.0], [0.0, 10.0, 0.0])]);
        take_substeps(&mut flock, 500);
        let delta: f64 = 10.0 * 0.02 / 85.0;
        let expected = 50.0 * (1.0 - 0.75 * delta * delta);
        let before = kinetic_energy(&flock);
        let slack = 50.0 * 500.0 * delta.powi(4);
        assert!((before - expected).abs() < slack, "{before} {expected}");
        assert!(before < 50.0);
        let at = flock.poses()[0].position.norm();
        assert!((at - 85.0).abs() < 85.0 * delta * delta);
    }
}

#[test]
fn poses_reported_are_finite_and_inside() {
    let p = changed(inert(Scheme::Leapfrog), |p| p.pool = Pool::NARROW);
    let mut flock = scattered(&p, 27, 5, 15.0);
    take_substeps(&mut flock, 500);
    let inside = |p: &Pose| (48.5..90.0).contains(&p.position.norm());
    assert!(flock.poses().iter().all(|p| p.is_finite() && inside(p)));
}
