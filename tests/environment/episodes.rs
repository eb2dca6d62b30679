//! What a seed fixes, when targets change, what autoresets do, what servos do.

use crate::support::{batch, parameters, settings, step};
use flockenv::Flock;
use flockenv::environment::{
    Autoreset, EnvSettings, EpisodeSchedule, EpisodeSeeds, EpisodeSettings, RudderSettings,
    TargetChoice,
};
use flockenv::parameters::Target;

#[test]
fn the_first_episode_has_the_seed_itself() {
    let batch = batch(settings(30), &[2], 17);
    let own = batch.envs()[0].episode().unwrap().flock();
    let flock = Flock::new(parameters(2), 17).unwrap();
    assert_eq!(own.poses(), flock.poses());
    let mut seeds = EpisodeSeeds::new(17);
    let drawn: Vec<u64> = (0..4).map(|_| seeds.next_seed()).collect();
    assert_eq!(drawn[0], 17);
    let mut again = EpisodeSeeds::new(17);
    assert!(drawn.iter().all(|&seed| seed == again.next_seed()));
    let mut different = drawn.clone();
    different.dedup();
    assert_eq!(different.len(), drawn.len());
}

#[test]
fn targets_alternate_by_quarters() {
    let plan = EpisodeSettings {
        target: TargetChoice::Alternate,
        ..EpisodeSettings::default()
    };
    assert_eq!(plan.steps(), 9600);
    let mut episode = EpisodeSchedule::new(&plan, 0, 0.3);
    for (step, target) in [
        (0, Target::CounterClockwise),
        (2399, Target::CounterClockwise),
        (2400, Target::Clockwise),
        (4800, Target::CounterClockwise),
        (7200, Target::Clockwise),
        (9600, Target::Clockwise),
    ] {
        episode.step = step;
        assert_eq!(episode.target(), target, "at step {step}");
    }
}

#[test]
fn random_targets_are_even_and_noise_levels_uniform() {
    let plan = EpisodeSettings {
        target: TargetChoice::Random,
        bw_range_s: Some((0.2, 0.6)),
        ..EpisodeSettings::default()
    };
    let episodes: Vec<EpisodeSchedule> = (0..4000)
        .map(|seed| EpisodeSchedule::new(&plan, seed, 0.3))
        .collect();
    let clockwise = episodes
        .iter()
        .filter(|e| e.target() == Target::Clockwise)
        .count();
    assert!((1850..2150).contains(&clockwise), "{clockwise}");
    let mean = episodes.iter().map(|e| e.bw_s).sum::<f64>() / 4000.0;
    assert!((mean - 0.4).abs() < 0.01, "{mean}");
    assert!(episodes.iter().all(|e| (0.2..=0.6).contains(&e.bw_s)));
    // Fixing one of them leaves the other as it was drawn.
    let fixed = EpisodeSettings {
        bw_range_s: None,
        ..plan
    };
    let same = |seed: u64| {
        EpisodeSchedule::new(&fixed, seed, 0.3).target() == episodes[seed as usize].target()
    };
    assert!((0..100).all(same));
}

#[test]
fn autoresets_start_the_same_episode() {
    let same_step = EnvSettings {
        autoreset: Autoreset::SameStep,
        ..settings(4)
    };
    let mut now = batch(same_step, &[2], 0);
    let mut later = batch(settings(4), &[2], 0);
    for time in 0..4 {
        let actions = [0.5, -0.5];
        let (first, second) = (
            step(&mut now, &actions).unwrap(),
            step(&mut later, &actions).unwrap(),
        );
        assert_eq!(first.rewards, second.rewards);
        assert_eq!(first.truncated, [time == 3]);
        if time < 3 {
            assert_eq!(first.observations, second.observations);
            continue;
        }
        assert_eq!(now.envs()[0].final_observation(), second.observations);
        let fresh = step(&mut later, &actions).unwrap();
        assert_eq!(first.observations, fresh.observations);
        assert_eq!(fresh.rewards, [0.0; 2]);
        assert_eq!(fresh.truncated, [false]);
    }
}

#[test]
fn servos_move_by_their_lag_and_rate() {
    let none = RudderSettings::default();
    assert_eq!(none.servo(0.1).moved(-1.0, 1.0), 1.0);
    let rate = RudderSettings {
        rate_per_s: Some(4.0),
        ..none
    };
    assert!((rate.servo(0.1).moved(-1.0, 1.0) + 0.6).abs() < 1e-12);
    assert_eq!(rate.servo(0.1).moved(0.9, 1.0), 1.0);
    let lag = RudderSettings { lag_s: 0.2, ..none };
    let expected = 1.0 - 2.0 * (-0.5_f64).exp();
    assert!((lag.servo(0.1).moved(-1.0, 1.0) - expected).abs() < 1e-12);
    let levels = RudderSettings {
        levels: Some(3),
        ..none
    };
    assert_eq!(
        [0.0, 1.0, 2.0].map(|level| levels.command(level)),
        [-1.0, 0.0, 1.0]
    );
    assert!(levels.check_action(3.0).is_err());
    assert!(levels.check_action(0.5).is_err());
    assert!(levels.check_action(-1.0).is_err());
}
