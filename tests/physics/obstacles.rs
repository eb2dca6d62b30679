//! Discs and walls in the water: a disc is an inner wall anywhere, a wall a hull without a radius that does not move.
//!
//! On paper: gaps beside a wall, at its end and at a disc; impulses λ = −v_n/(1 + l²/ρ²); a disc in the middle of the
//! pool is its inner wall, bit for bit.

use crate::support::{
    H, NOISES, OPEN_WATER, R, RHO, SCHEMES, bits, busy, cases, crowded, deepest_overlap, disc_at,
    driven, flock_of, inert, refused_field, segment_distance, table_3, take_substeps, wall,
    wall_ends,
};
use flockenv::flock::{Change, State};
use flockenv::geometry::{Gap, Hull, HullPose, Obstacle, PairFeature, Pose, Vec2};
use flockenv::parameters::{Disc, Noise, Pool, Scheme, Wall};
use flockenv::{Flock, FlockError, FlockParameters};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const HULL: Hull = Hull {
    radius: R,
    half_length: H,
};

fn gaps(boat: &Pose, obstacle: &Obstacle, margin: f64) -> Vec<(PairFeature, Gap)> {
    let mut found = Vec::new();
    obstacle.gaps(&HullPose::new(boat), HULL, margin, &mut |feature, gap| {
        found.push((feature, gap));
    });
    found
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn gaps_known_on_paper() {
    // Flat along a wall 1 cm away: one contact for each end, pushed straight off it, with opposite arms.
    let along = Obstacle::from(&wall((-50.0, -6.0), (50.0, -6.0)));
    let found = gaps(&Pose::new(0.0, 0.0, 0.0), &along, 2.0);
    assert_eq!(found.len(), 2);
    for ((feature, gap), side) in found.iter().zip([-1.0, 1.0]) {
        assert_eq!(*feature as u8, u8::from(side > 0.0));
        assert!(near(gap.gap, 1.0) && near(gap.normal.y, 1.0) && near(gap.normal.x, 0.0));
        assert!(near(gap.along, side * H) && near(gap.arm_i, side * H));
        assert!(gap.bend == 0.0 && gap.arm_j == 0.0);
    }
    // The wall's end at the flank: one contact, whichever way the wall is drawn and the boat leans.
    for ends in [
        wall((1.5, -6.0), (1.5, -90.0)),
        wall((1.5, -90.0), (1.5, -6.0)),
    ] {
        for heading in [0.0, 1e-9, -1e-9] {
            let found = gaps(&Pose::new(0.0, 0.0, heading), &Obstacle::from(&ends), 2.0);
            assert_eq!(found.len(), 1, "{heading}");
            let gap = found[0].1;
            assert!((gap.gap - 1.0).abs() < 1e-8 && (gap.arm_i - 1.5).abs() < 1e-8);
            assert!((gap.bend + 6.0).abs() < 1e-8);
        }
    }
    // Bow on to the end of a wall, and to a disc.
    let ahead = Pose::new(-8.5, 0.0, 0.0);
    for obstacle in [
        Obstacle::from(&wall((0.0, 0.0), (40.0, 0.0))),
        Obstacle::from(&disc_at(30.0, 0.0, 30.0)),
    ] {
        let found = gaps(&ahead, &obstacle, 2.0);
        assert_eq!(found.len(), 1);
        let gap = found[0].1;
        assert!(near(gap.gap, 1.0) && near(gap.normal.x, -1.0) && near(gap.arm_i, 0.0));
        assert!(near(gap.along, H) && gap.bend == 0.0);
    }
    // A core across a wall counts as crossed: back over the wall by the shorter end, and by r more.
    let found = gaps(
        &Pose::new(-1.0, 0.0, 0.0),
        &Obstacle::from(&wall((0.0, -9.0), (0.0, 9.0))),
        2.0,
    );
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, PairFeature::Crossed);
    assert!(near(found[0].1.gap, -(H - 1.0) - R) && near(found[0].1.normal.x, -1.0));
}

#[test]
fn distances_known_on_paper() {
    let ring = Obstacle::from(&disc_at(10.0, 0.0, 4.0));
    assert!(near(ring.distance(Vec2::new(10.0, 7.0)), 3.0));
    assert!(near(ring.distance(Vec2::new(10.0, 1.0)), -3.0));
    let beam = Obstacle::from(&wall((0.0, 0.0), (10.0, 0.0)));
    assert!(near(beam.distance(Vec2::new(4.0, -2.0)), 2.0));
    assert!(near(beam.distance(Vec2::new(13.0, 4.0)), 5.0));
}

fn slope(gap: &Gap, direction: usize) -> f64 {
    [gap.normal.x, gap.normal.y, gap.arm_i][direction]
}

fn displaced(pose: &Pose, direction: usize, step: f64) -> Pose {
    let mut numbers = [pose.position.x, pose.position.y, pose.heading];
    numbers[direction] += step;
    Pose::new(numbers[0], numbers[1], numbers[2])
}

fn pose() -> impl Strategy<Value = Pose> {
    (-15.0..15.0_f64, -15.0..15.0_f64, -7.0..7.0_f64).prop_map(|(x, y, a)| Pose::new(x, y, a))
}

/// Walls shorter and longer than the hull.
fn any_wall() -> impl Strategy<Value = Wall> {
    let end = || (-40.0..40.0_f64, -40.0..40.0_f64);
    let long = (end(), end()).prop_map(|(a, b)| wall(a, b));
    let short = ((-5.0..5.0_f64, -5.0..5.0_f64), 0.01..4.0_f64, 0.0..7.0_f64)
        .prop_map(|((x, y), l, a)| wall((x, y), (x + l * a.cos(), y + l * a.sin())));
    prop_oneof![long, short].prop_filter("a length", |wall| wall.length_cm() > 0.01)
}

fn core(boat: &Pose) -> (Vec2, Vec2) {
    let axis = Vec2::new(boat.heading.cos(), boat.heading.sin()) * H;
    (boat.position - axis, boat.position + axis)
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn the_least_gap_to_a_wall_is_the_distance_of_core_and_wall(a in pose(), w in any_wall()) {
        let distance = segment_distance(core(&a), wall_ends(&w));
        let found = gaps(&a, &Obstacle::from(&w), 100.0);
        prop_assert!(!found.is_empty() && found.len() <= 2);
        let least = found.iter().map(|(_, g)| g.gap).fold(f64::INFINITY, f64::min);
        if distance == 0.0 {
            prop_assert!(found[0].0 == PairFeature::Crossed && least <= -R);
        } else {
            prop_assert!((least - (distance - R)).abs() < 1e-9, "{least} {distance}");
        }
    }

    #[test]
    fn the_gap_to_a_disc_is_the_distance_of_core_and_disc(
        a in pose(), x in -30.0..30.0_f64, y in -30.0..30.0_f64, radius in 0.1..40.0_f64,
    ) {
        let center = Vec2::new(x, y);
        let distance = segment_distance(core(&a), (center, center));
        let found = gaps(&a, &Obstacle::from(&disc_at(x, y, radius)), 100.0);
        prop_assert_eq!(found.len(), 1);
        prop_assert!((found[0].1.gap - (distance - R - radius)).abs() < 1e-9);
    }

    #[test]
    fn a_gap_changes_as_its_normal_and_arm_say(a in pose(), w in any_wall()) {
        let (step, obstacle) = (1e-5, Obstacle::from(&w));
        for (feature, gap) in gaps(&a, &obstacle, 20.0) {
            // Curvature is at most 1/distance a unit of displacement squared; near crossing there is none.
            if feature == PairFeature::Crossed || gap.gap < -4.0 {
                continue;
            }
            for direction in 0..3 {
                let at = |s: f64| {
                    let moved = HullPose::new(&displaced(&a, direction, s));
                    obstacle.gap(feature, &moved, HULL).gap
                };
                let measured = (at(step) - at(-step)) / (2.0 * step);
                prop_assert!((measured - slope(&gap, direction)).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn the_bend_is_the_gap_s_second_derivative_at_a_wall_s_end(
        t in -2.4..2.4_f64, d in 5.0..9.0_f64, heading in -3.0..3.0_f64,
    ) {
        // The wall leaves the boat at a right angle from a point at t along the core and d beside it.
        let (sin, cos) = f64::sin_cos(heading);
        let at = |along: f64, beside: f64| (along * cos - beside * sin, along * sin + beside * cos);
        let obstacle = Obstacle::from(&wall(at(t, d), at(t, d + 40.0)));
        let boat = Pose::new(0.0, 0.0, heading);
        let found = gaps(&boat, &obstacle, 20.0);
        prop_assert_eq!(found.len(), 1);
        let (step, gap) = (1e-3, found[0].1);
        let [behind, ahead] = [-step, step].map(|s| {
            gaps(&displaced(&boat, 2, s), &obstacle, 20.0)[0].1.gap
        });
        let bend = (ahead - 2.0 * gap.gap + behind) / (step * step);
        prop_assert!((bend - gap.bend).abs() < 1e-3, "{bend} {}", gap.bend);
    }
}

/// The same poses in a pool with an inner wall and in one with a disc in its place.
fn with_disc_inside(p: &FlockParameters) -> [Flock; 2] {
    let start = Flock::new(p.clone(), 7).expect("room");
    let state = State {
        poses: start.poses().to_vec(),
        velocities: start.velocities().to_vec(),
        time_s: 0.0,
        allow_overlap: false,
    };
    let inside = FlockParameters {
        pool: Pool {
            inner_radius_cm: 0.0,
            ..p.pool
        },
        discs: vec![disc_at(0.0, 0.0, p.pool.inner_radius_cm)],
        ..p.clone()
    };
    [p.clone(), inside].map(|p| Flock::from_state(p, 7, &state).expect("no overlap"))
}

#[test]
fn a_disc_in_the_middle_is_an_inner_wall_bit_for_bit() {
    for scheme in SCHEMES {
        for noise in NOISES {
            for relinearizations in [0, 2] {
                let p = FlockParameters {
                    relinearizations,
                    ..busy(scheme, noise)
                };
                let [mut inner, mut inside] = with_disc_inside(&p);
                for _ in 0..4 {
                    inner.advance(2.0, None).expect("finite motion");
                    inside.advance(2.0, None).expect("finite motion");
                    assert_eq!(bits(&inner), bits(&inside), "{scheme:?} {noise:?}");
                }
                assert_eq!(inner.statistics(), inside.statistics());
            }
        }
    }
}

/// Velocities after one substep of an inert boat that touches obstacles.
fn struck(scheme: Scheme, p: &FlockParameters, boat: ([f64; 3], [f64; 3])) -> [f64; 3] {
    let p = FlockParameters {
        discs: p.discs.clone(),
        walls: p.walls.clone(),
        ..inert(scheme)
    };
    let mut flock = flock_of(&p, &[boat]);
    take_substeps(&mut flock, 1);
    assert!(flock.statistics().worst_residual_cm_s <= 1e-10);
    assert_eq!(flock.statistics().unsolved, 0);
    let velocity = flock.velocities()[0];
    [velocity.linear.x, velocity.linear.y, velocity.angular]
}

fn walled(walls: Vec<Wall>, discs: Vec<Disc>) -> FlockParameters {
    FlockParameters {
        walls,
        discs,
        ..inert(Scheme::Leapfrog)
    }
}

fn assert_near(found: [f64; 3], expected: [f64; 3], what: &str) {
    let worst = (0..3).map(|i| (found[i] - expected[i]).abs());
    let worst = worst.fold(0.0, f64::max);
    assert!(worst < 1e-11, "{what}: {found:?}, expected {expected:?}");
}

#[test]
fn an_oblique_hit_of_a_wall_spins_the_boat() {
    // The bow's disc touches the wall x = 0 at heading a: arm h·sin a, and λ = (v_x − arm·ω)/(1 + arm²/ρ²).
    for scheme in SCHEMES {
        for (a, [vx, vy, w]) in [
            (0.0, [10.0, 0.0, 0.0]),
            (0.4, [10.0, -3.0, 0.0]),
            (-1.1, [6.0, 4.0, 0.3]),
        ] {
            let p = walled(vec![wall((0.0, -50.0), (0.0, 50.0))], vec![]);
            let start = [-R - H * f64::cos(a), 0.0, a];
            let arm = H * f64::sin(a);
            let impulse = (vx - arm * w) / (1.0 + arm * arm / (RHO * RHO));
            let expected = [vx - impulse, vy, w + impulse * arm / (RHO * RHO)];
            assert_near(
                struck(scheme, &p, (start, [vx, vy, w])),
                expected,
                scheme.name(),
            );
        }
    }
}

#[test]
fn a_flat_hit_of_a_wall_stops_the_boat_along_its_normal() {
    // As long as neither end lifts off: |ω| < h·v/ρ².
    for scheme in SCHEMES {
        for spin in [0.0, 0.5, -0.6] {
            let p = walled(vec![wall((-50.0, -R), (50.0, -R))], vec![]);
            let found = struck(scheme, &p, ([0.0; 3], [7.0, -6.0, spin]));
            assert_near(found, [7.0, 0.0, 0.0], scheme.name());
        }
    }
}

#[test]
fn an_off_center_hit_of_a_wall_s_end_or_a_disc() {
    // Touched at t from the middle of the flank: λ = v/(1 + t²/ρ²), whatever the shape behind.
    for scheme in SCHEMES {
        for t in [0.0, 1.0, -2.3] {
            for p in [
                walled(vec![wall((t, -R), (t, -60.0))], vec![]),
                walled(vec![wall((t + 30.0, -60.0), (t, -R))], vec![]),
                walled(vec![], vec![disc_at(t, -R - 8.0, 8.0)]),
                walled(vec![], vec![disc_at(t, -R - 0.01, 0.01)]),
            ] {
                let impulse = 6.0 / (1.0 + t * t / (RHO * RHO));
                let found = struck(scheme, &p, ([0.0; 3], [3.0, -6.0, 0.0]));
                let expected = [3.0, -6.0 + impulse, impulse * t / (RHO * RHO)];
                assert_near(found, expected, scheme.name());
            }
        }
    }
}

#[test]
fn a_wall_shorter_than_the_hull_holds_it_with_both_ends() {
    // A flank on two points stops like a flat boat.
    for scheme in SCHEMES {
        let p = walled(vec![wall((-1.0, -R), (1.2, -R))], vec![]);
        let found = struck(scheme, &p, ([0.0; 3], [2.0, -6.0, 0.0]));
        assert_near(found, [2.0, 0.0, 0.0], scheme.name());
    }
}

#[test]
fn leaving_an_obstacle_feels_nothing() {
    for scheme in SCHEMES {
        for p in [
            walled(vec![wall((-50.0, -R), (50.0, -R))], vec![]),
            walled(vec![], vec![disc_at(0.0, -R - 8.0, 8.0)]),
        ] {
            let away = [1.0, 2.0, 0.1];
            assert_near(struck(scheme, &p, ([0.0; 3], away)), away, scheme.name());
        }
    }
}

#[test]
fn a_gap_closes_to_nothing_and_then_holds() {
    for scheme in SCHEMES {
        for p in [
            walled(vec![wall((0.0, -50.0), (0.0, 50.0))], vec![]),
            walled(vec![wall((0.0, 0.0), (50.0, 0.0))], vec![]),
            walled(vec![], vec![disc_at(9.0, 0.0, 9.0)]),
        ] {
            let p = FlockParameters { scheme, ..p };
            let mut flock = flock_of(&p, &[([-20.0, 0.0, 0.0], [10.0, 0.0, 0.0])]);
            take_substeps(&mut flock, 100);
            let beyond = flock.poses()[0].position.x + R + H;
            assert!(beyond.abs() < 1e-10, "{scheme:?}: {beyond:e}");
            assert!(flock.velocities()[0].linear.norm() < 1e-11);
        }
    }
}

#[test]
fn a_disc_shaped_boat_slides_along_a_straight_wall() {
    // Nothing turns it: v_t = v0·sin ψ·(1 − exp(−c0·t)), and the wall carries c0·v0·cos ψ.
    let psi = 0.5_f64;
    for scheme in [Scheme::Leapfrog, Scheme::Moreau] {
        let p = FlockParameters {
            boat_shape: 0.0,
            dt_s: 0.01,
            walls: vec![wall((0.0, -200.0), (0.0, 200.0))],
            ..driven(scheme)
        };
        let mut flock = flock_of(&p, &[([-R, -100.0, psi], [0.0; 3])]);
        flock.advance(2.0, None).expect("finite motion");
        let velocity = flock.velocities()[0].linear;
        // Leapfrog's velocities belong to half a substep ago.
        let time: f64 = if scheme == Scheme::Leapfrog {
            1.995
        } else {
            2.0
        };
        let expected = 15.0 * psi.sin() * (1.0 - (-time).exp());
        let error = if scheme == Scheme::Leapfrog {
            1e-4
        } else {
            2e-2
        };
        assert!(
            (velocity.y - expected).abs() < error,
            "{} {expected}",
            velocity.y
        );
        assert!(velocity.x.abs() < 1e-10 && flock.velocities()[0].angular == 0.0);
        assert!((flock.poses()[0].position.x + R).abs() < 1e-9);
        let force: f64 = flock.contacts().iter().map(|c| c.force).sum();
        assert!((force - 15.0 * psi.cos()).abs() < 1e-7, "{force}");
    }
}

/// A pool with a gate, a channel and posts in it, crowded.
pub fn arena(scheme: Scheme, noise: Noise) -> FlockParameters {
    FlockParameters {
        pool: Pool {
            outer_radius_cm: 120.0,
            inner_radius_cm: 0.0,
        },
        walls: vec![
            wall((-120.0, 0.0), (-12.0, 0.0)),
            wall((12.0, 0.0), (120.0, 0.0)),
            wall((-40.0, 30.0), (40.0, 34.0)),
            wall((-40.0, 60.0), (40.0, 60.0)),
            wall((30.0, -70.0), (60.0, -40.0)),
        ],
        discs: vec![
            disc_at(-50.0, -50.0, 12.0),
            disc_at(0.0, -60.0, 3.0),
            disc_at(70.0, 60.0, 20.0),
            disc_at(118.0, -20.0, 15.0),
        ],
        ..busy(scheme, noise)
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_at_any_cut_and_through_a_snapshot() {
    for scheme in SCHEMES {
        let p = arena(scheme, Noise::White);
        let mut whole = Flock::new(p.clone(), 3).expect("room");
        whole.advance(6.0, None).expect("finite motion");
        assert!(whole.statistics().contacts > 0);
        let mut cut = Flock::new(p, 3).expect("room");
        cut.advance(2.0, None).expect("finite motion");
        let mut restored = Flock::from_snapshot(&cut.snapshot()).expect("a whole snapshot");
        assert_eq!(restored.parameters(), cut.parameters());
        restored.advance(4.0, None).expect("finite motion");
        assert_eq!(bits(&whole), bits(&restored), "{scheme:?}");
        assert_eq!(whole.snapshot(), restored.snapshot());
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let p = FlockParameters {
        n_boats: 240,
        n_leaders: 0,
        pool: Pool {
            outer_radius_cm: 300.0,
            inner_radius_cm: 0.0,
        },
        ..arena(Scheme::Leapfrog, Noise::White)
    };
    let run = |threads| {
        let mut flock = Flock::new(p.clone(), 5).expect("room");
        flock.set_threads(threads).expect("a number of threads");
        flock.advance(2.0, None).expect("finite motion");
        (bits(&flock), *flock.statistics())
    };
    let alone = run(1);
    assert!(alone.1.contacts > 1000);
    assert_eq!(alone, run(2));
    assert_eq!(alone, run(5));
}

#[test]
fn a_snapshot_holds_obstacles_only_where_there_are_some() {
    let name = b"discs";
    let holds = |p: FlockParameters| {
        let snapshot = Flock::new(p, 1).expect("room").snapshot();
        snapshot.windows(name.len()).any(|window| window == name)
    };
    assert!(holds(arena(Scheme::Leapfrog, Noise::White)));
    assert!(!holds(table_3()));
}

#[test]
fn boats_never_start_inside() {
    for seed in 0..40 {
        let flock = Flock::new(arena(Scheme::Leapfrog, Noise::White), seed).expect("room");
        assert!(deepest_overlap(&flock) == 0.0, "{seed}");
    }
    // So many that they are grown into their places.
    let p = FlockParameters {
        n_boats: 130,
        n_leaders: 0,
        ..arena(Scheme::Leapfrog, Noise::White)
    };
    for seed in 0..3 {
        let flock = Flock::new(p.clone(), seed).expect("room");
        assert!(deepest_overlap(&flock) == 0.0, "{seed}");
    }
}

#[test]
fn boats_start_around_a_disc_in_open_water() {
    let p = FlockParameters {
        pool: OPEN_WATER,
        n_boats: 12,
        discs: vec![disc_at(0.0, 0.0, 500.0)],
        ..table_3()
    };
    let flock = Flock::new(p, 1).expect("room");
    assert!(deepest_overlap(&flock) == 0.0);
}

#[test]
fn no_room_is_a_named_error() {
    let crowd = |n_boats, discs, walls| FlockParameters {
        n_boats,
        discs,
        walls,
        pool: Pool {
            outer_radius_cm: 60.0,
            inner_radius_cm: 0.0,
        },
        ..table_3()
    };
    // A disc over the whole pool, or one that leaves a ring narrower than a boat.
    for radius in [100.0, 51.0] {
        let p = crowd(1, vec![disc_at(0.0, 0.0, radius)], vec![]);
        let error = Flock::new(p, 1).err();
        assert!(
            matches!(
                error,
                Some(FlockError::Placement {
                    requested: 1,
                    placed: 0
                })
            ),
            "{radius}: {error:?}"
        );
    }
    // Walls 9 cm apart leave no place for a boat of 10 cm.
    let grid = (-7..=7).flat_map(|i| {
        let at = 9.0 * f64::from(i);
        [wall((at, -70.0), (at, 70.0)), wall((-70.0, at), (70.0, at))]
    });
    let grid: Vec<Wall> = grid
        .filter(|w| w.x0_cm.abs() < 60.0 || w.y0_cm.abs() < 60.0)
        .collect();
    let grid: Vec<Wall> = grid
        .into_iter()
        .filter(|w| w.x0_cm.abs().min(w.y0_cm.abs()) < 60.0)
        .collect();
    let error = Flock::new(crowd(2, vec![], grid), 1).err();
    assert!(
        matches!(error, Some(FlockError::Placement { .. })),
        "{error:?}"
    );
    // Without the discs there is room for 50 boats, with them there is not.
    assert!(Flock::new(crowd(50, vec![], vec![]), 1).is_ok());
    let posts = [-30.0, 30.0].map(|x| disc_at(x, 0.0, 28.0)).to_vec();
    let error = Flock::new(crowd(50, posts, vec![]), 1).err();
    assert!(matches!(
        error,
        Some(FlockError::Placement { requested: 50, .. })
    ));
}

#[test]
fn a_state_inside_an_obstacle_is_refused() {
    let p = FlockParameters {
        n_boats: 1,
        discs: vec![disc_at(30.0, 0.0, 10.0)],
        walls: vec![wall((-30.0, -20.0), (-30.0, 20.0))],
        ..inert(Scheme::Leapfrog)
    };
    for (x, obstacle) in [(30.0, "disc 0"), (-30.0, "wall 0"), (-35.0, "wall 0")] {
        let state = State {
            poses: vec![Pose::new(x, 0.0, 0.0)],
            velocities: vec![Default::default()],
            time_s: 0.0,
            allow_overlap: false,
        };
        match Flock::from_state(p.clone(), 1, &state) {
            Err(FlockError::Overlap { what, .. }) => {
                assert_eq!(what, format!("boat 0 and {obstacle}"));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn an_obstacle_that_appears_on_a_boat_is_refused() {
    let mut flock = flock_of(
        &inert(Scheme::Leapfrog),
        &[([5.0, 0.0, 0.0], [1.0, 0.0, 0.0])],
    );
    let before = flock.snapshot();
    let with = |discs| {
        let p = flock.parameters().clone();
        Change::Parameters(Box::new(FlockParameters { discs, ..p }))
    };
    let (on_it, beside) = (
        with(vec![disc_at(0.0, 0.0, 9.0)]),
        with(vec![disc_at(0.0, 40.0, 9.0)]),
    );
    assert!(matches!(
        flock.change(&on_it),
        Err(FlockError::Overlap { .. })
    ));
    assert_eq!(flock.snapshot(), before);
    flock.change(&beside).expect("no overlap");
    assert_eq!(flock.parameters().discs.len(), 1);
}

#[test]
fn bad_obstacles_are_named() {
    let with = |discs: Vec<Disc>, walls: Vec<Wall>| {
        FlockParameters {
            discs,
            walls,
            ..table_3()
        }
        .check()
    };
    // The pool's radii are 180 and 97 cm.
    for bad in [
        disc_at(f64::NAN, 0.0, 5.0),
        disc_at(0.0, f64::INFINITY, 5.0),
        disc_at(140.0, 0.0, -1.0),
        disc_at(140.0, 0.0, 0.0),
        disc_at(140.0, 0.0, f64::NAN),
        disc_at(140.0, 0.0, 2e6),
        disc_at(186.0, 0.0, 5.0),
        disc_at(0.0, 10.0, 50.0),
    ] {
        let field = refused_field(with(vec![disc_at(140.0, 0.0, 5.0), bad], vec![]));
        assert_eq!(field, "discs", "{bad:?}");
    }
    for bad in [
        wall((f64::NAN, 0.0), (140.0, 0.0)),
        wall((0.0, 0.0), (f64::NEG_INFINITY, 0.0)),
        wall((140.0, 1.0), (140.0, 1.0)),
        wall((140.0, 1.0), (140.0, 1.0001)),
        wall((200.0, -50.0), (200.0, 50.0)),
        wall((-40.0, 0.0), (40.0, 0.0)),
    ] {
        assert_eq!(refused_field(with(vec![], vec![bad])), "walls", "{bad:?}");
    }
    assert_eq!(
        refused_field(with(vec![disc_at(140.0, 0.0, 1.0); 1001], vec![])),
        "discs"
    );
    assert_eq!(
        refused_field(with(vec![], vec![wall((100.0, 0.0), (140.0, 0.0)); 1001])),
        "walls"
    );
    // Reaching over the rim, the inner wall and each other is no mistake.
    let over = vec![
        wall((0.0, 0.0), (200.0, 0.0)),
        wall((140.0, -9.0), (140.0, 9.0)),
    ];
    assert!(
        with(
            vec![disc_at(181.0, 0.0, 5.0), disc_at(0.0, 95.0, 5.0)],
            over
        )
        .is_ok()
    );
}

#[test]
fn boats_far_from_many_obstacles_meet_none() {
    // 300 posts on a ring of radius 150 cm, boats in its middle and through it: only near ones are contacts.
    let posts = (0..300).map(|i| {
        let polar = 2.0 * PI * f64::from(i) / 300.0;
        disc_at(150.0 * polar.cos(), 150.0 * polar.sin(), 1.0)
    });
    let p = FlockParameters {
        discs: posts.collect(),
        ..inert(Scheme::Leapfrog)
    };
    let mut flock = crowded(
        &p,
        &[([0.0; 3], [0.0; 3]), ([0.0, 141.0, FRAC_PI_2], [0.0; 3])],
    );
    take_substeps(&mut flock, 1);
    let contacts = flock.contacts();
    assert!(contacts.iter().all(|c| c.contact.boat == 1));
    assert!(contacts.len() <= 3, "{}", contacts.len());
}
