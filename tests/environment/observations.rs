//! Observations stay inside their bounds, the table describes them, and eq. (10) can be read from them.

use crate::support::{batch, settings, step};
use flockenv::environment::EnvSettings;
use flockenv::environment::observation::{Block, ObservationLayout};
use flockenv::policies::{Law, ObservedLaw};

#[test]
fn layout_adds_up() {
    let layout = ObservationLayout::default();
    assert_eq!(layout.size(), layout.entries().len());
    assert_eq!(layout.size(), 8 + 6 + 1 + 6 * 8 + 4);
    assert_eq!(layout.offset(Block::Target), Some(14));
    assert_eq!(layout.place(Block::Order, "mean_sin_orientation"), Some(64));
    let mut few = layout;
    few.repeat(Block::Phase, 0);
    few.repeat(Block::Neighbors, 0);
    assert_eq!(few.offset(Block::Target), Some(8));
    assert_eq!(few.offset(Block::Neighbors), None);
    assert_eq!(few.offset(Block::Order), Some(9));
}

#[test]
fn every_number_is_inside_its_bounds() {
    let mut batch = batch(settings(200), &[3; 4], 0);
    let entries = batch.settings().observation.entries();
    for time in 0..200 {
        let actions: Vec<f64> = (0..12).map(|row| f64::from(row * time).sin()).collect();
        let written = step(&mut batch, &actions).unwrap();
        for (place, &value) in written.observations.iter().enumerate() {
            let (_, _, entry) = entries[place % entries.len()];
            let value = f64::from(value);
            assert!(
                (entry.low..=entry.high).contains(&value),
                "{entry:?}: {value}"
            );
        }
    }
    // Some of nine boats are beyond 120 cm, where distances are clipped.
    for env in batch.envs() {
        assert!(env.episode().unwrap().summary().clip_rate < 0.03);
    }
}

#[test]
fn steering_law_can_be_read_from_the_observation() {
    for mirror_to_target in [false, true] {
        let mut own = settings(4000);
        own.mirror_to_target = mirror_to_target;
        own.target = flockenv::environment::TargetChoice::Alternate;
        let law = ObservedLaw::new(Law::Paper, &own.layout()).unwrap();
        let mut batch = batch(EnvSettings { ..own }, &[4], 3);
        let size = batch.observation_size();
        let mut worst: f64 = 0.0;
        let mut actions = vec![0.0; 4];
        for _ in 0..3999 {
            let written = step(&mut batch, &actions).unwrap();
            let episode = batch.envs()[0].episode().unwrap();
            let reflected = mirror_to_target && episode.schedule().target().sign() < 0.0;
            for (leader, row) in written.observations.chunks_exact(size).enumerate() {
                actions[leader] = law.action(row);
                let expected = episode.flock().steering_law(leader);
                let expected = if reflected { -expected } else { expected };
                worst = worst.max((actions[leader] - expected).abs());
            }
        }
        assert!(worst < 1e-6, "{worst}");
    }
}

#[test]
fn laws_name_a_block_that_is_off() {
    let without = ObservationLayout::of(&[Block::Target]);
    let message = ObservedLaw::new(Law::Paper, &without)
        .unwrap_err()
        .to_string();
    assert!(message.contains("own"), "{message}");
}
