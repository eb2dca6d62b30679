//! What a solve costs, counted: rounds of pivoting, islands, rows factored, contacts, neighbor lists
//! built. A slowdown shows here without a stopwatch.
//!
//! On paper: one boat at rest against a wall has one contact, one island and one round a substep; a
//! contact alone in its island needs no guess and no factor.

use crate::support::{
    VELOCITY_SCHEMES, assert_near, assert_solved, bits, changed, disc, disc_at, driven, flock_of,
    inert, table_3, take_substeps,
};
use flockenv::contact::Statistics;
use flockenv::parameters::{Pool, Scheme};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::PI;

/// What 100 substeps of boats nose to tail at the wall did.
fn row_at_the_wall(boats: u64) -> Statistics {
    let p = changed(driven(Scheme::Leapfrog), |p| p.pool = disc(90.0));
    let places = (0..boats).map(|i| ([82.5 - 15.0 * i as f64, 0.0, 0.0], [0.0; 3]));
    let mut flock = flock_of(&p, &places.collect::<Vec<_>>());
    take_substeps(&mut flock, 100);
    assert_solved(&flock);
    *flock.statistics()
}

#[test]
fn one_boat_at_the_wall() {
    let statistics = row_at_the_wall(1);
    assert_eq!((statistics.substeps, statistics.solves), (100, 100));
    assert_eq!((statistics.contacts, statistics.islands), (100, 100));
    assert_eq!(statistics.solver_iterations, 100);
    assert_eq!(statistics.factored_rows, 0);
    assert_eq!(statistics.most_factor_entries, 0);
    assert_eq!(statistics.neighbor_builds, 1);
    assert_eq!(statistics.depenetration_passes, 0);
}

#[test]
fn a_slide_along_a_curve_needs_one_solve_a_substep() {
    // A gap taken as linear would overlap by v²·dt²/(2·85 cm), 2e-4 cm at 10 cm/s, and be solved again each time.
    for scheme in VELOCITY_SCHEMES {
        let p = changed(driven(scheme), |p| p.pool = disc(90.0));
        let mut flock = flock_of(&p, &[([82.0, 0.0, 1.2], [0.0; 3])]);
        flock.advance(5.0, None).expect("finite motion");
        assert!(flock.velocities()[0].linear.norm() > 10.0);
        let before = *flock.statistics();
        take_substeps(&mut flock, 200);
        let now = flock.statistics();
        assert!(now.contacts - before.contacts >= 200);
        assert_eq!(now.solves - before.solves, 200, "{scheme:?}");
        assert!(now.worst_overlap_cm < 1e-4);
    }
}

#[test]
fn curves_that_open_a_gap_change_nothing() {
    // Two bows that push each other aside, and a bow that slides along the inner wall or a post: their gaps open as they
    // curve, so that nothing overlaps and linear gaps lead to the same bits.
    let two = [
        ([-7.0, 0.0, 0.0], [10.0, 0.0, 0.0]),
        ([7.0, 5.0, PI], [-10.0, 0.0, 0.0]),
    ];
    let one = [([-18.0, 6.0, 0.0], [10.0, 0.0, 0.0])];
    for scheme in VELOCITY_SCHEMES {
        let open = driven(scheme);
        let inner = changed(open.clone(), |p| p.pool.inner_radius_cm = 9.0);
        let post = changed(open.clone(), |p| p.discs = vec![disc_at(0.0, 0.0, 9.0)]);
        let scenes = [(&open, &two[..]), (&inner, &one), (&post, &one)];
        for (number, (p, states)) in scenes.into_iter().enumerate() {
            let flock = |tolerance_cm: f64| {
                flock_of(
                    &changed(p.clone(), |p| p.tolerance_cm = tolerance_cm),
                    states,
                )
            };
            let (mut ours, mut linear) = (flock(1e-4), flock(f64::INFINITY));
            let mut pushes = 0;
            for _ in 0..50 {
                take_substeps(&mut ours, 1);
                take_substeps(&mut linear, 1);
                pushes += ours.contacts().iter().filter(|c| c.force > 0.0).count();
                assert_eq!(bits(&ours), bits(&linear), "{scheme:?} scene {number}");
            }
            assert!(pushes > 10, "{scheme:?} scene {number}: {pushes}");
        }
    }
}

#[test]
fn a_row_factors_each_contact_once_a_substep() {
    for k in [3_u64, 6] {
        let statistics = row_at_the_wall(k);
        assert_eq!(statistics.contacts, 100 * k);
        assert_eq!(statistics.islands, 100);
        // Warm starts cost one round; the first substep at most one more a contact.
        assert!((101..=100 + k).contains(&statistics.solver_iterations));
        assert_eq!(statistics.factored_rows, 100 * k);
        // A chain's factor is bidiagonal, in one order or the other.
        assert_eq!(statistics.most_factor_entries, 2 * k - 1);
    }
}

#[test]
fn two_contacts_need_no_factor() {
    let statistics = row_at_the_wall(2);
    assert_eq!((statistics.contacts, statistics.islands), (200, 100));
    assert_eq!(statistics.solver_iterations, 100);
    assert_eq!(statistics.factored_rows, 0);
}

#[test]
fn contacts_apart_are_islands_of_their_own() {
    let mut states = Vec::new();
    for pair in 0..5 {
        let y = 30.0 * f64::from(pair);
        states.push(([0.0, y, 0.0], [1.0, 0.0, 0.0]));
        states.push(([15.0, y, 0.0], [-1.0, 0.0, 0.0]));
    }
    let mut flock = flock_of(&inert(Scheme::Moreau), &states);
    take_substeps(&mut flock, 1);
    let statistics = flock.statistics();
    assert_eq!((statistics.islands, statistics.contacts), (5, 5));
    assert_eq!(statistics.solver_iterations, 5);
    assert_eq!(statistics.factored_rows, 0);
}

#[test]
fn boats_that_stay_within_their_skin_share_one_neighbor_list() {
    let p = changed(inert(Scheme::Leapfrog), |p| p.pool = disc(90.0));
    // Drifting together at 1 cm/s: the skin of 0.8 radii is used up every 2 s, at half its width.
    let states: Vec<_> = (0..4)
        .map(|i| ([-30.0, 20.0 * f64::from(i) - 30.0, 0.0], [1.0, 0.0, 0.0]))
        .collect();
    let mut flock = flock_of(&p, &states);
    flock.advance(20.0, None).expect("finite motion");
    let builds = flock.statistics().neighbor_builds;
    assert!((9..=11).contains(&builds), "{builds}");
}

#[test]
fn contacts_that_part_are_solved_for_only_if_others_close_them() {
    // Boats in a row, gaps of 0.1 and 0.5 cm. In 0.1 s the third parts from the second by another 0.5 cm. One that
    // comes at 30 cm/s pushes the second by more than that: on paper 14, 13 and 8 cm/s close both gaps and keep the
    // momentum. At 10 cm/s the two share their velocities, and leave the third alone.
    for scheme in VELOCITY_SCHEMES {
        for (fast, expected, contacts) in [(30.0, [14.0, 13.0, 8.0], 2), (10.0, [5.5, 4.5, 5.0], 1)]
        {
            let p = FlockParameters {
                dt_s: 0.1,
                tolerance_cm: 1e-6,
                ..inert(scheme)
            };
            let states = [
                ([0.0, 0.0, 0.0], [fast, 0.0, 0.0]),
                ([15.1, 0.0, 0.0], [0.0; 3]),
                ([30.6, 0.0, 0.0], [5.0, 0.0, 0.0]),
            ];
            let mut flock = flock_of(&p, &states);
            take_substeps(&mut flock, 1);
            assert_eq!(flock.statistics().contacts, contacts, "{scheme:?} {fast}");
            for (velocity, speed) in flock.velocities().iter().zip(expected) {
                assert_near(velocity.linear.x, speed, 1e-9, velocity);
            }
        }
    }
}

/// Twenty seconds of a scene after ten of warm-up, counted per substep.
fn counted(n_boats: usize, bw_s: f64) -> (Statistics, f64) {
    let p = FlockParameters {
        n_boats,
        pool: Pool::NARROW,
        dt_s: 0.01,
        fw_s: 2.0,
        nop1_s: if bw_s > 0.0 { 1.0 } else { 0.0 },
        bw_s,
        nop2_s: if bw_s > 0.0 { 1.0 } else { 0.0 },
        ..table_3()
    };
    let mut flock = Flock::new(p, 6).expect("room");
    flock.advance(10.0, None).expect("finite motion");
    let before = *flock.statistics();
    flock.advance(20.0, None).expect("finite motion");
    let mut s = *flock.statistics();
    s.substeps -= before.substeps;
    s.solves -= before.solves;
    s.contacts -= before.contacts;
    s.islands -= before.islands;
    s.solver_iterations -= before.solver_iterations;
    s.factored_rows -= before.factored_rows;
    s.neighbor_builds -= before.neighbor_builds;
    (s, s.substeps as f64)
}

#[test]
fn crowded_scenes_cost_what_they_did() {
    // Chaotic scenes: their counts move by some per cent with the last bits of sine and cosine. A fifth
    // more is a slowdown; less than half is a gain that these numbers should follow.
    for (n, bw, islands, rounds_per_island, rows, contacts, builds) in [
        (27, 0.0, 6.89, 1.26, 49.8, 52.7, 0.062),
        (27, 1.0, 6.23, 1.02, 0.68, 8.29, 0.041),
        (50, 0.0, 8.55, 1.28, 94.0, 95.9, 0.07),
    ] {
        let (s, substeps) = counted(n, bw);
        let found = [
            s.islands as f64 / substeps,
            s.solver_iterations as f64 / s.islands as f64,
            s.factored_rows as f64 / substeps,
            s.contacts as f64 / substeps,
            s.neighbor_builds as f64 / substeps,
        ];
        let expected = [islands, rounds_per_island, rows, contacts, builds];
        for (f, e) in found.iter().zip(expected) {
            assert!((0.5..1.2).contains(&(f / e)), "{n} {bw}: {found:?}");
        }
        assert_eq!(s.unsolved, 0);
        assert!(s.worst_residual_cm_s <= 1e-10);
    }
}

/// Boats side by side along the outer wall, facing it, in rows over three quarters of it.
fn rows_along_the_wall(p: &FlockParameters, outer_cm: f64) -> Vec<([f64; 3], [f64; 3])> {
    let (radius, room) = (p.boat_radius_cm, 1.001);
    let core = radius * p.boat_shape;
    let (mut states, mut wall) = (Vec::new(), outer_cm);
    while states.len() < p.n_boats {
        let center = wall - room * (core + radius);
        let apart = 2.0 * (room * radius / (center - core)).asin();
        let places = (1.5 * PI / apart) as usize;
        for place in 0..places.min(p.n_boats - states.len()) {
            let angle = apart * place as f64;
            states.push((
                [center * angle.cos(), center * angle.sin(), angle],
                [0.0; 3],
            ));
        }
        wall = center - core - radius;
    }
    states
}

#[test]
fn pivoting_that_cycles_in_a_large_jam_costs_no_round_per_contact() {
    // Two rows press outward: hundreds of contacts in one island depend on each other.
    let p = FlockParameters {
        n_boats: 800,
        pool: disc(1610.0),
        dt_s: 0.1,
        bw_s: 0.0,
        ..table_3()
    };
    let mut flock = flock_of(&p, &rows_along_the_wall(&p, 1610.0));
    let mut most = 0;
    for _ in 0..40 {
        let before = flock.statistics().solver_iterations;
        take_substeps(&mut flock, 1);
        most = most.max(flock.statistics().solver_iterations - before);
    }
    let statistics = flock.statistics();
    assert!(statistics.contacts > 40 * 2000);
    // A descent from no impulses takes some 2000 rounds; pivoting alone ends in some 10.
    assert!((20..200).contains(&most), "{most}");
    assert_solved(&flock);
}
