//! The error of a whole scene over a short time, before it grows chaotically: the distance from the poses that steps of
//! 1e-4 s reach. Runs start from states in the middle of a run. They have no noise, whose path would differ between steps.

use super::{Effort, distance, on_all_cores, push_row, table};
use crate::table::{Table, number, quartiles, text};
use crate::{Configuration, Engine, Scene, Start};
use flockenv::geometry::Pose;
use flockenv::parameters::Scheme;
use flockenv::{Flock, FlockParameters};

/// Times at which poses are compared, in s.
pub const HORIZONS_S: [f64; 2] = [0.5, 1.0];
const BOATS: usize = 27;

/// States after three cycles, at the start of a forward phase.
pub fn starts(scene: Scene, effort: Effort) -> Vec<Start> {
    let seeds: Vec<u64> = (1..=effort.choose(4, 12)).collect();
    on_all_cores(&seeds, |&seed| {
        let parameters = FlockParameters {
            dt_s: 0.002,
            tolerance_cm: 1e-9,
            ..scene.parameters(BOATS)
        };
        let mut flock = Flock::new(parameters, seed).expect("the boats fit");
        flock
            .advance(3.0 * Scene::BLOCK_S, None)
            .expect("the motion stays finite");
        Start::from_flock(&flock)
    })
}

/// The scene without noise.
pub fn parameters(scene: Scene) -> FlockParameters {
    FlockParameters {
        c4: 0.0,
        ..scene.parameters(BOATS)
    }
}

/// Poses at the horizons, for each start.
pub type Ends = Vec<[Vec<Pose>; 2]>;

/// Poses that a configuration reaches from the starts.
pub fn ends(configuration: &Configuration, scene: Scene, starts: &[Start]) -> Ends {
    let end = |start: &Start| {
        let mut engine = configuration.build(&parameters(scene), 1, start);
        let [first, second] = HORIZONS_S;
        [first, second - first].map(|seconds| {
            let engine: &mut dyn Engine = &mut *engine;
            engine.advance(configuration.steps(seconds));
            engine.poses()
        })
    };
    starts.iter().map(end).collect()
}

/// Poses that steps of 1e-4 s reach.
pub fn reference(scene: Scene, starts: &[Start]) -> Ends {
    let reference = Configuration::exact(Scheme::Leapfrog, 1e-9, 1e-4);
    let ends_of = |start: &Start| ends(&reference, scene, std::slice::from_ref(start));
    on_all_cores(starts, ends_of)
        .into_iter()
        .flatten()
        .collect()
}

/// Names of the columns.
pub const COLUMNS: [&str; 6] = [
    "scene",
    "horizon_s",
    "starts",
    "horizon_median_cm",
    "horizon_q1_cm",
    "horizon_q3_cm",
];

/// The rows of one engine, one for each horizon.
pub fn rows(scene: Scene, ends: &Ends, reference: &Ends) -> Vec<Vec<String>> {
    let parameters = parameters(scene);
    let row = |(index, horizon_s): (usize, f64)| {
        let pairs = ends.iter().zip(reference);
        let errors: Vec<f64> = pairs
            .map(|(end, exact)| distance(&parameters, &end[index], &exact[index]))
            .collect();
        let [q1, median, q3] = quartiles(&errors);
        vec![
            text(scene.name()),
            number(horizon_s),
            text(errors.len()),
            number(median),
            number(q1),
            number(q3),
        ]
    };
    HORIZONS_S.into_iter().enumerate().map(row).collect()
}

/// Measures every configuration.
pub fn measure(effort: Effort) -> Table {
    let all = Configuration::all();
    let mut table = table(&COLUMNS);
    for scene in Scene::ALL {
        let starts = starts(scene, effort);
        let reference = reference(scene, &starts);
        let row_groups = on_all_cores(&all, |configuration| {
            rows(scene, &ends(configuration, scene, &starts), &reference)
        });
        for (configuration, rows) in all.iter().zip(row_groups) {
            for row in rows {
                push_row(&mut table, &configuration.cells(), row);
            }
        }
    }
    table
}
