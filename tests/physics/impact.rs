//! Impacts are frictionless and perfectly plastic (eq. A.2): an impulse λ ≥ 0 along the common normal,
//! just large enough to stop the approach: λ = −v_n/Σ(1 + l²/ρ²) over the movable bodies, with l the
//! lever arms of the normal.
//!
//! On paper: two boats tip to tip share their mean velocity, and ΔKE = −(v1 − v2)²/4. Boats start
//! touching, so that the whole impulse acts at the very pose of the formula.

use crate::support::{
    H, R, RHO, SCHEMES, annulus, assert_near, assert_velocity, changed, disc, first_kick_s,
    flock_of, inert, kinetic_energy, momentum, take_substeps,
};
use flockenv::geometry::{Vec2, Velocity};

#[test]
fn head_on_tips_share_their_mean_velocity() {
    for scheme in SCHEMES {
        for (v1, v2) in [(10.0, -10.0), (12.0, -3.0), (7.0, 2.0), (4.0, 0.0)] {
            let length = 2.0 * (H + R);
            let mut flock = flock_of(
                &inert(scheme),
                &[
                    ([0.0, 0.0, 0.0], [v1, 0.0, 0.0]),
                    ([length, 0.0, std::f64::consts::PI], [v2, 0.0, 0.0]),
                ],
            );
            let before = kinetic_energy(&flock);
            take_substeps(&mut flock, 1);
            for velocity in flock.velocities() {
                assert_velocity(velocity, [0.5 * (v1 + v2), 0.0, 0.0], scheme);
            }
            let lost: f64 = kinetic_energy(&flock) - before;
            assert!((lost + (v1 - v2).powi(2) / 4.0).abs() < 1e-10);
            // Nothing bounces later either.
            take_substeps(&mut flock, 20);
            for velocity in flock.velocities() {
                assert_velocity(velocity, [0.5 * (v1 + v2), 0.0, 0.0], scheme);
            }
        }
    }
}

#[test]
fn boats_that_part_feel_nothing() {
    for scheme in SCHEMES {
        let states = [
            ([0.0, 0.0, 0.0], [1.0, 0.5, 0.01]),
            ([15.0, 0.0, 0.0], [2.0, -0.5, 0.0]),
        ];
        let mut flock = flock_of(&inert(scheme), &states);
        take_substeps(&mut flock, 1);
        for (velocity, (_, [x, y, w])) in flock.velocities().iter().zip(states) {
            assert_eq!(*velocity, Velocity::new(x, y, w), "{scheme:?}");
        }
        assert!(flock.contacts().iter().all(|c| c.force == 0.0));
    }
}

#[test]
fn an_oblique_wall_hit_spins_the_boat() {
    // The bow end touches the wall at (85, 0); the boat comes in under an angle ψ to the radius. Its
    // normal is (−1, 0) there, with lever arm h·sin ψ.
    for scheme in SCHEMES {
        for angle in [0.3_f64, -0.9, 1.2] {
            let (sin, cos) = angle.sin_cos();
            let (vx, vy, spin) = (9.0, 2.0, 0.1 * angle);
            let p = changed(inert(scheme), |p| p.pool = disc(90.0));
            let mut flock = flock_of(&p, &[([85.0 - H * cos, -H * sin, angle], [vx, vy, spin])]);
            take_substeps(&mut flock, 1);
            let arm = H * sin;
            let approach = -vx + arm * spin;
            let impulse = -approach / (1.0 + arm * arm / (RHO * RHO));
            let expected = [vx - impulse, vy, spin + impulse * arm / (RHO * RHO)];
            assert_velocity(&flock.velocities()[0], expected, scheme);
            let force = flock.contacts()[0].force;
            assert_near(force * first_kick_s(scheme, 0.02), impulse, 1e-11, scheme);
        }
    }
}

#[test]
fn a_hit_on_the_inner_wall_is_the_same_law() {
    // A boat flat on the obstacle at (R_in + r, 0), heading +y, touched at offset t by turning nothing:
    // the contact is at the middle of its side, so a sideways hit stops it dead and a spin is kept.
    for scheme in SCHEMES {
        let p = flockenv::FlockParameters {
            pool: annulus(200.0, 40.0),
            ..inert(scheme)
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        let mut flock = flock_of(&p, &[([45.0, 0.0, quarter], [-8.0, 3.0, 0.0])]);
        take_substeps(&mut flock, 1);
        assert_velocity(&flock.velocities()[0], [0.0, 3.0, 0.0], scheme);
        // Stern first, the disc of the stern on the wall at (45, 0): arm of normal (1, 0) about the
        // center is −h·sin(angle of the axis) with the stern at −h.
        let angle = 0.6_f64;
        let (sin, cos) = angle.sin_cos();
        let mut flock = flock_of(&p, &[([45.0 + H * cos, H * sin, angle], [-8.0, 0.0, 0.0])]);
        take_substeps(&mut flock, 1);
        let arm = H * sin;
        let impulse = 8.0 / (1.0 + arm * arm / (RHO * RHO));
        let expected = [-8.0 + impulse, 0.0, impulse * arm / (RHO * RHO)];
        assert_velocity(&flock.velocities()[0], expected, scheme);
    }
}

#[test]
fn a_tip_into_a_side_at_an_offset() {
    // Boat 0 lies along x; boat 1 above it heads down and hits its side at x = t.
    for scheme in SCHEMES {
        for t in [0.0, 1.0, -2.2] {
            let down = -std::f64::consts::FRAC_PI_2;
            let mut flock = flock_of(
                &inert(scheme),
                &[
                    ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
                    ([t, 2.0 * R + H, down], [1.0, -6.0, 0.0]),
                ],
            );
            let before = kinetic_energy(&flock);
            take_substeps(&mut flock, 1);
            let impulse = 6.0 / (2.0 + t * t / (RHO * RHO));
            let spin = -impulse * t / (RHO * RHO);
            assert_velocity(&flock.velocities()[0], [1.0, -impulse, spin], scheme);
            assert_velocity(&flock.velocities()[1], [1.0, -6.0 + impulse, 0.0], scheme);
            // A plastic impulse loses λ·|v_n|/2.
            let lost: f64 = before - kinetic_energy(&flock);
            assert!((lost - 0.5 * impulse * 6.0).abs() < 1e-9);
        }
    }
}

#[test]
fn an_oblique_off_center_hit_of_two_free_boats() {
    // End disc on end disc: the normal joins the two ends, both arms are nonzero.
    let (a, b, direction) = (0.8_f64, 2.5_f64, 0.35_f64);
    let axis = |angle: f64| Vec2::new(angle.cos(), angle.sin());
    let towards = axis(direction);
    for scheme in SCHEMES {
        let first = Vec2::zeros();
        let second = first + axis(a) * H + towards * (2.0 * R) - axis(b) * H;
        let mut flock = flock_of(
            &inert(scheme),
            &[
                ([first.x, first.y, a], [5.0, 4.0, 0.2]),
                ([second.x, second.y, b], [-3.0, 1.0, -0.4]),
            ],
        );
        take_substeps(&mut flock, 1);
        // Impulse −λ·towards on the first at its bow, +λ·towards on the second at its bow.
        let cross = |p: Vec2, q: Vec2| p.x * q.y - p.y * q.x;
        let arm_first = cross(axis(a) * H, -towards);
        let arm_second = cross(axis(b) * H, towards);
        let opening = towards.dot(&(Vec2::new(-3.0, 1.0) - Vec2::new(5.0, 4.0)))
            + arm_first * 0.2
            + arm_second * -0.4;
        assert!(opening < 0.0);
        let square = RHO * RHO;
        let give = 2.0 + (arm_first * arm_first + arm_second * arm_second) / square;
        let impulse = -opening / give;
        let one = Vec2::new(5.0, 4.0) - towards * impulse;
        let two = Vec2::new(-3.0, 1.0) + towards * impulse;
        let spins = [
            0.2 + impulse * arm_first / square,
            -0.4 + impulse * arm_second / square,
        ];
        assert_velocity(&flock.velocities()[0], [one.x, one.y, spins[0]], scheme);
        assert_velocity(&flock.velocities()[1], [two.x, two.y, spins[1]], scheme);
    }
}

#[test]
fn one_boat_into_a_row_moves_them_all() {
    for scheme in SCHEMES {
        for k in [2_usize, 3, 5, 9] {
            let states: Vec<_> = (0..k)
                .map(|i| {
                    let speed = if i == 0 { 10.0 } else { 0.0 };
                    ([15.0 * i as f64, 0.0, 0.0], [speed, 0.0, 0.0])
                })
                .collect();
            let mut flock = flock_of(&inert(scheme), &states);
            take_substeps(&mut flock, 1);
            for velocity in flock.velocities() {
                assert_velocity(velocity, [10.0 / k as f64, 0.0, 0.0], scheme);
            }
            assert!((kinetic_energy(&flock) - 50.0 / k as f64).abs() < 1e-9);
            assert!((momentum(&flock).x - 10.0).abs() < 1e-11);
            assert_eq!(flock.statistics().islands, 1);
        }
    }
}

#[test]
fn a_symmetric_wedge_is_driven_apart() {
    // Boat 0 comes along x and its bow disc meets two boats at once, mirror images with normals at ±γ
    // to the x axis. They lie across their normals and are touched at t from their middle:
    // λ = v·cos γ/(2·cos²γ + 1 + t²/ρ²) at each.
    for scheme in SCHEMES {
        for (gamma, t) in [(1.0_f64, 0.0), (1.1, 1.5), (0.9, -1.0)] {
            let (sin, cos) = gamma.sin_cos();
            let normal = [Vec2::new(cos, sin), Vec2::new(cos, -sin)];
            let side = [Vec2::new(-sin, cos), Vec2::new(-sin, -cos)];
            let bow = Vec2::new(H, 0.0);
            let centers = [0, 1].map(|i| bow + normal[i] * (2.0 * R) - side[i] * t);
            let heading = [0, 1].map(|i| side[i].y.atan2(side[i].x));
            let mut flock = flock_of(
                &inert(scheme),
                &[
                    ([0.0, 0.0, 0.0], [10.0, 0.0, 0.0]),
                    ([centers[0].x, centers[0].y, heading[0]], [0.0; 3]),
                    ([centers[1].x, centers[1].y, heading[1]], [0.0; 3]),
                ],
            );
            take_substeps(&mut flock, 1);
            let square = RHO * RHO;
            let impulse = 10.0 * cos / (2.0 * cos * cos + 1.0 + t * t / square);
            let expected = [10.0 - 2.0 * impulse * cos, 0.0, 0.0];
            assert_velocity(&flock.velocities()[0], expected, scheme);
            for (i, velocity) in flock.velocities()[1..].iter().enumerate() {
                let push = normal[i] * impulse;
                // side × normal is −1 for the upper boat and +1 for the lower.
                let spin =
                    t * (side[i].x * normal[i].y - side[i].y * normal[i].x) * impulse / square;
                assert_velocity(velocity, [push.x, push.y, spin], scheme);
            }
        }
    }
}
