//! Five boats in a row, bow to stern, push the outer wall with the force 5·c0·v0.

use super::{on_all_cores, push_row, table};
use crate::table::{Table, number, text};
use crate::{Configuration, Scene, Start};
use flockenv::FlockParameters;
use flockenv::geometry::{Hull, Pose, Velocity};
use flockenv::parameters::Pool;

const BOATS: usize = 5;
/// Time for the row to come to rest, in s.
pub const TRANSIENT_S: f64 = 1.0;
/// Time over which the force is averaged, in s.
pub const AVERAGED_S: f64 = 1.0;

/// Five boats with their motors forward, without inner wall and noise.
pub fn scene() -> FlockParameters {
    FlockParameters {
        c4: 0.0,
        pool: Pool {
            inner_radius_cm: 0.0,
            ..Pool::NARROW
        },
        ..Scene::Jam.parameters(BOATS)
    }
}

/// The row at rest, with touching boats; every other boat is `offset_cm` off the line. Chipmunk needs a small offset,
/// since it lets boats that are exactly in line pass through each other.
pub fn start(offset_cm: f64) -> Start {
    let parameters = scene();
    let reach = Hull::new(&parameters).reach();
    let wall = parameters.pool.outer_radius_cm;
    let pose = |k: usize| {
        let y = offset_cm * (k % 2) as f64;
        Pose::new(wall - reach - 2.0 * reach * k as f64, y, 0.0)
    };
    Start {
        poses: (0..BOATS).map(pose).collect(),
        velocities: vec![Velocity::default(); BOATS],
        time_s: 0.0,
    }
}

/// The exact force on the wall in cm/s².
pub fn expected() -> f64 {
    BOATS as f64 * scene().c0 * scene().speed_cm_s
}

fn measured(configuration: &Configuration) -> f64 {
    let mut engine = configuration.build(&scene(), 1, &start(0.0));
    engine.advance(configuration.steps(TRANSIENT_S));
    let steps = configuration.steps(AVERAGED_S);
    let mut sum = 0.0;
    for _ in 0..steps {
        engine.advance(1);
        sum += engine.wall_force();
    }
    sum / steps as f64
}

/// The cells of one engine.
pub fn row(force: f64) -> Vec<String> {
    let relative = (force - expected()).abs() / expected();
    vec![
        text(BOATS),
        number(force),
        number(expected()),
        number(relative),
    ]
}

/// Names of the columns.
pub const COLUMNS: [&str; 4] = ["boats", "force_cm_s2", "expected_cm_s2", "force_error"];

/// Measures every configuration.
pub fn measure() -> Table {
    let all = Configuration::all();
    let forces = on_all_cores(&all, measured);
    let mut table = table(&COLUMNS);
    for (configuration, force) in all.iter().zip(forces) {
        push_row(&mut table, &configuration.cells(), row(force));
    }
    table
}
