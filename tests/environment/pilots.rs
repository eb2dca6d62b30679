//! Leaders that follow a law by themselves do what the environment's do, given the law's actions: bit for bit.

use crate::support::{changed, flock, parameters, seeded, step};
use flockenv::Flock;
use flockenv::environment::observation::{Block, ObservationLayout, observe_flock};
use flockenv::environment::{ActionMode, EnvBatch, EnvSettings, TargetChoice};
use flockenv::parameters::{Target, Targets};
use flockenv::policies::{Law, LeaningLaw, ObservedLaw, Pilot};

/// The learned leaders of the other pool, as a law of this one.
fn learned() -> LeaningLaw {
    let mut law = LeaningLaw::learned(Some("wide")).unwrap();
    law.pool = "narrow".to_owned();
    law
}

/// The learned law, holding its leans for so long with the tuned gains.
fn holding(period_s: f64) -> Law {
    let Ok(Law::Damped(gains)) = Law::named("tuned law", Some("narrow")) else {
        panic!("the law is tuned in this pool");
    };
    let mut law = learned();
    law.gains = Some(gains);
    law.decision_period_s = Some(period_s);
    Law::Leaning(Box::new(law))
}

fn laws() -> Vec<(Law, Option<f64>)> {
    let named = Law::NAMED.iter().map(|each| each.name);
    let mut laws: Vec<_> = named
        .filter(|name| ![Law::EVERY_SUBSTEP, "learned"].contains(name))
        .map(|name| (Law::named(name, Some("narrow")).unwrap(), None))
        .collect();
    laws.push((Law::Leaning(Box::new(learned())), None));
    laws.push((holding(0.5), Some(0.5)));
    laws
}

#[test]
fn a_pilot_and_an_environment_with_the_laws_actions_are_the_same() {
    for (law, period) in laws() {
        for target in [Target::Clockwise, Target::CounterClockwise] {
            let blocks = [Block::Own, Block::LeanFeatures];
            let mut settings = EnvSettings {
                observation: ObservationLayout::from_blocks(&blocks),
                ..EnvSettings::default()
            };
            settings.mirror_to_target = true;
            settings.target = TargetChoice::Fixed(Targets::Each(vec![target; 3]));
            settings.decision_period_s = period;
            if period.is_some() {
                settings.action_mode = ActionMode::Lean;
            }
            let observed = ObservedLaw::new(law.clone(), &settings.layout()).unwrap();
            let size = settings.observation.size();
            let mut batch = EnvBatch::new(settings, vec![parameters(3)]).unwrap();
            batch.reset(&[seeded(5)]).unwrap();
            let mut piloted = flock(&batch, 0).clone();
            assert_eq!(piloted.parameters().target, Targets::Each(vec![target; 3]));
            let mut pilot = Pilot::new(law.clone(), piloted.parameters(), 10.0).unwrap();

            let mut rows = vec![0.0; 3 * size];
            batch.observe(&mut rows);
            let decisions = 60;
            for _ in 0..decisions {
                let rows_of = rows.chunks_exact(size);
                let actions: Vec<_> = rows_of.map(|row| observed.action(row)).collect();
                rows = step(&mut batch, &actions).unwrap().observations;
            }
            let steps = period.map_or(1, |period| (10.0 * period) as u32);
            for _ in 0..decisions * steps {
                let rudders = pilot.rudders(&piloted).unwrap();
                piloted.advance(0.1, Some(&rudders)).unwrap();
            }
            assert_eq!(piloted.time(), flock(&batch, 0).time());
            assert_eq!(piloted.poses(), flock(&batch, 0).poses(), "{law:?}");
        }
    }
}

#[test]
fn a_law_is_stored_to_the_bit() {
    let law = LeaningLaw::learned(Some("wide")).unwrap();
    let again = LeaningLaw::from_json(&law.to_json().unwrap()).unwrap();
    assert_eq!(law, again);
}

#[test]
fn laws_whose_gains_are_no_numbers_lead_nobody() {
    let Ok(Law::Damped(gains)) = Law::named("tuned law", Some("narrow")) else {
        panic!("the law is tuned in this pool");
    };
    let layout = ObservationLayout::from_blocks(&[Block::Own, Block::LeanFeatures]);
    for wrong in [f64::NAN, f64::INFINITY, 1e10] {
        for place in 0..3 {
            let mut own = gains;
            *[&mut own.gain, &mut own.backward_gain, &mut own.damping][place] = wrong;
            let mut leaning = learned();
            leaning.gains = Some(own);
            for law in [Law::Damped(own), Law::Leaning(Box::new(leaning))] {
                assert!(law.check().is_err(), "{law:?}");
                assert!(ObservedLaw::new(law.clone(), &layout).is_err());
                assert!(Pilot::new(law, &parameters(1), 10.0).is_err());
            }
        }
    }
}

#[test]
fn a_rudder_chosen_before_the_target_is_reversed_is_held() {
    let mut law = learned();
    (law.gains, law.decision_period_s) = (None, Some(0.4));
    let law = Law::Leaning(Box::new(law));
    let settings = EnvSettings {
        observation: ObservationLayout::from_blocks(&[Block::LeanFeatures]),
        mirror_to_target: true,
        target: TargetChoice::Alternate,
        episode_s: Some(4.0),
        decision_period_s: Some(0.4),
        ..EnvSettings::default()
    };
    let observed = ObservedLaw::new(law.clone(), &settings.layout()).unwrap();
    let size = settings.observation.size();
    let mut batch = EnvBatch::new(settings, vec![parameters(3)]).unwrap();
    batch.reset(&[seeded(5)]).unwrap();
    let mut piloted = flock(&batch, 0).clone();
    let mut pilot = Pilot::new(law, piloted.parameters(), 10.0).unwrap();
    let mut rows = vec![0.0; 3 * size];
    batch.observe(&mut rows);
    // The first quarter of the episode ends after 10 steps, in the middle of a hold.
    for control_step in 0..12 {
        if control_step == 10 {
            piloted.set_target(Target::Clockwise).unwrap();
        }
        if control_step % 4 == 0 {
            let rows_of = rows.chunks_exact(size);
            let actions: Vec<_> = rows_of.map(|row| observed.action(row)).collect();
            rows = step(&mut batch, &actions).unwrap().observations;
        }
        let rudders = pilot.rudders(&piloted).unwrap();
        piloted.advance(0.1, Some(&rudders)).unwrap();
    }
    assert_eq!(piloted.poses(), flock(&batch, 0).poses());
}

#[test]
fn a_law_of_rudders_turns_them_over_where_its_observation_is_not_mirrored() {
    let mut law = learned();
    (law.gains, law.decision_period_s) = (None, Some(0.4));
    let law = Law::Leaning(Box::new(law));
    let plain = ObservationLayout::from_blocks(&[Block::Target, Block::LeanFeatures]);
    for target in [Target::Clockwise, Target::CounterClockwise] {
        let of_target = changed(parameters(3), |p| p.target = target.into());
        let flock = Flock::new(of_target, 5).unwrap();
        let action = |layout: ObservationLayout| {
            let observed = ObservedLaw::new(law.clone(), &layout).unwrap();
            let rows = observe_flock(&flock, layout, &[0.0; 3]).unwrap();
            observed.action(&rows[..layout.size()])
        };
        let mirrored = action(plain.mirrored(true));
        assert!(mirrored != 0.0);
        assert_eq!(action(plain), target.sign() * mirrored);
    }
    let without_target = ObservationLayout::from_blocks(&[Block::LeanFeatures]);
    let refused = ObservedLaw::new(law, &without_target).unwrap_err();
    assert!(refused.to_string().contains("target: off"), "{refused}");
}
