//! The cost of each part of a scene: the cycle scene of 27 boats with one change at a time.

use super::{Effort, speed};
use crate::configuration::STEP_S;
use crate::table::{Table, number, quartiles, text};
use crate::{Configuration, Engine, Scene, Start};
use flockenv::FlockParameters;
use flockenv::parameters::{Noise, Pool, Scheme};
use speed::{Entry, take_turns};

/// Scenes, each with the words for its change.
fn scenes() -> Vec<(&'static str, FlockParameters)> {
    let whole = Scene::Cycle.parameters(27);
    let pool = |outer, inner| Pool {
        outer_radius_cm: outer,
        inner_radius_cm: inner,
    };
    let open = FlockParameters {
        pool: pool(f64::INFINITY, 0.0),
        ..whole.clone()
    };
    let outer = whole.pool.outer_radius_cm;
    vec![
        (
            "open water; no noise",
            FlockParameters {
                c4: 0.0,
                ..open.clone()
            },
        ),
        ("open water", open),
        (
            "outer wall only",
            FlockParameters {
                pool: pool(outer, 0.0),
                ..whole.clone()
            },
        ),
        ("both walls", whole.clone()),
        (
            "both walls; no noise",
            FlockParameters {
                c4: 0.0,
                ..whole.clone()
            },
        ),
        (
            "both walls; per-step noise",
            FlockParameters {
                noise_scheme: Noise::PerStep,
                ..whole.clone()
            },
        ),
        (
            "both walls; 3 leaders",
            FlockParameters {
                n_leaders: 3,
                ..whole.clone()
            },
        ),
        (
            "both walls; all 27 lead",
            FlockParameters {
                n_leaders: 27,
                ..whole.clone()
            },
        ),
        (
            "both walls; turning bias",
            FlockParameters {
                turning_bias: 0.2,
                ..whole.clone()
            },
        ),
        (
            "both walls; speed spread",
            FlockParameters {
                speed_spread_cm_s: 5.0,
                ..whole.clone()
            },
        ),
        (
            "both walls; current",
            FlockParameters {
                current_gain: 0.5,
                ..whole.clone()
            },
        ),
        (
            "both walls; engines always forward",
            Scene::Jam.parameters(27),
        ),
    ]
}

/// Contacts and near-contacts per step, over the time that is timed.
fn contacts_per_step(parameters: &FlockParameters, timed_s: f64) -> f64 {
    let configuration = Configuration::exact(Scheme::Leapfrog, f64::INFINITY, STEP_S);
    let start = Start::placed(parameters, 1);
    let mut engine: Box<dyn Engine> = configuration.build(parameters, 1, &start);
    engine.advance(configuration.steps(speed::WARM_UP_S));
    let before = engine.statistics().unwrap_or_default();
    engine.advance(configuration.steps(timed_s));
    let after = engine.statistics().unwrap_or_default();
    (after.contacts - before.contacts) as f64 / (after.substeps - before.substeps) as f64
}

/// Times every scene; scenes take turns.
pub fn measure(effort: Effort) -> Table {
    let timed_s = effort.choose(12.0, speed::TIMED_S);
    let scenes = scenes();
    let entries: Vec<Entry> = scenes
        .iter()
        .map(|(_, parameters)| Entry {
            configuration: Configuration::exact(Scheme::Leapfrog, f64::INFINITY, STEP_S),
            parameters: parameters.clone(),
        })
        .collect();
    let times = take_turns(&entries, effort.choose(1, 3), timed_s);
    let mut table = Table::new(&[
        "scene",
        "us_per_step",
        "us_q1",
        "us_q3",
        "contacts_per_step",
    ]);
    for ((name, parameters), times) in scenes.iter().zip(times) {
        let [q1, middle, q3] = quartiles(&times.whole);
        table.row(vec![
            text(name),
            number(middle),
            number(q1),
            number(q3),
            number(contacts_per_step(parameters, timed_s)),
        ]);
    }
    table
}
