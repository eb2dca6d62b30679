//! The same seed gives the same bits: at any thread count, through a snapshot, on
//! and off the grid of substeps.
//!
//! On paper: nothing, zero bits of difference.

use crate::support::{NOISES, SCHEMES, bits, busy, changed};
use flockenv::parameters::{Noise, Scheme, Solver, Target};
use flockenv::{Flock, FlockParameters};
use rayon::prelude::*;

fn all_kinds() -> impl Iterator<Item = FlockParameters> {
    SCHEMES
        .into_iter()
        .flat_map(|scheme| NOISES.into_iter().map(move |noise| busy(scheme, noise)))
}

fn advanced(flock: &mut Flock, durations: &[f64]) -> Vec<u64> {
    for &duration in durations {
        flock.advance(duration, None).expect("finite motion");
    }
    bits(flock)
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_others() {
    for p in all_kinds() {
        let run = |seed| advanced(&mut Flock::new(p.clone(), seed).expect("room"), &[3.0]);
        assert_eq!(run(7), run(7));
        assert_ne!(run(7), run(8));
    }
}

#[test]
fn a_run_cut_on_the_grid_or_at_its_own_phase_switches_is_the_same_run() {
    for p in all_kinds() {
        let run = |cuts: &[f64]| advanced(&mut Flock::new(p.clone(), 3).expect("room"), cuts);
        let (on_the_grid, at_switches) = (run(&[4.0]), run(&[1.318]));
        for (cuts, whole) in [
            (&[1.0, 3.0][..], &on_the_grid),
            (&[0.02, 3.98], &on_the_grid),
            (&[0.0, 1.5, 0.0, 2.5], &on_the_grid),
            (&[0.7, 0.02, 0.6, 1.18, 1.5], &on_the_grid),
            (&[0.713, 0.2, 0.305, 0.1], &at_switches),
        ] {
            let found = run(cuts);
            assert_eq!(
                &found, whole,
                "{:?} {:?} {cuts:?}",
                p.scheme, p.noise_scheme
            );
        }
    }
}

#[test]
fn held_rudders_cut_on_the_grid_are_the_same_run() {
    for p in all_kinds() {
        let run = |cuts: &[f64]| {
            let mut flock = Flock::new(p.clone(), 4).expect("room");
            for &duration in cuts {
                flock
                    .advance(duration, Some(&[0.5, -1.0, 0.0]))
                    .expect("finite motion");
            }
            bits(&flock)
        };
        assert_eq!(run(&[2.0]), run(&[0.5, 0.1, 1.4]));
    }
}

#[test]
fn a_snapshot_continues_with_the_same_bits() {
    for p in all_kinds() {
        for solver in Solver::ALL.iter().copied() {
            let p = changed(p.clone(), |p| p.solver = solver);
            let mut flock = Flock::new(p.clone(), 11).expect("room");
            // On a phase switch, on the grid, and neither: in the middle of a substep.
            for stop in [0.713, 0.987, 0.123_456_789] {
                flock.advance(stop, None).expect("finite motion");
                flock.set_target(Target::CounterClockwise).unwrap();
                let bytes = flock.snapshot();
                let mut other = Flock::new(p.clone(), 99).expect("room");
                other.advance(0.5, None).expect("finite motion");
                other
                    .restore(&bytes, None)
                    .expect("a snapshot of such a flock");
                let mut third = Flock::from_snapshot(&bytes, None).expect("a snapshot");
                let mut went_on = flock.clone();
                let expected = advanced(&mut went_on, &[0.41, 0.333_333]);
                assert_eq!(advanced(&mut other, &[0.41, 0.333_333]), expected);
                assert_eq!(advanced(&mut third, &[0.41, 0.333_333]), expected);
                assert!(went_on.snapshot() == other.snapshot(), "{:?}", p.scheme);
            }
        }
    }
}

#[test]
fn a_snapshot_restored_is_the_snapshot() {
    for p in all_kinds() {
        let mut flock = Flock::new(p, 2).expect("room");
        flock.advance(1.0, None).expect("finite motion");
        let bytes = flock.snapshot();
        let again = Flock::from_snapshot(&bytes, None)
            .expect("a snapshot")
            .snapshot();
        assert!(again == bytes);
    }
}

#[test]
fn threads_do_not_matter() {
    let members: Vec<(FlockParameters, u64)> = all_kinds().zip(20..).collect();
    let run = |(p, seed): &(FlockParameters, u64)| {
        advanced(&mut Flock::new(p.clone(), *seed).expect("room"), &[0.11; 8])
    };
    let alone: Vec<Vec<u64>> = members.iter().map(run).collect();
    for threads in [2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let together: Vec<_> = pool
            .expect("threads")
            .install(|| members.par_iter().map(run).collect());
        assert_eq!(together, alone, "{threads} threads");
    }
}

#[test]
fn a_reset_flock_is_a_new_flock() {
    let p = busy(Scheme::Leapfrog, Noise::White);
    let mut flock = Flock::new(p.clone(), 1).expect("room");
    flock.advance(2.0, None).expect("finite motion");
    flock.reset(&|| true, 5).expect("room");
    let mut fresh = Flock::new(p, 5).expect("room");
    assert!(flock.snapshot() == fresh.snapshot());
    assert_eq!(advanced(&mut flock, &[1.0]), advanced(&mut fresh, &[1.0]));
}
