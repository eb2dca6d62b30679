//! The scene in Box2D: capsules of mass 1, walls as chains, no friction, no restitution, no sleeping.
//! Single precision, vector instructions as Box2D chooses them.
#![allow(unsafe_code, reason = "Box2D is a C library")]

use crate::engines::{Driver, Side, circle};
use crate::{Engine, Start};
use boxdd_sys::ffi::*;
use flockenv::FlockParameters;
use flockenv::geometry::{Hull, Pose, Vec2, Velocity};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The length in cm that Box2D's tolerances treat as a meter, as for rapier; it holds for the whole process.
const LENGTH_UNIT_CM: f32 = 10.0;
/// Largest number of contacts of one boat that are read.
const MOST_CONTACTS: usize = 64;

/// Box2D keeps its worlds in one list, without a lock of its own.
static LIST_OF_WORLDS: Mutex<()> = Mutex::new(());

/// A scene in Box2D.
pub struct Box2d {
    world: b2WorldId,
    boats: Vec<b2BodyId>,
    outer_wall: Option<b2BodyId>,
    driver: Driver,
    dt: f32,
    substeps: i32,
    moment: f64,
    step_call: Duration,
}

impl Box2d {
    /// A scene at a start. Box2D's documentation advises 4 substeps. With more than one worker, Box2D starts its own threads.
    pub fn new(
        parameters: &FlockParameters,
        seed: u64,
        start: &Start,
        substeps: i32,
        workers: i32,
    ) -> Self {
        let world = create_world(workers);
        let pool = parameters.pool;
        if pool.has_inner_wall() {
            add_wall(world, pool.inner_radius_cm, Side::Outside);
        }
        let outer_wall = pool
            .has_outer_wall()
            .then(|| add_wall(world, pool.outer_radius_cm, Side::Inside));
        let moment = parameters.gyration_radius_cm.powi(2);
        let hull = Hull::new(parameters);
        let states = start.poses.iter().zip(&start.velocities);
        Self {
            world,
            boats: states
                .map(|(pose, velocity)| add_boat(world, hull, moment, pose, velocity))
                .collect(),
            outer_wall,
            driver: Driver::new(parameters, seed, start.time_s),
            dt: parameters.dt_s as f32,
            substeps,
            moment,
            step_call: Duration::ZERO,
        }
    }

    fn apply_forces(&mut self) {
        self.driver.start_step();
        for (boat, &id) in self.boats.iter().enumerate() {
            // SAFETY: the bodies live as long as the world, which lives as long as self.
            let rotation = unsafe { b2Body_GetRotation(id) };
            let axis = Vec2::new(f64::from(rotation.c), f64::from(rotation.s));
            let push = self.driver.push(boat, axis, &velocity_of(id));
            // SAFETY: as above.
            unsafe {
                b2Body_ApplyForceToCenter(id, vector(push.force), true);
                b2Body_ApplyTorque(id, (self.moment * push.spin_up) as f32, true);
                b2Body_ApplyAngularImpulse(id, (self.moment * push.noise) as f32, true);
            }
        }
    }
}

impl Engine for Box2d {
    fn advance(&mut self, steps: usize) {
        for _ in 0..steps {
            self.apply_forces();
            let start = Instant::now();
            // SAFETY: the world lives as long as self.
            unsafe { b2World_Step(self.world, self.dt, self.substeps) };
            self.step_call += start.elapsed();
        }
    }

    fn poses(&self) -> Vec<Pose> {
        let pose = |&id: &b2BodyId| {
            // SAFETY: the bodies live as long as self.
            let b2Transform { p, q } = unsafe { b2Body_GetTransform(id) };
            Pose::new(
                f64::from(p.x),
                f64::from(p.y),
                f64::from(q.s).atan2(f64::from(q.c)),
            )
        };
        self.boats.iter().map(pose).collect()
    }

    fn velocities(&self) -> Vec<Velocity> {
        self.boats.iter().map(|&id| velocity_of(id)).collect()
    }

    fn wall_force(&self) -> f64 {
        let Some(wall) = self.outer_wall else {
            return 0.0;
        };
        let impulse: f32 = self
            .boats
            .iter()
            .map(|&boat| impulse_between(boat, wall))
            .sum();
        f64::from(impulse / self.dt)
    }

    fn step_call(&self) -> Option<Duration> {
        Some(self.step_call)
    }
}

impl Drop for Box2d {
    fn drop(&mut self) {
        let _held = LIST_OF_WORLDS.lock();
        // SAFETY: nothing uses the world after self.
        unsafe { b2DestroyWorld(self.world) };
    }
}

fn create_world(workers: i32) -> b2WorldId {
    let _held = LIST_OF_WORLDS.lock();
    // SAFETY: the world is made from Box2D's own defaults and used by this thread alone.
    unsafe {
        b2SetLengthUnitsPerMeter(LENGTH_UNIT_CM);
        let mut definition = b2DefaultWorldDef();
        definition.gravity = b2Vec2 { x: 0.0, y: 0.0 };
        definition.enableSleep = false;
        definition.workerCount = workers;
        b2CreateWorld(&raw const definition)
    }
}

fn vector(v: Vec2) -> b2Vec2 {
    b2Vec2 {
        x: v.x as f32,
        y: v.y as f32,
    }
}

fn velocity_of(id: b2BodyId) -> Velocity {
    // SAFETY: callers hold the world that the body is in.
    let (linear, angular) =
        unsafe { (b2Body_GetLinearVelocity(id), b2Body_GetAngularVelocity(id)) };
    Velocity::new(f64::from(linear.x), f64::from(linear.y), f64::from(angular))
}

/// Impulse between a boat and the wall in the last step, summed over substeps.
fn impulse_between(boat: b2BodyId, wall: b2BodyId) -> f32 {
    let mut contacts = Vec::with_capacity(MOST_CONTACTS);
    // SAFETY: Box2D writes at most the capacity and returns how many it wrote.
    unsafe {
        let count = b2Body_GetContactData(boat, contacts.as_mut_ptr(), MOST_CONTACTS as i32);
        contacts.set_len(count as usize);
    }
    let is_wall = |shape: b2ShapeId| {
        // SAFETY: the shape was just handed out.
        let body = unsafe { b2Shape_GetBody(shape) };
        body.index1 == wall.index1
    };
    let touching = contacts
        .iter()
        .filter(|c: &&b2ContactData| is_wall(c.shapeIdA) || is_wall(c.shapeIdB));
    touching
        .flat_map(|c| &c.manifold.points[..c.manifold.pointCount as usize])
        .map(|point| point.totalNormalImpulse)
        .sum()
}

fn smooth() -> b2ShapeDef {
    // SAFETY: plain data.
    let mut definition = unsafe { b2DefaultShapeDef() };
    definition.material.friction = 0.0;
    definition.material.restitution = 0.0;
    definition.density = 0.0;
    definition
}

/// Adds a closed one-sided chain, on whose corners boats do not catch.
fn add_wall(world: b2WorldId, radius: f64, water: Side) -> b2BodyId {
    let corners = circle(radius, water)
        .into_iter()
        .map(|[x, y]| vector(Vec2::new(x, y)));
    let corners: Vec<b2Vec2> = corners.collect();
    let material = smooth().material;
    // SAFETY: definitions are Box2D's own, and what they point to is copied by it.
    unsafe {
        let definition = b2DefaultBodyDef();
        let wall = b2CreateBody(world, &raw const definition);
        let mut chain = b2DefaultChainDef();
        chain.points = corners.as_ptr();
        chain.count = corners.len() as i32;
        chain.materials = &raw const material;
        chain.materialCount = 1;
        chain.isLoop = true;
        b2CreateChain(wall, &raw const chain);
        wall
    }
}

fn add_boat(
    world: b2WorldId,
    hull: Hull,
    moment: f64,
    pose: &Pose,
    velocity: &Velocity,
) -> b2BodyId {
    let h = hull.half_length as f32;
    let capsule = b2Capsule {
        center1: b2Vec2 { x: -h, y: 0.0 },
        center2: b2Vec2 { x: h, y: 0.0 },
        radius: hull.radius as f32,
    };
    let mass = b2MassData {
        mass: 1.0,
        center: b2Vec2 { x: 0.0, y: 0.0 },
        rotationalInertia: moment as f32,
    };
    let (sin, cos) = pose.heading.sin_cos();
    let shape = smooth();
    // SAFETY: definitions are Box2D's own, and copied by it.
    unsafe {
        let mut definition = b2DefaultBodyDef();
        definition.type_ = b2BodyType_b2_dynamicBody;
        definition.position = vector(pose.position);
        definition.rotation = b2Rot {
            c: cos as f32,
            s: sin as f32,
        };
        definition.linearVelocity = vector(velocity.linear);
        definition.angularVelocity = velocity.angular as f32;
        definition.enableSleep = false;
        let boat = b2CreateBody(world, &raw const definition);
        b2CreateCapsuleShape(boat, &raw const shape, &raw const capsule);
        b2Body_SetMassData(boat, mass);
        boat
    }
}
