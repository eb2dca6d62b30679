//! Three solvers, one answer, on the contact problems of real scenes: block pivoting to 1e-10 cm/s,
//! Gauss–Seidel to the same with many more rounds, and clarabel's interior point, which shares no code
//! with either, once it is polished on its active set.
//!
//! On paper: the motion after contact is unique, whatever the impulses.

use crate::dense_reference::Dense;
use crate::solver::{Owned, PLAIN};
use crate::support::driven;
use flockenv::contact::ContactDetector;
use flockenv::geometry::{HullPose, Velocity};
use flockenv::parameters::{Pool, Scheme, Solver};
use flockenv::{Flock, FlockParameters};

/// The contact problem that a jam of `n` boats meets after `seconds`, with every engine pushing.
fn jam_problem(n_boats: usize, seconds: f64, seed: u64) -> Owned {
    let p = FlockParameters {
        n_boats,
        c4: 0.1,
        pool: Pool::NARROW,
        dt_s: 0.01,
        ..driven(Scheme::Leapfrog)
    };
    let mut flock = Flock::new(p, seed).expect("room");
    flock.advance(seconds, None).expect("finite motion");
    let boats: Vec<HullPose> = flock.poses().iter().map(HullPose::new).collect();
    let mut contacts = Vec::new();
    ContactDetector::new(flock.parameters()).detect(&boats, 0.3, &mut contacts);
    let free = flock.velocities().iter().zip(&boats);
    Owned {
        biases: contacts.iter().map(|c| c.gap.gap / 0.01).collect(),
        contacts,
        inertia: vec![PLAIN; n_boats],
        free: free
            .map(|(v, boat)| Velocity {
                linear: v.linear * 0.99 + boat.axis * 0.15,
                angular: v.angular,
            })
            .collect(),
    }
}

fn farthest(a: &[Velocity], b: &[Velocity]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a.linear - b.linear).norm() + (a.angular - b.angular).abs())
        .fold(0.0, f64::max)
}

#[test]
fn block_pivoting_and_gauss_seidel_agree_on_jams() {
    for (n, seed) in [(27, 1), (50, 2), (50, 3)] {
        let scene = jam_problem(n, 10.0, seed);
        assert!(scene.contacts.len() > n, "a jam");
        let (exact, impulses, velocities) = scene.solve(Solver::BlockPivoting);
        assert!(exact.converged && exact.residual <= 1e-10);
        assert!(impulses.iter().filter(|&&impulse| impulse > 0.0).count() > n / 3);
        let (swept, _, others) = scene.solve(Solver::GaussSeidel);
        assert!(swept.residual <= 1e-10, "{swept:?}");
        // Both residuals are at most 1e-10; chains of some ten boats amplify them.
        let error = farthest(&velocities, &others);
        assert!(error < 1e-7, "{n} {seed}: {error:e}");
        assert!(swept.iterations > 5 * exact.iterations);
    }
}

#[cfg(feature = "clarabel")]
#[test]
fn clarabel_comes_close_and_agrees_once_polished() {
    for (n, seed) in [(27, 1), (50, 2), (50, 3)] {
        let scene = jam_problem(n, 10.0, seed);
        let (_, impulses, velocities) = scene.solve(Solver::BlockPivoting);
        let (report, rough, near) = scene.solve(Solver::Clarabel);
        assert!(report.converged && report.residual < 1e-3, "{report:?}");
        assert!(farthest(&velocities, &near) < 1e-2);
        // Polished: the contacts it loads, met as equations.
        let dense = Dense::of(&scene.problem());
        let largest = rough.iter().copied().fold(0.0, f64::max);
        let set: Vec<usize> = (0..rough.len())
            .filter(|&k| rough[k] > 1e-5 * largest)
            .collect();
        let x = dense.polished(&set, nalgebra::DVector::zeros(3 * n)).x;
        let exact = Dense::scaled(&scene.problem(), &velocities);
        // A contact loaded with less than the cut is left out, and moves boats by as little.
        let light: f64 = impulses.iter().filter(|&&i| i <= 2e-5 * largest).sum();
        let error = (&x - &exact).norm();
        assert!(
            error < 1e-8 + 5.0 * light,
            "{n} {seed}: {error:e} {light:e}"
        );
    }
}

#[test]
fn goldfarb_and_idnani_agree_on_jams() {
    let scene = jam_problem(27, 10.0, 4);
    let (_, _, velocities) = scene.solve(Solver::BlockPivoting);
    let dense = Dense::of(&scene.problem());
    let reference = dense.by_goldfarb_idnani(1e-10).expect("feasible");
    let error = (Dense::scaled(&scene.problem(), &velocities) - reference.x).norm();
    assert!(error < 1e-7, "{error:e}");
}

#[test]
fn flocks_move_alike_with_either_solver() {
    // Half a second of a jam: residuals of 1e-10 cm/s have no time to grow.
    let run = |solver| {
        let p = FlockParameters {
            n_boats: 40,
            solver,
            tolerance_cm: f64::INFINITY,
            pool: Pool::NARROW,
            ..driven(Scheme::Leapfrog)
        };
        let mut flock = Flock::new(p, 8).expect("room");
        flock.advance(0.5, None).expect("finite motion");
        assert!(flock.statistics().solves > 5);
        flock
    };
    let exact = run(Solver::BlockPivoting);
    let agrees = |solver, bound| {
        let error = farthest(exact.velocities(), run(solver).velocities());
        assert!(error < bound, "{solver:?}: {error:e}");
    };
    agrees(Solver::GaussSeidel, 1e-7);
    #[cfg(feature = "clarabel")]
    agrees(Solver::Clarabel, 1e-2);
    assert!(exact.statistics().worst_residual_cm_s <= 1e-10);
}
