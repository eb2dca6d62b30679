//! Hard cases: scenes that break contact solvers, each with its answer from a formula.
//!
//! On paper: a boat flat on the wall can only slide about the pool's center, with inertia Y² + ρ².

use crate::reference::root;
use crate::support::{
    H, R, RHO, SCHEMES, VELOCITY_SCHEMES, assert_near, assert_solved, changed, crowded,
    deepest_overlap, disc, driven, first_kick_s, flock_of, inert, take_substeps,
};
use flockenv::contact::{Contact, ContactDetector};
use flockenv::geometry::{HullPose, Pose, Velocity};
use flockenv::parameters::{Scheme, Solver};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn a_boat_flat_on_the_wall_hit_off_center() {
    // The boat touches with both ends, its center at distance Y from the pool's: it can only slide about
    // the pool's center, with inertia Y² + ρ². A tip that comes at w and hits its side at offset t gives
    // μ = w/(1 + t²/(Y² + ρ²)); the slide is −μ·t/(Y² + ρ²), and the wall's two impulses have the sum
    // μ·Q/Y and the difference μ·t·Q·Y/(h·(Y² + ρ²)), Q = R_out − r.
    let q: f64 = 90.0 - R;
    let y = (q * q - H * H).sqrt();
    for scheme in SCHEMES {
        for t in [0.0, 1.0, -2.0, 2.4] {
            let p = changed(inert(scheme), |p| p.pool = disc(90.0));
            let states = [
                ([0.0, -y, 0.0], [0.0; 3]),
                ([t, -y + 2.0 * R + H, -FRAC_PI_2], [0.0, -8.0, 0.0]),
            ];
            let mut flock = flock_of(&p, &states);
            take_substeps(&mut flock, 1);
            let inertia = y * y + RHO * RHO;
            let hit = 8.0 / (1.0 + t * t / inertia);
            let spin = -hit * t / inertia;
            let [flat, tip] = [0, 1].map(|i| flock.velocities()[i]);
            assert!((flat.linear.x - y * spin).abs() < 1e-10, "{scheme:?} {t}");
            assert!(flat.linear.y.abs() < 1e-10 && (flat.angular - spin).abs() < 1e-11);
            assert!((tip.linear.y + 8.0 - hit).abs() < 1e-10 && tip.linear.x.abs() < 1e-10);
            let kick = first_kick_s(scheme, 0.02);
            let mut wall: Vec<f64> = flock
                .contacts()
                .iter()
                .filter(|c| c.contact.second().is_none())
                .map(|c| c.force * kick)
                .collect();
            wall.sort_by(f64::total_cmp);
            let (half_sum, half_difference) = (
                0.5 * hit * q / y,
                0.5 * hit * t.abs() * q * y / (H * inertia),
            );
            assert_near(wall[0], half_sum - half_difference, 1e-9, &wall);
            assert_near(wall[1], half_sum + half_difference, 1e-9, &wall);
        }
    }
}

/// Twelve boats nose to tail on the outer wall, in a pool just large enough for the ring to close; the
/// pool's radius, the boats' distance Y from its center and their poses.
fn closed_ring() -> (f64, f64, Vec<Pose>) {
    let n = 12.0;
    let q = root(20.0, 60.0, |q| {
        2.0 * n * ((H / q).asin() + (R / q).asin()) - TAU
    });
    let y = (q * q - H * H).sqrt();
    let poses = (0..12)
        .map(|i| {
            let polar = TAU * f64::from(i) / n;
            Pose::new(y * polar.cos(), y * polar.sin(), polar + FRAC_PI_2)
        })
        .collect();
    (q + R, y, poses)
}

fn ring_flock(p: &FlockParameters, spins: &[f64]) -> (Flock, f64) {
    let (radius, y, poses) = closed_ring();
    let states: Vec<_> = poses
        .iter()
        .zip(spins)
        .map(|(pose, spin)| {
            let (x, z) = (pose.position.x, pose.position.y);
            ([x, z, pose.heading], [-spin * z, spin * x, *spin])
        })
        .collect();
    // Random placement would not find the ring.
    let p = FlockParameters {
        n_boats: 12,
        pool: disc(radius),
        ..p.clone()
    };
    (crowded(&p, &states), y)
}

#[test]
fn a_closed_ring_of_touching_boats_turns_as_one() {
    // 36 contacts, 36 unknowns, and a state of stress that needs no load: the contact matrix is singular.
    // One boat that slides along the wall at ω pushes the eleven others: all continue at ω/12.
    for scheme in VELOCITY_SCHEMES {
        let mut spins = [0.0; 12];
        spins[0] = 0.6;
        let (mut flock, y) = ring_flock(&inert(scheme), &spins);
        take_substeps(&mut flock, 1);
        for (pose, velocity) in flock.poses().iter().zip(flock.velocities()) {
            assert_near(velocity.angular, 0.05, 1e-8, scheme);
            assert!((velocity.linear.norm() - 0.05 * y).abs() < 1e-7, "{pose:?}");
        }
        assert_solved(&flock);
    }
}

#[test]
fn a_closed_ring_under_way_accelerates_as_one_boat_on_a_rail() {
    // On its rail each boat has inertia Y² + ρ² and the engine's torque c0·v0·Y: from rest one kick
    // gives ω = dt·c0·v0·Y/(Y² + ρ²), for moreau exactly.
    let (mut flock, y) = ring_flock(&driven(Scheme::Moreau), &[0.0; 12]);
    take_substeps(&mut flock, 1);
    let expected = 0.02 * 15.0 * y / (y * y + RHO * RHO);
    for velocity in flock.velocities() {
        assert!((velocity.angular - expected).abs() < 1e-9);
    }
    // And a minute later the ring still is one.
    take_substeps(&mut flock, 3000);
    assert!(deepest_overlap(&flock) < 0.01);
    let first = flock.velocities()[0].angular;
    for velocity in flock.velocities() {
        assert_near(velocity.angular, first, 1e-6, "as one");
    }
    let statistics = flock.statistics();
    assert_eq!(statistics.unsolved, 0);
    // Gaps at the wall close as they curve, and those between boats open: with the former alone there is no solution.
    assert!(statistics.halved_substeps <= 3000, "{statistics:?}");
}

/// Accelerations of two boats side by side, one pressed on the other, with every near contact closed.
fn pressed_accelerations(turn: f64, shift: f64) -> Vec<f64> {
    let p = changed(inert(Scheme::Moreau), |p| p.n_boats = 2);
    let poses = [Pose::new(0.0, 0.0, 0.0), Pose::new(shift, 2.0 * R, turn)];
    let boats = poses.map(|pose| HullPose::new(&pose));
    let mut contacts: Vec<Contact> = Vec::new();
    ContactDetector::new(&p).detect(&boats, 1e-6, &mut contacts);
    let scene = crate::solver::Owned {
        biases: vec![0.0; contacts.len()],
        contacts,
        inertia: vec![crate::solver::PLAIN; 2],
        // Accelerations of eq. A.1 take the place of velocities: one boat is pushed down, and turned.
        free: vec![Velocity::default(), Velocity::new(1.0, -15.0, 0.4)],
    };
    assert_eq!(scene.contacts.len(), 2, "both ends are kept");
    let (report, _, found) = scene.solve(Solver::BlockPivoting);
    assert!(report.residual <= 1e-10);
    found
        .iter()
        .flat_map(|v| [v.linear.x, v.linear.y, v.angular])
        .collect()
}

#[test]
fn parallel_hulls_turned_by_a_billionth_accelerate_alike() {
    for shift in [0.0, 1.3, -4.0] {
        let straight = pressed_accelerations(0.0, shift);
        for turn in [1e-9, -1e-9, PI, PI + 1e-9, PI - 1e-9] {
            let turned = pressed_accelerations(turn, shift);
            for (&found, &expected) in turned.iter().zip(&straight) {
                assert_near(found, expected, 1e-7, (shift, turn));
            }
        }
    }
}
