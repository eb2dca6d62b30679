//! A flock's bits depend neither on the batch that it is in nor on the number of threads; a step or a
//! reset happens as a whole or not at all.

use crate::support::{
    batch, changed, flock, parameters, requested, seeded, settings, step, step_by,
};
use flockenv::FlockError;
use flockenv::environment::{
    Autoreset, Drawn, EnvBatch, FlockEnv, ResetRequest, RewardTerm, RewardWeights, Start, TERMS,
    TargetChoice, Upcoming, Weights,
};
use flockenv::parameters::{FlockParameters, Pool, Scheme, Target, Targets};
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

/// Fails unless something is refused for want of an episode.
#[track_caller]
fn assert_waits<T>(result: flockenv::Result<T>) {
    assert!(matches!(result, Err(FlockError::Episode(_))));
}

#[test]
fn steps_wait_for_a_reset() {
    let mut fresh = EnvBatch::new(settings(3), vec![parameters(1)]).unwrap();
    assert_waits(step(&mut fresh, &[0.0]));
    assert_waits(fresh.reset(&[Some(ResetRequest::default())]));
    let disabled = changed(settings(3), |own| own.autoreset_mode = Autoreset::Disabled);
    let mut batch = batch(disabled, &[1, 1], 0);
    for time in 0..3 {
        let written = step(&mut batch, &[0.0; 2]).unwrap();
        assert_eq!(written.truncated, [time == 2; 2]);
    }
    let before = batch.to_bytes();
    assert_waits(step(&mut batch, &[0.0; 2]));
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
    let start = Start::Snapshot {
        bytes: b"no snapshot".to_vec(),
        noise_seed: None,
    };
    let bad = requested(|request| request.start = start);
    assert!(batch.reset(&[seeded(7), Some(bad)]).is_err());
    assert!(batch.reset(&[seeded(7)]).is_err());
    assert_eq!(before, batch.to_bytes());
}

#[test]
fn a_flock_that_explodes_ends_its_own_episode_alone() {
    for mode in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        let own = changed(settings(30), |own| own.autoreset_mode = mode);
        let members = vec![parameters(1), wild(), parameters(1)];
        let mut batch = EnvBatch::new(own.clone(), members).unwrap();
        batch.reset(&[seeded(1), seeded(2), seeded(3)]).unwrap();
        let (steps, error) = (1..=20)
            .find_map(|time| Some((time, step(&mut batch, &[0.5; 3]).err()?)))
            .expect("the wild flock leaves its range");
        let words = error.to_string();
        assert!(matches!(error, FlockError::Solver(_)));
        assert!(words.starts_with("flock 1: ") && words.ends_with("the other flocks go on"));
        assert_eq!(
            episodes(&batch),
            [(steps, false), (steps - 1, true), (steps, false)]
        );
        if mode == Autoreset::Disabled {
            assert_waits(step(&mut batch, &[0.5; 3]));
            batch.reset(&[None, seeded(4), None]).unwrap();
        } else {
            step(&mut batch, &[0.5; 3]).unwrap();
            assert_eq!(
                episodes(&batch),
                [(steps + 1, false), (0, false), (steps + 1, false)]
            );
        }
        // What went on is what an undisturbed flock does.
        let mut alone = EnvBatch::new(own, vec![parameters(1)]).unwrap();
        alone.reset(&[seeded(3)]).unwrap();
        for _ in 0..episodes(&batch)[2].0 {
            step(&mut alone, &[0.5]).unwrap();
        }
        assert_eq!(flock(&batch, 2).poses(), flock(&alone, 0).poses());
    }
}

/// Constants so wild that spins leave the range of a state.
fn wild() -> FlockParameters {
    FlockParameters {
        c0: 1e6,
        c1: 0.0,
        c2: 1e6,
        c3: 0.0,
        speed_cm_s: 1e6,
        dt_s: 0.1,
        scheme: Scheme::Moreau,
        ..parameters(1)
    }
}

/// The control steps of each flock's episode, and whether it has ended.
fn episodes(batch: &EnvBatch) -> Vec<(u32, bool)> {
    let episode = |env: &FlockEnv| {
        let episode = env.episode().unwrap();
        (episode.schedule().step, episode.has_ended())
    };
    batch.envs().iter().map(episode).collect()
}

#[test]
fn what_is_upcoming_holds_from_the_next_episode_on() {
    let mut batch = batch(settings(3), &[1, 2], 0);
    let bw_s = |batch: &EnvBatch, place: usize| flock(batch, place).parameters().bw_s;
    let own = bw_s(&batch, 0);
    let longer = Upcoming {
        bw_s: Some(Drawn::Fixed(1.25)),
        target: None,
    };
    batch.set_upcoming(&[1], &longer).unwrap();
    // Bytes carry it along.
    let mut batch = EnvBatch::from_bytes(&batch.to_bytes()).unwrap();
    for time in 0..4 {
        assert_eq!((bw_s(&batch, 0), bw_s(&batch, 1)), (own, own), "{time}");
        step(&mut batch, &[0.0; 3]).unwrap();
    }
    assert_eq!((bw_s(&batch, 0), bw_s(&batch, 1)), (own, 1.25));
    let once = requested(|request| request.bw_s = Some(Drawn::Fixed(0.5)));
    batch.reset(&[None, Some(once)]).unwrap();
    assert_eq!(bw_s(&batch, 1), 0.5);
    batch.reset(&[None, Some(ResetRequest::default())]).unwrap();
    assert_eq!(bw_s(&batch, 1), 1.25);
    let before = batch.to_bytes();
    let each = Targets::Each(vec![Target::Clockwise, Target::CounterClockwise]);
    for (flocks, bw_s, target) in [
        (&[0, 1][..], Some(Drawn::Fixed(-1.0)), None),
        (&[0, 1], Some(Drawn::Uniform(2.0, 1.0)), None),
        (&[1, 0], None, Some(TargetChoice::Fixed(each.clone()))),
        (&[1, 2], Some(Drawn::Fixed(1.0)), None),
    ] {
        let refused = batch.set_upcoming(flocks, &Upcoming { bw_s, target });
        assert!(matches!(refused, Err(FlockError::Parameter { .. })));
        assert_eq!(before, batch.to_bytes());
    }
}

/// Leaders, of which there may be none, that nobody gives actions.
#[test]
fn without_actions_flocks_move_by_the_steering_law() {
    let mut batch = batch(settings(30), &[0, 2], 4);
    let mut alone: Vec<_> = [0, 1].map(|place| flock(&batch, place).clone()).into();
    for step in 1..=30 {
        let written = step_by(&mut batch, None).unwrap();
        assert_eq!(written.truncated, [step == 30; 2]);
        for (place, own) in alone.iter_mut().enumerate() {
            own.advance(0.1, None).unwrap();
            let there = batch.envs()[place].episode().unwrap();
            assert_eq!(there.flock().poses(), own.poses());
            let law: Vec<_> = (0..there.rudders().len())
                .map(|k| own.steering_law(k))
                .collect();
            assert_eq!(there.rudders(), law);
        }
    }
    let summary = batch.envs()[0].finished().unwrap();
    assert_eq!((summary.total_reward, summary.clip_rate), (0.0, 0.0));
    assert_eq!(batch.rows(), 2);
}

#[test]
fn batches_whose_contacts_take_too_much_memory_are_refused() {
    let crowd = FlockParameters {
        n_boats: 100_000,
        n_leaders: 50_000,
        pool: Pool::WIDE,
        ..parameters(1)
    };
    let of = |term: RewardTerm| {
        let mut weights = [0.0; TERMS];
        weights[term as usize] = 1.0;
        let reward = Weights::One(RewardWeights(weights));
        let settings = changed(settings(5), |settings| settings.reward = reward);
        EnvBatch::new(settings, vec![crowd.clone()])
    };
    assert!(of(RewardTerm::SignedOrder).is_ok());
    let refused = of(RewardTerm::ContactPush).expect_err("80 GB");
    assert!(refused.to_string().contains("bytes do not fit"));
}

#[test]
fn without_leaders_there_are_no_features() {
    let batch = batch(settings(5), &[0], 3);
    batch.envs()[0].observe_features(&mut []);
}
