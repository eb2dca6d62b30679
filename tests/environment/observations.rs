//! Observations stay inside their bounds, the table describes them, and eq. (10) can be read from them.

use crate::support::{batch, parameters, settings, step};
use flockenv::environment::EnvSettings;
use flockenv::environment::observation::{
    Block, FlockView, ObservationLayout, Observer, observe_flock,
};
use flockenv::flock::State;
use flockenv::geometry::{Pose, Velocity};
use flockenv::parameters::Pool;
use flockenv::policies::{Law, ObservedLaw};
use flockenv::{Flock, FlockParameters};

#[test]
fn layout_adds_up() {
    let layout = ObservationLayout::default();
    assert_eq!(layout.size(), layout.entries().len());
    assert_eq!(layout.size(), 8 + 6 + 1 + 6 * 8 + 4);
    assert_eq!(layout.offset(Block::Target), Some(14));
    assert_eq!(layout.index(Block::Order, "mean_sin_orientation"), Some(64));
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
            let reflected = mirror_to_target && episode.targets().reference().sign() < 0.0;
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
    let without = ObservationLayout::from_blocks(&[Block::Target]);
    let message = ObservedLaw::new(Law::Paper, &without)
        .unwrap_err()
        .to_string();
    assert!(message.contains("own"), "{message}");
}

/// Boats on a grid, so that many are equally far from a leader, each with a heading of its own.
fn grid(boats: usize, leaders: usize) -> Flock {
    let place =
        |boat: usize| Pose::new((7 * boat % 6) as f64, (boat % 5) as f64, TURN * boat as f64);
    let state = State {
        poses: (0..boats).map(place).collect(),
        velocities: vec![Velocity::default(); boats],
        time_s: 0.0,
        allow_overlap: true,
    };
    let own = FlockParameters {
        n_boats: boats,
        pool: Pool {
            outer_radius_cm: 90.0,
            inner_radius_cm: 0.0,
        },
        ..parameters(leaders)
    };
    Flock::from_state(own, 0, &state).unwrap()
}

const TURN: f64 = 0.03;

#[test]
fn the_nearest_come_first_and_equally_near_ones_in_the_order_of_boats() {
    for (boats, leaders) in [(1, 1), (2, 2), (27, 6), (90, 5)] {
        let flock = grid(boats, leaders);
        for wanted in [1, 3, 6, 16, 17, 64] {
            let mut layout = ObservationLayout::from_blocks(&[Block::Neighbors]);
            layout.repeat(Block::Neighbors, wanted);
            let observed = observe_flock(&flock, layout, &[]).unwrap();
            for (leader, row) in observed.chunks_exact(layout.size()).enumerate() {
                let own = flock.poses()[leader];
                let square =
                    |boat: &usize| (flock.poses()[*boat].position - own.position).norm_squared();
                let mut expected: Vec<_> = (0..boats).filter(|&boat| boat != leader).collect();
                expected.sort_by(|a, b| square(a).total_cmp(&square(b)));
                expected.truncate(wanted);
                let present = row
                    .chunks_exact(layout.size() / wanted)
                    .filter(|each| each[0] > 0.0);
                // Cosine of the angle between the headings, and its sine, positive clockwise.
                let turned = present.map(|each| f64::from(-each[4]).atan2(each[3].into()));
                let found = turned.map(|angle| (leader as f64 + angle / TURN).round() as usize);
                assert_eq!(
                    found.collect::<Vec<_>>(),
                    expected,
                    "{boats} boats, {wanted} wanted"
                );
            }
        }
    }
}

#[test]
fn the_nearest_do_not_depend_on_those_seen_before() {
    // A dense flock and one spread over the pool take turns: limits kept from one are far too narrow or wide for the other.
    let own = FlockParameters {
        n_boats: 27,
        ..parameters(6)
    };
    let (dense, spread) = (grid(27, 6), Flock::new(own, 1).unwrap());
    let mut layout = ObservationLayout::from_blocks(&[Block::Neighbors]);
    layout.repeat(Block::Neighbors, 6);
    let mut observer = Observer::new(layout, spread.parameters()).unwrap();
    for flock in [&dense, &spread, &dense, &dense, &spread] {
        let mut observed = vec![0.0; 6 * layout.size()];
        observer.observe(&FlockView::new(flock, &[], None), &mut observed);
        assert_eq!(observed, observe_flock(flock, layout, &[]).unwrap());
    }
}
