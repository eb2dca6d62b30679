//! A flock's bits depend neither on the batch that it is in nor on the number of threads; a step or a
//! reset happens as a whole or not at all.

use crate::support::{batch, parameters, seeded, settings, step};
use flockenv::FlockError;
use flockenv::environment::{Autoreset, EnvBatch, EnvSettings, ResetRequest, Start};
use flockenv::parameters::{FlockParameters, Scheme};
use rayon::ThreadPoolBuilder;

fn action(seed: u64, leader: usize, time: u32) -> f64 {
    (seed as f64 + 1.7 * leader as f64 + 0.3 * f64::from(time)).sin()
}

/// All observations and rewards of each flock, over episodes that end and start again.
fn trails(leaders: &[usize], first_seed: u64, threads: usize) -> Vec<Vec<f64>> {
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut batch = batch(settings(30), leaders, first_seed);
        let size = batch.observation_size();
        let mut trails = vec![Vec::new(); leaders.len()];
        for time in 0..70 {
            let each = leaders.iter().zip(first_seed..);
            let actions: Vec<f64> = each
                .flat_map(|(&k, seed)| (0..k).map(move |leader| action(seed, leader, time)))
                .collect();
            let written = step(&mut batch, &actions).unwrap();
            let mut row = 0;
            for (trail, &k) in trails.iter_mut().zip(leaders) {
                let numbers = &written.observations[row * size..(row + k) * size];
                trail.extend(numbers.iter().copied().map(f64::from));
                trail.extend_from_slice(&written.rewards[row..row + k]);
                row += k;
            }
        }
        trails
    })
}

#[test]
fn threads_do_not_matter() {
    let one = trails(&[1, 2, 3, 2, 4], 0, 1);
    assert_eq!(one, trails(&[1, 2, 3, 2, 4], 0, 2));
    assert_eq!(one, trails(&[1, 2, 3, 2, 4], 0, 5));
}

#[test]
fn batches_do_not_matter() {
    let together = trails(&[1, 2, 3], 4, 2);
    for (place, &k) in [1, 2, 3].iter().enumerate() {
        assert_eq!(
            together[place..=place],
            trails(&[k], 4 + place as u64, 1)[..]
        );
    }
}

#[test]
fn refused_steps_move_nothing() {
    let mut batch = batch(settings(30), &[2, 2], 0);
    let before = batch.to_bytes();
    for bad in [vec![0.0; 3], vec![0.0; 5], vec![0.0, 0.0, f64::NAN, 0.0]] {
        assert!(step(&mut batch, &bad).is_err());
    }
    assert_eq!(before, batch.to_bytes());
    step(&mut batch, &[f64::INFINITY, -3.0, 0.0, 0.0]).unwrap();
}

#[test]
fn steps_wait_for_a_reset() {
    let mut fresh = EnvBatch::new(settings(3), vec![parameters(1)]).unwrap();
    assert!(matches!(
        step(&mut fresh, &[0.0]),
        Err(FlockError::Episode(_))
    ));
    assert!(matches!(
        fresh.reset(&[Some(ResetRequest::default())]),
        Err(FlockError::Episode(_))
    ));
    let disabled = EnvSettings {
        autoreset_mode: Autoreset::Disabled,
        ..settings(3)
    };
    let mut batch = batch(disabled, &[1, 1], 0);
    for time in 0..3 {
        let written = step(&mut batch, &[0.0; 2]).unwrap();
        assert_eq!(written.truncated, [time == 2; 2]);
    }
    let before = batch.to_bytes();
    assert!(matches!(
        step(&mut batch, &[0.0; 2]),
        Err(FlockError::Episode(_))
    ));
    assert_eq!(before, batch.to_bytes());
    batch.reset(&[None, Some(ResetRequest::default())]).unwrap();
    assert!(step(&mut batch, &[0.0; 2]).is_err());
    batch.reset(&[seeded(3), None]).unwrap();
    step(&mut batch, &[0.0; 2]).unwrap();
}

#[test]
fn resets_happen_as_a_whole() {
    let mut batch = batch(settings(30), &[1, 1], 0);
    let before = batch.to_bytes();
    let bad = ResetRequest {
        start: Start::Snapshot {
            bytes: b"no snapshot".to_vec(),
            noise_seed: None,
        },
        ..ResetRequest::default()
    };
    assert!(batch.reset(&[seeded(7), Some(bad)]).is_err());
    assert!(batch.reset(&[seeded(7)]).is_err());
    assert_eq!(before, batch.to_bytes());
}

#[test]
fn an_exploding_flock_ends_the_episodes_of_its_batch() {
    // Constants so wild that an explicit step leaves the range of a state.
    let wild = FlockParameters {
        c0: 1e6,
        dt_s: 0.1,
        scheme: Scheme::Moreau,
        ..parameters(1)
    };
    let members = vec![parameters(1), wild, parameters(1)];
    let mut batch = EnvBatch::new(settings(30), members).unwrap();
    batch.reset(&[seeded(1), seeded(2), seeded(3)]).unwrap();
    (1..=20)
        .find(|_| matches!(step(&mut batch, &[0.5; 3]), Err(FlockError::Solver(_))))
        .expect("the wild flock leaves its range");
    // The rewards of the others are lost, so that no episode continues as if they were known.
    assert!(batch.envs().iter().all(|env| env.episode().is_none()));
    assert!(matches!(
        step(&mut batch, &[0.5; 3]),
        Err(FlockError::Episode(_))
    ));
    batch.reset(&[seeded(1), seeded(2), seeded(3)]).unwrap();
    step(&mut batch, &[0.5; 3]).unwrap();
}

#[test]
fn a_batch_larger_than_memory_is_refused_before_it_is_made() {
    let members = vec![
        FlockParameters {
            n_boats: 100_000,
            ..parameters(1)
        };
        200
    ];
    match EnvBatch::new(settings(10), members) {
        Err(FlockError::Parameter {
            field, accepted, ..
        }) => {
            assert_eq!(field, "num_envs");
            assert!(accepted.contains("bytes do not fit"), "{accepted}");
        }
        other => panic!("{:?}", other.map(|batch| batch.rows())),
    }
}
