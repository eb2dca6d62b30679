//! A jam: engines always forward, boats pressed outward against the wall and each other, for long.
//! Contacts hold without drift: overlaps do not grow, every solve is exact, nothing heats up.
//!
//! On paper: what engines and drag do to the momentum of the whole flock, the walls take up.

use crate::support::{
    assert_solved, deepest_overlap, driven, kinetic_energy, momentum, table_3, take_substeps,
};
use flockenv::contact::Partner;
use flockenv::flock::ContactForce;
use flockenv::geometry::{Hull, HullPose, Vec2, inner_wall_gap, outer_wall_gap};
use flockenv::parameters::{Pool, Scheme};
use flockenv::{Flock, FlockParameters};

fn jam(n_boats: usize, c4: f64, seed: u64) -> Flock {
    let p = FlockParameters {
        n_boats,
        c4,
        pool: Pool::NARROW,
        dt_s: 0.01,
        ..driven(Scheme::Leapfrog)
    };
    Flock::new(p, seed).expect("room")
}

/// Runs a jam minute by minute; the deepest overlap of each.
fn hold(flock: &mut Flock, minutes: usize) -> Vec<f64> {
    let boats = flock.poses().len() as f64;
    (0..minutes)
        .map(|_| {
            let mut deepest: f64 = 0.0;
            for _ in 0..60 {
                flock.advance(1.0, None).expect("finite motion");
                deepest = deepest.max(deepest_overlap(flock));
            }
            // No boat outruns its engine on average; spins are small.
            assert!(kinetic_energy(flock) < boats * 0.5 * 15.0 * 15.0);
            deepest
        })
        .collect()
}

fn assert_two_jams_hold(minutes: usize) {
    for (n, seed) in [(50, 1), (114, 2)] {
        let mut flock = jam(n, 0.1, seed);
        let overlaps = hold(&mut flock, minutes);
        assert_solved(&flock);
        assert!(flock.statistics().solves > flock.statistics().substeps / 2);
        // The linearization's leftover without relinearization passes, at dt = 0.01 s.
        let shallow = overlaps.iter().all(|&overlap| overlap <= 1e-2);
        assert!(shallow, "{overlaps:?}");
        // Nothing creeps: a minute of the second half is as the first half's. (Medians, since a boat that
        // snaps into another place makes a minute's deepest overlap a few times larger.)
        let median = |part: &[f64]| {
            let mut sorted = part.to_vec();
            sorted.sort_by(f64::total_cmp);
            sorted[sorted.len() / 2]
        };
        let (early, late) = overlaps.split_at(overlaps.len() / 2);
        assert!(median(late) <= 1.5 * median(early) + 5e-4, "{overlaps:?}");
    }
}

#[test]
fn walls_balance_engines_and_drag() {
    // Summed over the flock, contacts between boats cancel and Crank–Nicolson reads, with P = Σv before
    // and after a kick, (P⁺ − P⁻)/dt = c0·v0·Σu − c0·(P⁺ + P⁻)/2 + Σ wall forces, to rounding.
    let mut flock = jam(50, 0.1, 1);
    hold(&mut flock, 1);
    let hull = Hull::new(flock.parameters());
    for _ in 0..100 {
        let before = momentum(&flock);
        let boats: Vec<HullPose> = flock.poses().iter().map(HullPose::new).collect();
        take_substeps(&mut flock, 1);
        let after = momentum(&flock);
        let engines: Vec2 = boats.iter().map(|b| b.axis * 15.0).sum();
        let mut walls = Vec2::zeros();
        let mut carrying = 0;
        for ContactForce { contact, force, .. } in flock.contacts() {
            let boat = &boats[contact.boat as usize];
            let side = contact.feature.side().unwrap_or(-1.0);
            walls += force
                * match contact.partner {
                    Partner::OuterWall => outer_wall_gap(boat, side, hull, 90.0).normal,
                    Partner::InnerWall => inner_wall_gap(boat, hull, 48.5).normal,
                    Partner::Boat(_) | Partner::Obstacle(_) => continue,
                };
            carrying += usize::from(force > 0.0);
        }
        assert!(carrying > 10, "a jam leans on its wall");
        let left = (after - before) / 0.01 - engines + (after + before) * 0.5 - walls;
        assert!(left.norm() < 1e-8, "{left}");
    }
}

#[test]
fn jams_hold_for_minutes() {
    assert_two_jams_hold(2);
}

#[test]
#[ignore = "an hour of 50 boats, then of 114: minutes of computing"]
fn jams_hold_for_hours() {
    assert_two_jams_hold(60);
}

#[test]
fn the_longest_step_of_the_explicit_schemes_stays_bounded() {
    // Collisions spin boats at more than the 4.7 rad/s beyond which −c1·α̇³ alone would make explicit
    // steps of 0.1 s grow without end. An engine can push no boat past its speed.
    for scheme in [Scheme::Moreau, Scheme::Paper] {
        for tolerance_cm in [f64::INFINITY, 1e-4] {
            for seed in 1..=4 {
                let p = FlockParameters {
                    scheme,
                    tolerance_cm,
                    n_boats: 27,
                    bw_s: 2.0,
                    dt_s: scheme.longest_dt_s(),
                    pool: Pool::NARROW,
                    ..table_3()
                };
                let mut flock = Flock::new(p, seed).expect("27 boats fit");
                for _ in 0..80 {
                    flock.advance(1.0, None).expect("bounded motion");
                    let fastest = flock.velocities().iter().map(|v| v.linear.norm());
                    let fastest = fastest.fold(0.0, f64::max);
                    assert!(
                        fastest < 60.0,
                        "{scheme:?} {tolerance_cm} {seed}: {fastest} cm/s"
                    );
                }
            }
        }
    }
}
