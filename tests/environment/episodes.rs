//! What a seed fixes, when targets change, what autoresets do, what servos do.

use crate::support::{batch, changed, flock, parameters, settings, step};
use flockenv::Flock;
use flockenv::environment::{
    Autoreset, Drawn, EnvSettings, EpisodeSchedule, EpisodeSeeds, TargetChoice,
};
use flockenv::parameters::Target;

#[test]
fn the_first_episode_has_the_seed_itself() {
    let batch = batch(settings(30), &[2], 17);
    let expected = Flock::new(parameters(2), 17).unwrap();
    assert_eq!(flock(&batch, 0).poses(), expected.poses());
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
    let target = TargetChoice::Alternate;
    let plan = changed(EnvSettings::default(), |own| own.target = target);
    assert_eq!(plan.steps(), 9600);
    assert_eq!(EnvSettings::default().steps(), 4800);
    let (mut episode, _) = EpisodeSchedule::new(&plan, &plan.target, 0);
    for (step, target) in [
        (0, Target::CounterClockwise),
        (2399, Target::CounterClockwise),
        (2400, Target::Clockwise),
        (4800, Target::CounterClockwise),
        (7200, Target::Clockwise),
        (9600, Target::Clockwise),
    ] {
        episode.step = step;
        assert_eq!(episode.targets().reference(), target, "at step {step}");
    }
}

#[test]
fn random_targets_are_even_and_noise_levels_uniform() {
    let plan = EnvSettings::default();
    let episodes: Vec<(EpisodeSchedule, f64)> = (0..4000)
        .map(|seed| EpisodeSchedule::new(&plan, &TargetChoice::Random, seed))
        .collect();
    let clockwise = episodes
        .iter()
        .filter(|(episode, _)| episode.targets().reference() == Target::Clockwise)
        .count();
    assert!((1850..2150).contains(&clockwise), "{clockwise}");
    let levels = || {
        let drawn = Drawn::Uniform(0.2, 0.6);
        episodes.iter().map(move |(_, share)| drawn.at(*share))
    };
    let mean = levels().sum::<f64>() / 4000.0;
    assert!((mean - 0.4).abs() < 0.01, "{mean}");
    assert!(levels().all(|bw_s| (0.2..=0.6).contains(&bw_s)));
    // Fixing one of them leaves the other as it was drawn.
    let same = |seed: u64| {
        let (_, share) = EpisodeSchedule::new(&plan, &plan.target, seed);
        share == episodes[seed as usize].1
    };
    assert!((0..100).all(same));
    assert_eq!(Drawn::Fixed(0.3).at(0.7), 0.3);
}

#[test]
fn autoresets_start_the_same_episode() {
    let same_step = changed(settings(4), |own| own.autoreset_mode = Autoreset::SameStep);
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
    let none = EnvSettings::default;
    assert_eq!(none().servo().moved(-1.0, 1.0), 1.0);
    let rate = changed(none(), |own| own.rudder_rate_per_s = Some(4.0));
    assert!((rate.servo().moved(-1.0, 1.0) + 0.6).abs() < 1e-12);
    assert_eq!(rate.servo().moved(0.9, 1.0), 1.0);
    let lag = changed(none(), |own| own.rudder_lag_s = 0.2);
    let expected = 1.0 - 2.0 * (-0.5_f64).exp();
    assert!((lag.servo().moved(-1.0, 1.0) - expected).abs() < 1e-12);
    let levels = changed(none(), |own| own.rudder_levels = Some(3));
    assert_eq!(
        [0.0, 1.0, 2.0].map(|level| levels.command(level)),
        [-1.0, 0.0, 1.0]
    );
    assert!(levels.check_action(3.0).is_err());
    assert!(levels.check_action(0.5).is_err());
    assert!(levels.check_action(-1.0).is_err());
}
