//! Discs and walls in the water: a disc is an inner wall anywhere, a wall a hull without a radius that does not move.
//!
//! On paper: impulses λ = −v_n/(1 + l²/ρ²); a disc in the middle of the pool is its inner wall, bit for bit.

use crate::support::{
    H, NOISES, R, RHO, SCHEMES, VELOCITY_SCHEMES, assert_near, assert_solved, assert_velocity,
    bits, busy, changed, crowded, disc, disc_at, driven, flock_of, inert, take_substeps,
    time_of_velocities, wall,
};
use flockenv::flock::State;
use flockenv::geometry::Velocity;
use flockenv::parameters::{Disc, Noise, Pool, Scheme, Wall};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::{FRAC_PI_2, PI};

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
            for tolerance_cm in [f64::INFINITY, 1e-9] {
                let mut p = busy(scheme, noise);
                p.tolerance_cm = tolerance_cm;
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

/// The velocity after one substep of an inert boat that touches obstacles.
fn struck(scheme: Scheme, p: &FlockParameters, boat: ([f64; 3], [f64; 3])) -> Velocity {
    let p = FlockParameters {
        discs: p.discs.clone(),
        walls: p.walls.clone(),
        ..inert(scheme)
    };
    let mut flock = flock_of(&p, &[boat]);
    take_substeps(&mut flock, 1);
    assert_solved(&flock);
    flock.velocities()[0]
}

fn walled(walls: Vec<Wall>, discs: Vec<Disc>) -> FlockParameters {
    FlockParameters {
        walls,
        discs,
        ..inert(Scheme::Leapfrog)
    }
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
            let found = struck(scheme, &p, (start, [vx, vy, w]));
            assert_velocity(&found, expected, scheme);
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
            assert_velocity(&found, [7.0, 0.0, 0.0], scheme);
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
                assert_velocity(&found, expected, scheme);
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
        assert_velocity(&found, [2.0, 0.0, 0.0], scheme);
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
            assert_velocity(&struck(scheme, &p, ([0.0; 3], away)), away, scheme);
        }
    }
}

#[test]
fn a_gap_closes_to_nothing_and_then_holds() {
    // Coming from a distance, the approach is taken in two substeps: one that closes the gap exactly,
    // one that stops. `paper` overshoots by less than a substep's way and is projected back.
    for scheme in SCHEMES {
        for (p, end) in [
            (walled(vec![wall((0.0, -50.0), (0.0, 50.0))], vec![]), 0.0),
            (walled(vec![wall((0.0, 0.0), (50.0, 0.0))], vec![]), 0.0),
            (walled(vec![], vec![disc_at(9.0, 0.0, 9.0)]), 0.0),
            (changed(inert(scheme), |p| p.pool = disc(90.0)), 90.0),
        ] {
            let p = FlockParameters { scheme, ..p };
            let mut flock = flock_of(&p, &[([end - 20.0, 0.0, 0.0], [10.0, 0.0, 0.0])]);
            take_substeps(&mut flock, 100);
            // A residual of 1e-10 cm/s may last for the second that is left.
            assert_near(flock.poses()[0].position.x, end - R - H, 1e-10, scheme);
            assert_velocity(&flock.velocities()[0], [0.0; 3], scheme);
        }
    }
}

#[test]
fn a_disc_shaped_boat_slides_along_a_straight_wall() {
    // Nothing turns it: v_t = v0·sin ψ·(1 − exp(−c0·t)), and the wall carries c0·v0·cos ψ.
    let psi = 0.5_f64;
    for scheme in VELOCITY_SCHEMES {
        let p = FlockParameters {
            boat_shape: 0.0,
            dt_s: 0.01,
            walls: vec![wall((0.0, -200.0), (0.0, 200.0))],
            ..driven(scheme)
        };
        let mut flock = flock_of(&p, &[([-R, -100.0, psi], [0.0; 3])]);
        flock.advance(2.0, None).expect("finite motion");
        let velocity = flock.velocities()[0].linear;
        let time = time_of_velocities(scheme, 2.0, 0.01);
        let expected = 15.0 * psi.sin() * (1.0 - (-time).exp());
        let error = match scheme {
            Scheme::Leapfrog => 1e-4,
            _ => 2e-2,
        };
        assert_near(velocity.y, expected, error, scheme);
        assert!(velocity.x.abs() < 1e-10 && flock.velocities()[0].angular == 0.0);
        assert!((flock.poses()[0].position.x + R).abs() < 1e-9);
        let force: f64 = flock.contacts().iter().map(|c| c.force).sum();
        assert!((force - 15.0 * psi.cos()).abs() < 1e-7, "{force}");
    }
}

/// A pool with a gate, a channel and posts in it, crowded.
pub fn arena(scheme: Scheme, noise: Noise) -> FlockParameters {
    FlockParameters {
        pool: disc(120.0),
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
        let mut restored = Flock::from_snapshot(&cut.snapshot(), None).expect("a whole snapshot");
        assert_eq!(restored.parameters(), cut.parameters());
        restored.advance(4.0, None).expect("finite motion");
        assert_eq!(bits(&whole), bits(&restored), "{scheme:?}");
        assert_eq!(whole.snapshot(), restored.snapshot());
    }
}

#[test]
fn boats_far_from_many_obstacles_meet_none() {
    // 300 posts on a ring of radius 150 cm, boats in its middle and through it: only near ones are contacts.
    let posts = (0..300).map(|i| {
        let polar = 2.0 * PI * f64::from(i) / 300.0;
        disc_at(150.0 * polar.cos(), 150.0 * polar.sin(), 1.0)
    });
    let p = changed(inert(Scheme::Leapfrog), |p| p.discs = posts.collect());
    let mut flock = crowded(
        &p,
        &[([0.0; 3], [0.0; 3]), ([0.0, 141.0, FRAC_PI_2], [0.0; 3])],
    );
    take_substeps(&mut flock, 1);
    let contacts = flock.contacts();
    assert!(contacts.iter().all(|c| c.contact.boat == 1));
    assert!(contacts.len() <= 3, "{}", contacts.len());
}
