//! With a target for each leader, a leader sees, is rewarded and steers as if its target were everybody's.

use crate::support::{Written, batch, changed, flock, parameters, seeded, settings, step};
use flockenv::Flock;
use flockenv::environment::observation::FlockFeatures;
use flockenv::environment::{ActionMode, EnvBatch, EnvSettings, ResetRequest, TargetChoice};
use flockenv::environment::{RewardWeights, Weights};
use flockenv::parameters::Target::{self, Clockwise, CounterClockwise};
use flockenv::parameters::{Targets, Value};

const MIXED: [Target; 3] = [Clockwise, CounterClockwise, Clockwise];

fn each(targets: &[Target]) -> TargetChoice {
    TargetChoice::Fixed(Targets::Each(targets.to_vec()))
}

fn all(target: Target) -> TargetChoice {
    TargetChoice::Fixed(target.into())
}

fn mixed_and_unmixed() -> [TargetChoice; 3] {
    [each(&MIXED), all(Clockwise), all(CounterClockwise)]
}

/// Every reward term has a weight, those from contacts too.
fn towards(steps: u32, target: TargetChoice) -> EnvSettings {
    let mut own = settings(steps);
    own.target = target;
    own.reward = Weights::One(RewardWeights(std::array::from_fn(|term| 1.0 + term as f64)));
    own
}

fn rows(written: &Written) -> Vec<(&[f32], f64)> {
    let size = written.observations.len() / written.rewards.len();
    let observed = written.observations.chunks_exact(size);
    observed.zip(written.rewards.iter().copied()).collect()
}

/// Steps three batches whose targets are mixed, all clockwise and all counter-clockwise through the same motion, and
/// compares each leader of the first with its own in the batch of its target.
fn compare(change: impl Fn(&mut EnvSettings)) {
    let mut batches = mixed_and_unmixed().map(|target| {
        let mut own = towards(200, target);
        change(&mut own);
        batch(own, &[3], 5)
    });
    let mirrored = batches[0].settings().mirror_to_target;
    for time in 0..200 {
        let rudders: Vec<f64> = (0..3).map(|k| f64::from(time + 7 * k).sin()).collect();
        let written: Vec<Written> = batches
            .iter_mut()
            .map(|batch| {
                let targets = batch.envs()[0].episode().unwrap().targets().clone();
                let flipped = |leader: usize| mirrored && targets.of(leader) == CounterClockwise;
                let chosen = rudders.iter().enumerate();
                let actions: Vec<f64> = chosen
                    .map(|(leader, &rudder)| if flipped(leader) { -rudder } else { rudder })
                    .collect();
                step(batch, &actions).unwrap()
            })
            .collect();
        for (leader, target) in MIXED.iter().enumerate() {
            let own = if *target == Clockwise { 1 } else { 2 };
            let [found, expected] = [0, own].map(|batch| rows(&written[batch])[leader]);
            assert_eq!(found, expected, "at {time}");
        }
        assert_eq!(flock(&batches[0], 0).poses(), flock(&batches[2], 0).poses());
    }
}

#[test]
fn a_leader_sees_and_is_rewarded_as_if_its_target_were_everybodys() {
    compare(|_| ());
    compare(|own| own.mirror_to_target = true);
    compare(|own| {
        (own.dropout_rate, own.delay_frames) = (0.3, 1);
    });
}

#[test]
fn an_action_that_stands_for_a_heading_is_taken_from_the_leaders_own_target() {
    for mode in [ActionMode::Heading, ActionMode::Lean] {
        let rudders = mixed_and_unmixed().map(|target| {
            let mut own = towards(5, target);
            own.action_mode = mode;
            let mut batch = batch(own, &[3], 5);
            step(&mut batch, &[0.1, 0.1, 0.1]).unwrap();
            batch.envs()[0].episode().unwrap().rudders().to_vec()
        });
        assert_eq!(rudders[0], [rudders[1][0], rudders[2][1], rudders[1][2]]);
        assert_ne!(rudders[1][1], rudders[2][1]);
    }
}

#[test]
fn a_list_of_equal_targets_is_one_target() {
    let mut one = batch(towards(60, all(CounterClockwise)), &[3], 1);
    let mut list = batch(towards(60, each(&[CounterClockwise; 3])), &[3], 1);
    for time in 0..60 {
        let actions = [0.3, -1.0, f64::from(time).cos()];
        assert_eq!(step(&mut one, &actions), step(&mut list, &actions));
        let observed = [&one, &list].map(|batch| {
            let env = &batch.envs()[0];
            let mut state = vec![0.0; env.state_size()];
            let mut features = vec![0.0; 3 * FlockFeatures::SIZE];
            env.observe_state(&mut state);
            env.observe_features(&mut features);
            let summary = format!("{:?}", env.episode().unwrap().summary());
            (state, features, summary)
        });
        assert_eq!(observed[0], observed[1]);
    }
}

#[test]
fn the_papers_law_steers_each_leader_to_its_own_target() {
    let law = |target: Targets| {
        let own = changed(parameters(3), |p| p.target = target);
        let flock = Flock::new(own, 9).unwrap();
        [0, 1, 2].map(|leader| flock.steering_law(leader))
    };
    let (cw, ccw) = (law(Clockwise.into()), law(CounterClockwise.into()));
    assert_eq!(law(Targets::Each(MIXED.to_vec())), [cw[0], ccw[1], cw[2]]);
    assert!((0..3).all(|leader| cw[leader] != ccw[leader]));
}

#[test]
fn the_summary_is_towards_the_target_of_leader_0() {
    let summary = |target| {
        let mut batch = batch(towards(300, target), &[3], 2);
        let mut total = 0.0;
        for _ in 0..300 {
            let written = step(&mut batch, &[0.2, -0.2, 0.5]).unwrap();
            total += written.rewards.iter().sum::<f64>() / 3.0;
        }
        let found = *batch.envs()[0].finished().unwrap();
        assert!((found.total_reward - total).abs() < 1e-9 * total.abs().max(1.0));
        let mut means = found.averages.named();
        let order = means.find(|(name, _)| *name == "signed_order").unwrap().1;
        (order, found.share_towards_target)
    };
    let mixed = summary(each(&MIXED));
    assert_eq!(mixed, summary(all(Clockwise)));
    assert!(mixed.0 != 0.0);
    let ccw = summary(all(CounterClockwise));
    assert!((ccw.0 + mixed.0).abs() < 1e-12);
}

#[test]
fn the_global_state_has_the_mean_of_the_targets() {
    let state = |target| {
        let batch = batch(towards(10, target), &[3], 2);
        let mut state = vec![0.0; batch.envs()[0].state_size()];
        batch.envs()[0].observe_state(&mut state);
        state
    };
    let (mixed, cw) = (state(each(&MIXED)), state(all(Clockwise)));
    let place = cw.len() - 2;
    assert_eq!((mixed[place], cw[place]), (1.0 / 3.0, 1.0));
    assert_eq!(mixed[..place], cw[..place]);
}

#[test]
fn lists_of_another_length_are_refused_before_anything_changes() {
    let wrong = towards(10, each(&MIXED));
    for leaders in [2, 4] {
        let message = EnvBatch::new(wrong.clone(), vec![parameters(leaders)])
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(&format!("n_leaders = {leaders}")),
            "{message}"
        );
    }
    let mut own = batch(settings(10), &[3], 0);
    let before = own.to_bytes();
    let request = ResetRequest {
        target: Some(each(&[Clockwise])),
        ..seeded(3).unwrap()
    };
    assert!(own.reset(&[Some(request)]).is_err());
    assert_eq!(own.to_bytes(), before);
    let mut flock = Flock::new(parameters(3), 0).unwrap();
    assert!(flock.set_target(Targets::Each(vec![Clockwise])).is_err());
    assert_eq!(flock.parameters().target, Clockwise.into());
    for leaders in [0, 1] {
        let none = Targets::Each(Vec::new());
        let own = changed(parameters(leaders), |p| p.target = none);
        assert!(own.check().is_err());
    }
}

#[test]
fn what_is_drawn_or_alternates_stands_alone() {
    for name in ["random", "alternate", "CW"] {
        let names = ["cw", name].map(|name| Value::Name(name.to_owned()));
        let mut fields = EnvSettings::FIELDS.iter();
        let set = fields.find(|field| field.name == "target").unwrap().set;
        let outcome = set(&mut settings(10), &Value::List(names.to_vec()));
        let message = outcome.unwrap_err().to_string();
        assert!(
            message.contains(name) && message.contains("one per leader"),
            "{message}"
        );
    }
}

#[test]
fn restored_batches_go_on_bit_for_bit() {
    let mut own = towards(12, each(&MIXED));
    own.mirror_to_target = true;
    let mut original = batch(own, &[3, 3], 0);
    for time in 0..40 {
        let mut copy = EnvBatch::from_bytes(&original.to_bytes()).unwrap();
        assert_eq!(copy.to_bytes(), original.to_bytes());
        let actions = [f64::from(time).sin(), 0.2, -0.7, 1.0, -1.0, 0.0];
        assert_eq!(step(&mut original, &actions), step(&mut copy, &actions));
        assert_eq!(copy.envs()[1].finished(), original.envs()[1].finished());
        assert_eq!(copy.to_bytes(), original.to_bytes());
    }
    assert!(original.envs()[1].finished().is_some());
}

#[test]
fn targets_of_an_episode_may_be_requested() {
    let mut own = batch(settings(10), &[3], 0);
    let request = ResetRequest {
        target: Some(each(&MIXED)),
        ..seeded(3).unwrap()
    };
    own.reset(&[Some(request)]).unwrap();
    let episode = own.envs()[0].episode().unwrap();
    assert_eq!(*episode.targets(), Targets::Each(MIXED.to_vec()));
    own.reset(&[seeded(3)]).unwrap();
    let episode = own.envs()[0].episode().unwrap();
    assert_eq!(*episode.targets(), Clockwise.into());
}
