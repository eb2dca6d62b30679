//! Bytes of a batch continue bit for bit, and no bytes at all reach a panic.

use crate::support::{batch, settings, step};
use flockenv::Flock;
use flockenv::environment::{Autoreset, EnvBatch, EnvSettings, RewardWeights, TERMS, TargetChoice};
use flockenv::parameters::Target::{Clockwise, CounterClockwise};
use flockenv::parameters::{FlockParameters, Targets};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn rich_settings() -> EnvSettings {
    EnvSettings {
        dropout_rate: 0.2,
        delay_frames: 1,
        ..settings(12)
    }
}

#[test]
fn a_restored_batch_goes_on_bit_for_bit() {
    let mut original = batch(rich_settings(), &[1, 3], 0);
    for time in 0..40 {
        let bytes = original.to_bytes();
        let mut copy = EnvBatch::from_bytes(&bytes).unwrap();
        assert_eq!(copy.to_bytes(), bytes);
        let actions = [f64::from(time).sin(), 0.2, -0.7, 1.0];
        assert_eq!(step(&mut original, &actions), step(&mut copy, &actions));
        assert_eq!(original.to_bytes(), copy.to_bytes());
    }
}

#[test]
fn states_of_other_batches_are_refused() {
    let mut own = batch(settings(12), &[1, 3], 0);
    let before = own.to_bytes();
    for other in [
        batch(settings(13), &[1, 3], 0),
        batch(settings(12), &[3, 1], 0),
        batch(settings(12), &[1], 0),
        batch(rich_settings(), &[1, 3], 0),
    ] {
        assert!(own.restore(&other.to_bytes()).is_err());
        assert_eq!(own.to_bytes(), before);
    }
    own.restore(&batch(settings(12), &[1, 3], 9).to_bytes())
        .unwrap();
}

/// The seal of `sealed_bytes`, so that damage gets past the checksum.
fn reseal(bytes: &mut [u8]) {
    let sum = u64::from(crc32fast::hash(&bytes[16..]));
    bytes[8..16].copy_from_slice(&sum.to_le_bytes());
}

/// A batch in the middle of its second episode, with everything that it may hold.
fn stored_batch() -> EnvBatch {
    let mut own = rich_settings();
    own.reward = RewardWeights([1.0; TERMS]);
    own.autoreset_mode = Autoreset::SameStep;
    own.target = TargetChoice::Fixed(Targets::Each(vec![Clockwise, CounterClockwise]));
    let mut batch = batch(own, &[2, 2], 2011);
    for time in 0..20 {
        step(&mut batch, &[f64::from(time).sin(), 0.2, -0.7, 1.0]).unwrap();
    }
    batch
}

/// A flock in motion, with everything that it may hold.
fn stored_flock() -> Flock {
    let parameters = FlockParameters {
        n_boats: 12,
        n_leaders: 2,
        target: Targets::Each(vec![Clockwise, CounterClockwise]),
        ..FlockParameters::default()
    };
    let mut flock = Flock::new(parameters, 2011).unwrap();
    flock.advance(1.0, None).unwrap();
    flock = Flock::from_snapshot(&flock.snapshot(), Some(5)).unwrap();
    flock.advance(1.23, Some(&[0.5, -0.5])).unwrap();
    flock
}

/// Written by version 1 of each format. If a format changes once it is released: raise the version in its magic. Then
/// write these again: `WRITE_FIXTURES=1 cargo test --test environment`.
const BATCH: &[u8] = include_bytes!("../fixtures/environment_1.state");
const FLOCK: &[u8] = include_bytes!("../fixtures/flock_1.snapshot");

#[test]
fn states_of_this_version_are_read_and_written_as_the_same_bytes() {
    let [batch, flock] = [stored_batch().to_bytes(), stored_flock().snapshot()];
    if std::env::var_os("WRITE_FIXTURES").is_some() {
        std::fs::write("tests/fixtures/environment_1.state", &batch).unwrap();
        std::fs::write("tests/fixtures/flock_1.snapshot", &flock).unwrap();
    }
    assert!(
        batch == BATCH,
        "the batch of the fixture's seed has other bytes"
    );
    assert!(
        flock == FLOCK,
        "the flock of the fixture's seed has other bytes"
    );
    assert_eq!(EnvBatch::from_bytes(BATCH).unwrap().to_bytes(), BATCH);
    assert_eq!(Flock::from_snapshot(FLOCK, None).unwrap().snapshot(), FLOCK);
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        rng_seed: RngSeed::Fixed(2011),
        ..ProptestConfig::default()
    })]
    #[test]
    fn damaged_bytes_are_refused_or_can_be_lived_with(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        seal in any::<bool>(),
    ) {
        let mut bytes = batch(rich_settings(), &[2], 0).to_bytes();
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if seal {
            reseal(&mut bytes);
        }
        if let Ok(mut lived) = EnvBatch::from_bytes(&bytes) {
            let actions = vec![0.5; lived.rows()];
            if lived.rows() < 100 {
                let _ = step(&mut lived, &actions);
            }
        }
    }
}
