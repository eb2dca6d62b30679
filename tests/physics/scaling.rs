//! No length is built in: a scene with all its lengths scaled behaves as before.
//!
//! On paper: with lengths, speeds and 1/c2, 1/c3 times k, the equations of motion and the contacts are
//! those of the original scene. Scaling by a power of 2 rounds nothing: only the solver's tolerance, an
//! absolute speed, differs then.

use crate::support::{changed, crowded, deepest_overlap, table_3, take_substeps};
use flockenv::contact::Statistics;
use flockenv::geometry::Pose;
use flockenv::parameters::Pool;
use flockenv::{Flock, FlockParameters};

/// A scene with all its lengths times k.
fn scaled(p: &FlockParameters, k: f64) -> FlockParameters {
    FlockParameters {
        pool: Pool {
            outer_radius_cm: k * p.pool.outer_radius_cm,
            inner_radius_cm: k * p.pool.inner_radius_cm,
        },
        boat_radius_cm: k * p.boat_radius_cm,
        gyration_radius_cm: k * p.gyration_radius_cm,
        speed_cm_s: k * p.speed_cm_s,
        reverse_speed_cm_s: k * p.reverse_speed_cm_s,
        c2: p.c2 / k,
        c3: p.c3 / k,
        overlap_tolerance_cm: k * p.overlap_tolerance_cm,
        tolerance_cm: k * p.tolerance_cm,
        speed_spread_cm_s: k * p.speed_spread_cm_s,
        current_cap_cm_s: k * p.current_cap_cm_s,
        ..p.clone()
    }
}

fn default_scene(n_boats: usize) -> FlockParameters {
    changed(table_3(), |p| p.n_boats = n_boats)
}

fn placed(n_boats: usize, k: f64) -> Vec<Pose> {
    let flock = Flock::new(scaled(&default_scene(n_boats), k), 3).expect("room");
    assert_eq!(deepest_overlap(&flock), 0.0);
    flock.poses().to_vec()
}

#[test]
fn a_dense_flock_is_placed_the_same_at_every_scale() {
    // 20 boats are placed by rejection, 320 by growth; 1.0 is the default scene.
    for n_boats in [20, 320] {
        let original = placed(n_boats, 1.0);
        for k in [128.0, 1.0 / 128.0] {
            for (pose, known) in placed(n_boats, k).iter().zip(&original) {
                assert!((pose.position / k - known.position).norm() < 1e-9, "{k}");
                assert!((pose.heading - known.heading).abs() < 1e-9, "{k}");
            }
        }
        for k in [100.0, 0.01] {
            placed(n_boats, k);
        }
    }
}

/// Ten boats that overlap deeply, some far; what their substeps did, and where they are then.
fn pushed_apart(k: f64) -> (Statistics, Vec<Pose>) {
    let states: Vec<_> = (0..10)
        .map(|i| {
            let i = f64::from(i);
            ([k * 9.0 * i, k * (120.0 + 3.0 * i), 0.7 * i], [0.0; 3])
        })
        .collect();
    let mut flock = crowded(&scaled(&default_scene(10), k), &states);
    take_substeps(&mut flock, 25);
    assert!(deepest_overlap(&flock) < 0.011 * k);
    (*flock.statistics(), flock.poses().to_vec())
}

#[test]
fn deep_overlaps_are_undone_the_same_at_every_scale() {
    let (known, original) = pushed_apart(1.0);
    assert!(known.depenetration_passes > 0);
    for k in [100.0, 0.01] {
        let (statistics, poses) = pushed_apart(k);
        assert_eq!(statistics.depenetration_passes, known.depenetration_passes);
        assert_eq!(statistics.contacts, known.contacts);
        let moved = statistics.displaced_angular_momentum_cm2_s / (k * k);
        assert!((moved - known.displaced_angular_momentum_cm2_s).abs() < 1e-6 * (1.0 + moved));
        for (pose, known) in poses.iter().zip(&original) {
            assert!((pose.position / k - known.position).norm() < 1e-6, "{k}");
            assert!((pose.heading - known.heading).abs() < 1e-6, "{k}");
        }
    }
}
