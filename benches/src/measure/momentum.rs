//! In open water without drag, propulsion and noise, collisions keep the total momentum and the total
//! angular momentum about any point.

use super::{on_all_cores, push_row, table};
use crate::table::{Table, number};
use crate::{Configuration, Scene, Start};
use flockenv::FlockParameters;
use flockenv::geometry::{Pose, Vec2, Velocity, cross};
use flockenv::parameters::Pool;

/// Duration of a run in s: long enough for the collisions in the middle.
pub const FLIGHT_S: f64 = 20.0;
const BOATS: usize = 27;

/// Twenty-seven boats on which only contacts act.
pub fn scene() -> FlockParameters {
    FlockParameters {
        pool: Pool {
            outer_radius_cm: f64::INFINITY,
            inner_radius_cm: 0.0,
        },
        c0: 0.0,
        c1: 0.0,
        c2: 0.0,
        c3: 0.0,
        c4: 0.0,
        ..Scene::Jam.parameters(BOATS)
    }
}

/// All boats move at 15 cm/s towards a point beside the center, and turn at different rates.
pub fn start() -> Start {
    let mut start = Start::placed(&scene(), 1);
    let positions = start.poses.iter().map(|pose| pose.position);
    start.velocities = positions
        .enumerate()
        .map(|(k, position)| {
            let direction = (Vec2::new(10.0, 5.0) - position).normalize();
            let angular = (k as f64 - 13.0) / 26.0;
            Velocity {
                linear: direction * 15.0,
                angular,
            }
        })
        .collect();
    start
}

/// Momentum, angular momentum about the origin, and the sums of the magnitudes of their terms.
struct Momentum {
    linear: Vec2,
    angular: f64,
    linear_size: f64,
    angular_size: f64,
}

impl Momentum {
    fn total(poses: &[Pose], velocities: &[Velocity]) -> Self {
        let moment = scene().gyration_radius_cm.powi(2);
        let mut total = Self {
            linear: Vec2::zeros(),
            angular: 0.0,
            linear_size: 0.0,
            angular_size: 0.0,
        };
        for (pose, velocity) in poses.iter().zip(velocities) {
            let (orbit, spin) = (
                cross(pose.position, velocity.linear),
                moment * velocity.angular,
            );
            total.linear += velocity.linear;
            total.angular += orbit + spin;
            total.linear_size += velocity.linear.norm();
            total.angular_size += pose.position.norm() * velocity.linear.norm() + spin.abs();
        }
        total
    }
}

/// The cells of one engine: drift over the flight, relative to the sum of all boats' momenta.
pub fn row(poses: &[Pose], velocities: &[Velocity]) -> Vec<String> {
    let start = start();
    let before = Momentum::total(&start.poses, &start.velocities);
    let after = Momentum::total(poses, velocities);
    vec![
        number((after.linear - before.linear).norm() / before.linear_size),
        number((after.angular - before.angular).abs() / before.angular_size),
    ]
}

/// Names of the columns.
pub const COLUMNS: [&str; 2] = ["momentum_drift", "angular_momentum_drift"];

/// Measures every configuration.
pub fn measure() -> Table {
    let all = Configuration::all();
    let rows = on_all_cores(&all, |configuration| {
        let mut engine = configuration.build(&scene(), 1, &start());
        engine.advance(configuration.steps(FLIGHT_S));
        row(&engine.poses(), &engine.velocities())
    });
    let mut table = table(&COLUMNS);
    for (configuration, row) in all.iter().zip(rows) {
        push_row(&mut table, &configuration.cells(), row);
    }
    table
}
