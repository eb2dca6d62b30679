//! Eqs (8) and (9) as forces, for engines that only take forces.

use flockenv::FlockParameters;
use flockenv::boat::{Drive, FreeMotion};
use flockenv::clock::{Ticks, ticks};
use flockenv::geometry::{Vec2, Velocity};
use flockenv::integrator::{Phase, PhaseSchedule};
use flockenv::random::BrownianPaths;

/// The forces on one boat in one step.
#[derive(Debug, Clone, Copy)]
pub struct Push {
    /// Force in cm/s² (mass 1).
    pub force: Vec2,
    /// Angular acceleration in rad/s².
    pub spin_up: f64,
    /// Change of the angular velocity by noise in rad/s.
    pub noise: f64,
}

/// Clock, phases and noise of a scene without leaders and optional effects.
#[derive(Debug, Clone)]
pub struct Driver {
    parameters: FlockParameters,
    schedule: PhaseSchedule,
    motion: FreeMotion,
    noise: Option<BrownianPaths>,
    noise_increments: Vec<f64>,
    preferred_speed: f64,
    time: Ticks,
    dt: Ticks,
}

impl Driver {
    /// Noise increments are those of flockenv's `moreau` scheme with this seed.
    pub fn new(parameters: &FlockParameters, seed: u64, time_s: f64) -> Self {
        let (n, dt) = (parameters.n_boats, ticks(parameters.dt_s));
        Self {
            schedule: PhaseSchedule::new(parameters),
            motion: FreeMotion::new(parameters),
            noise: (parameters.c4 > 0.0).then(|| BrownianPaths::new(seed, n, 2 * dt, 0)),
            noise_increments: vec![0.0; n],
            preferred_speed: 0.0,
            time: ticks(time_s),
            dt,
            parameters: parameters.clone(),
        }
    }

    /// Draws the noise of the step that starts now, and moves the clock to its end.
    pub fn start_step(&mut self) {
        let end = self.time + self.dt;
        if let Some(noise) = &mut self.noise {
            noise.increments(2 * self.time, 2 * end, &mut self.noise_increments);
        }
        self.preferred_speed = match self.schedule.at(self.time).phase {
            Phase::Forward => self.parameters.speed_cm_s,
            Phase::Backward => -self.parameters.reverse_speed_cm_s,
            Phase::DriftAfterForward | Phase::DriftAfterBackward => 0.0,
        };
        self.time = end;
    }

    /// The forces on a boat in this step.
    pub fn push(&self, boat: usize, axis: Vec2, velocity: &Velocity) -> Push {
        let drive = Drive {
            preferred_speed: self.preferred_speed,
            rudder: 0.0,
            water: Vec2::zeros(),
            noise: 0.0,
        };
        let along = axis.dot(&velocity.linear);
        Push {
            force: self
                .motion
                .linear_acceleration(velocity.linear, axis, &drive),
            spin_up: self
                .motion
                .angular_acceleration(velocity.angular, along, 0.0),
            noise: self.parameters.c4 * self.noise_increments[boat],
        }
    }
}
