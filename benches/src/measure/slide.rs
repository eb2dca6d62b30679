//! One boat slides along the outer wall of `narrow` for 2 s, its bow touching all the time: the
//! distance from the pose that steps of 1e-4 s reach.

use super::{distance, on_all_cores, push_row, table};
use crate::table::{Table, number, quartiles};
use crate::{Configuration, Scene, Start};
use flockenv::FlockParameters;
use flockenv::geometry::{Hull, Pose, Vec2, Velocity, turned_left};
use flockenv::parameters::Scheme;

/// Duration of the slide in s.
pub const SLIDE_S: f64 = 2.0;
/// Initial rate at which the boat circles the pool, in rad/s.
const CIRCLING: f64 = 0.12;

/// One boat with its motor forward, without noise.
pub fn scene() -> FlockParameters {
    FlockParameters {
        c4: 0.0,
        ..Scene::Jam.parameters(1)
    }
}

/// Starts that differ in how far outward of the tangent the boat heads, 26° to 66°. It moves as if
/// rigidly fixed to a wheel about the pool's center, so that the bow stays on the wall.
pub fn starts() -> Vec<Start> {
    let parameters = scene();
    let hull = Hull::new(&parameters);
    let outward = (0..8).map(|k| 0.45 + 0.1 * f64::from(k));
    let start = |outward: f64| {
        let bow = Vec2::new(parameters.pool.outer_radius_cm - hull.radius, 0.0);
        let heading = std::f64::consts::FRAC_PI_2 - outward;
        let axis = Vec2::new(heading.cos(), heading.sin());
        let position = bow - axis * hull.half_length;
        let linear = turned_left(position) * CIRCLING;
        Start {
            poses: vec![Pose { position, heading }],
            velocities: vec![Velocity {
                linear,
                angular: CIRCLING,
            }],
            time_s: 0.0,
        }
    };
    outward.map(start).collect()
}

/// The boat's final pose for each start.
pub fn ends(configuration: &Configuration) -> Vec<Vec<Pose>> {
    let end = |start: &Start| {
        let mut engine = configuration.build(&scene(), 1, start);
        engine.advance(configuration.steps(SLIDE_S));
        engine.poses()
    };
    starts().iter().map(end).collect()
}

/// Final poses that steps of 1e-4 s reach.
pub fn reference() -> Vec<Vec<Pose>> {
    ends(&Configuration::exact(Scheme::Leapfrog, 1e-9, 1e-4))
}

/// The cells of one engine: median and worst over the starts.
pub fn row(ends: &[Vec<Pose>], reference: &[Vec<Pose>]) -> Vec<String> {
    let pairs = ends.iter().zip(reference);
    let errors: Vec<f64> = pairs
        .map(|(end, exact)| distance(&scene(), end, exact))
        .collect();
    let worst = errors.iter().copied().fold(0.0, f64::max);
    vec![number(quartiles(&errors)[1]), number(worst)]
}

/// Names of the columns.
pub const COLUMNS: [&str; 2] = ["slide_median_cm", "slide_worst_cm"];

/// Measures every configuration, and the exact solver at two smaller steps for the order.
pub fn measure() -> Table {
    let mut all = Configuration::all_exact();
    for &scheme in Scheme::ALL {
        all.extend([0.00125, 0.0025].map(|dt_s| Configuration::exact(scheme, 1e-9, dt_s)));
    }
    all.extend(Configuration::all_inexact());
    all.extend(Configuration::all_peers());
    let reference = reference();
    let rows = on_all_cores(&all, |configuration| row(&ends(configuration), &reference));
    let mut table = table(&COLUMNS);
    for (configuration, row) in all.iter().zip(rows) {
        push_row(&mut table, &configuration.cells(), row);
    }
    table
}
