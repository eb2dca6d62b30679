//! The physics knows no direction and no numbering: a mirrored, a turned and a renumbered scene moves
//! as the scene itself, mirrored, turned and renumbered.
//!
//! On paper: a boat that heads at the wall from the right and its turned copy from above meet it alike.

use crate::support::{SCHEMES, changed, driven, farthest_apart, flock_of, take_substeps};
use flockenv::geometry::{Pose, Vec2, Velocity};
use flockenv::parameters::{Pool, Scheme};
use flockenv::{Flock, FlockParameters};
use std::f64::consts::FRAC_PI_2;

/// Two seconds of a crowd: rounding of 1e-14 cm grows with every contact that turns a boat, by less
/// than a factor of a million in so short a time.
const GROWN_ROUNDING: f64 = 1e-8;

fn crowd(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        n_boats: 40,
        n_leaders: 2,
        pool: Pool::NARROW,
        fw_s: 0.9,
        nop1_s: 0.1,
        bw_s: 0.2,
        nop2_s: 0.1,
        ..driven(scheme)
    }
}

fn start(p: &FlockParameters) -> (Vec<Pose>, Vec<Velocity>) {
    let flock = Flock::new(p.clone(), 17).expect("room");
    let velocities = (0..p.n_boats)
        .map(|i| {
            let phase = 1.7 * i as f64;
            Velocity::new(8.0 * phase.cos(), 8.0 * phase.sin(), (2.0 * phase).sin())
        })
        .collect();
    (flock.poses().to_vec(), velocities)
}

fn run(
    p: &FlockParameters,
    (poses, velocities): &(Vec<Pose>, Vec<Velocity>),
    rudder: &[f64],
) -> Flock {
    let mut flock = Flock::new(p.clone(), 1).expect("room");
    flock
        .set_state(poses, velocities, 0.0, false)
        .expect("as placed");
    flock.advance(2.0, Some(rudder)).expect("finite motion");
    assert!(flock.statistics().solver_iterations > 100);
    flock
}

fn map(
    (poses, velocities): &(Vec<Pose>, Vec<Velocity>),
    pose: impl Fn(&Pose) -> Pose,
    velocity: impl Fn(&Velocity) -> Velocity,
) -> (Vec<Pose>, Vec<Velocity>) {
    (
        poses.iter().map(pose).collect(),
        velocities.iter().map(velocity).collect(),
    )
}

#[test]
fn a_turned_wall_hit_is_the_same_hit() {
    for scheme in SCHEMES {
        let p = changed(driven(scheme), |p| p.pool = Pool::NARROW);
        let mut right = flock_of(&p, &[([80.0, 0.0, 0.4], [15.0, 2.0, 0.0])]);
        let mut above = flock_of(&p, &[([0.0, 80.0, 0.4 + FRAC_PI_2], [-2.0, 15.0, 0.0])]);
        take_substeps(&mut right, 50);
        take_substeps(&mut above, 50);
        let (r, a) = (right.poses()[0], above.poses()[0]);
        let turned = Vec2::new(-r.position.y, r.position.x);
        assert!((turned - a.position).norm() < 1e-11, "{scheme:?}");
        assert!((r.heading + FRAC_PI_2 - a.heading).abs() < 1e-11);
        assert!(right.statistics().solves > 0);
    }
}

#[test]
fn a_mirrored_scene_moves_mirrored() {
    for scheme in SCHEMES {
        let p = crowd(scheme);
        let scene = start(&p);
        let flip = |p: &Pose| Pose::new(p.position.x, -p.position.y, -p.heading);
        let flip_velocity = |v: &Velocity| Velocity::new(v.linear.x, -v.linear.y, -v.angular);
        let plain = run(&p, &scene, &[1.0, -0.3]);
        let mirrored = run(&p, &map(&scene, flip, flip_velocity), &[-1.0, 0.3]);
        let expected: Vec<Pose> = plain.poses().iter().map(flip).collect();
        let error = farthest_apart(mirrored.poses(), &expected);
        assert!(error < GROWN_ROUNDING, "{scheme:?}: {error:e}");
    }
}

#[test]
fn a_turned_scene_moves_turned() {
    for scheme in SCHEMES {
        for angle in [FRAC_PI_2, 1.0, -2.6] {
            let p = crowd(scheme);
            let scene = start(&p);
            let (sin, cos) = angle.sin_cos();
            let rotate = |v: &Vec2| Vec2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
            let turn = |p: &Pose| Pose {
                position: rotate(&p.position),
                heading: p.heading + angle,
            };
            let turn_velocity = |v: &Velocity| Velocity {
                linear: rotate(&v.linear),
                angular: v.angular,
            };
            let plain = run(&p, &scene, &[0.5, 0.0]);
            let turned = run(&p, &map(&scene, turn, turn_velocity), &[0.5, 0.0]);
            let expected: Vec<Pose> = plain.poses().iter().map(turn).collect();
            let error = farthest_apart(turned.poses(), &expected);
            assert!(error < GROWN_ROUNDING, "{scheme:?} {angle}: {error:e}");
        }
    }
}

#[test]
fn numbering_does_not_matter() {
    for scheme in SCHEMES {
        let p = crowd(scheme);
        let scene = start(&p);
        // Leaders swap among themselves, normal boats move on by 13 places.
        let order: Vec<usize> = [1, 0]
            .into_iter()
            .chain((0..38).map(|i| 2 + (i + 13) % 38))
            .collect();
        let renumbered = (
            order.iter().map(|&i| scene.0[i]).collect(),
            order.iter().map(|&i| scene.1[i]).collect(),
        );
        let plain = run(&p, &scene, &[0.8, -0.2]);
        let other = run(&p, &renumbered, &[-0.2, 0.8]);
        let expected: Vec<Pose> = order.iter().map(|&i| plain.poses()[i]).collect();
        let error = farthest_apart(other.poses(), &expected);
        assert!(error < GROWN_ROUNDING, "{scheme:?}: {error:e}");
    }
}
