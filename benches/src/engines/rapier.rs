//! The scene in rapier: capsules of mass 1, walls as closed polylines, no friction, no restitution,
//! no sleeping. Compiled once for each precision.
#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "one precision needs the conversions of the other"
)]

use super::{Real, rapier};
use crate::engines::{Driver, Side, circle};
use crate::{Engine, Start};
use flockenv::FlockParameters;
use flockenv::geometry::{Hull, Pose, Vec2, Velocity};
use rapier::parry::mass_properties::MassProperties;
use rapier::prelude::*;
use std::time::{Duration, Instant};

/// Settings of rapier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Solver iterations; rapier's default is 4.
    pub iterations: usize,
    /// The length in cm that rapier's tolerances treat as a meter.
    pub length_unit_cm: f64,
    /// Whether the inner wall is rapier's own disc rather than chords.
    pub round_obstacle: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            iterations: 4,
            // Rapier's tolerances suit bodies of about a meter; a boat is 1.5 units long.
            length_unit_cm: 10.0,
            round_obstacle: false,
        }
    }
}

/// A scene in rapier.
pub struct Rapier {
    world: PhysicsWorld,
    boats: Vec<RigidBodyHandle>,
    outer_wall: Option<ColliderHandle>,
    driver: Driver,
    moment: f64,
    step_call: Duration,
}

impl Rapier {
    /// A scene at a start.
    pub fn new(parameters: &FlockParameters, seed: u64, start: &Start, settings: Settings) -> Self {
        let mut world = PhysicsWorld {
            gravity: Vector::new(0.0, 0.0),
            ..PhysicsWorld::default()
        };
        world.integration_parameters.dt = parameters.dt_s as Real;
        world.integration_parameters.num_solver_iterations = settings.iterations;
        world.integration_parameters.length_unit = settings.length_unit_cm as Real;
        let outer_wall = add_walls(&mut world, parameters, settings);
        let moment = parameters.gyration_radius_cm.powi(2);
        let hull = Hull::new(parameters);
        let states = start.poses.iter().zip(&start.velocities);
        let boats =
            states.map(|(pose, velocity)| add_boat(&mut world, hull, moment, pose, velocity));
        Self {
            boats: boats.collect(),
            world,
            outer_wall,
            driver: Driver::new(parameters, seed, start.time_s),
            moment,
            step_call: Duration::ZERO,
        }
    }

    fn apply_forces(&mut self) {
        self.driver.start_step();
        for (boat, &handle) in self.boats.iter().enumerate() {
            let body = &mut self.world.bodies[handle];
            let rotation = body.rotation();
            let axis = Vec2::new(f64::from(rotation.re), f64::from(rotation.im));
            let push = self.driver.push(boat, axis, &velocity_of(body));
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(vector(push.force), true);
            body.add_torque((self.moment * push.spin_up) as Real, true);
            body.apply_torque_impulse((self.moment * push.noise) as Real, true);
        }
    }
}

impl Engine for Rapier {
    fn advance(&mut self, steps: usize) {
        for _ in 0..steps {
            self.apply_forces();
            let start = Instant::now();
            self.world.step();
            self.step_call += start.elapsed();
        }
    }

    fn poses(&self) -> Vec<Pose> {
        let pose = |&handle: &RigidBodyHandle| {
            let body = &self.world.bodies[handle];
            let position = body.translation();
            let angle = f64::from(body.rotation().angle());
            Pose::new(f64::from(position.x), f64::from(position.y), angle)
        };
        self.boats.iter().map(pose).collect()
    }

    fn velocities(&self) -> Vec<Velocity> {
        self.boats
            .iter()
            .map(|&handle| velocity_of(&self.world.bodies[handle]))
            .collect()
    }

    fn wall_force(&self) -> f64 {
        let Some(wall) = self.outer_wall else {
            return 0.0;
        };
        let pairs = self.world.narrow_phase.contact_pairs_with(wall);
        let impulse: Real = pairs.map(ContactPair::total_impulse_magnitude).sum();
        f64::from(impulse / self.world.integration_parameters.dt)
    }

    fn step_call(&self) -> Option<Duration> {
        Some(self.step_call)
    }
}

fn vector(v: Vec2) -> Vector {
    Vector::new(v.x as Real, v.y as Real)
}

fn velocity_of(body: &RigidBody) -> Velocity {
    let linear = body.linvel();
    Velocity::new(
        f64::from(linear.x),
        f64::from(linear.y),
        f64::from(body.angvel()),
    )
}

/// Returns the outer wall.
fn add_walls(
    world: &mut PhysicsWorld,
    parameters: &FlockParameters,
    settings: Settings,
) -> Option<ColliderHandle> {
    let pool = parameters.pool;
    let smooth = |shape: ColliderBuilder| shape.friction(0.0).restitution(0.0);
    if pool.has_inner_wall() {
        let shape = if settings.round_obstacle {
            ColliderBuilder::ball(pool.inner_radius_cm as Real)
        } else {
            polygon(pool.inner_radius_cm, Side::Outside)
        };
        world.insert_collider(smooth(shape), None);
    }
    pool.has_outer_wall().then(|| {
        let shape = polygon(pool.outer_radius_cm, Side::Inside);
        world.insert_collider(smooth(shape), None)
    })
}

/// One-sided, which rapier advises for containers: boats then do not catch on the corners.
fn polygon(radius: f64, water: Side) -> ColliderBuilder {
    let corners = circle(radius, water);
    let count = corners.len() as u32;
    let corners = corners
        .iter()
        .map(|&[x, y]| Vector::new(x as Real, y as Real));
    let sides = (0..count).map(|k| [k, (k + 1) % count]);
    ColliderBuilder::oriented_polyline(corners.collect(), Some(sides.collect()))
}

fn add_boat(
    world: &mut PhysicsWorld,
    hull: Hull,
    moment: f64,
    pose: &Pose,
    velocity: &Velocity,
) -> RigidBodyHandle {
    let mass = MassProperties::new(Vector::new(0.0, 0.0), 1.0, moment as Real);
    let body = RigidBodyBuilder::dynamic()
        .translation(vector(pose.position))
        .rotation(pose.heading as Real)
        .linvel(vector(velocity.linear))
        .angvel(velocity.angular as Real)
        .additional_mass_properties(mass)
        .can_sleep(false);
    let shape = ColliderBuilder::capsule_x(hull.half_length as Real, hull.radius as Real)
        .density(0.0)
        .friction(0.0)
        .restitution(0.0);
    world.insert(body, shape).0
}
