//! Eqs (8) and (9): what a boat does when nothing touches it.
//!
//! Eq. (9) is grouped as −c1·α̇³ + (c2·s − c3·α̇)(u·ẋ) + c4·η. The printed grouping contradicts the
//! paper's own description (a stopped boat does not steer, a moving one prefers a nonzero turning
//! rate) and steers neither way.

use crate::geometry::{Vec2, Velocity};
use crate::parameters::FlockParameters;

/// What acts on a boat during a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Preferred speed v0 along the heading in cm/s, negative backwards.
    pub preferred_speed: f64,
    /// Rudder s in [−1, 1], positive turns counter-clockwise when moving forward.
    pub rudder: f64,
    /// Velocity of the water in cm/s.
    pub water: Vec2,
    /// Change of the angular velocity by noise in rad/s, over the whole substep.
    pub noise: f64,
}

/// A free velocity and how readily contacts change it within the substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeVelocity {
    /// The velocity that the boat would have without contacts.
    pub velocity: Velocity,
    /// One over the effective weight of the angular velocity, to be divided by ρ².
    pub angular_mobility: f64,
}

/// The constants of eqs (8) and (9).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeMotion {
    c0: f64,
    c1: f64,
    c2: f64,
    c3: f64,
}

impl FreeMotion {
    /// The constants of checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        let &FlockParameters { c0, c1, c2, c3, .. } = parameters;
        Self { c0, c1, c2, c3 }
    }

    /// Linear acceleration, eq. (8), with drag relative to the water.
    #[inline]
    pub fn linear_acceleration(&self, velocity: Vec2, axis: Vec2, drive: &Drive) -> Vec2 {
        (axis * drive.preferred_speed - (velocity - drive.water)) * self.c0
    }

    /// Angular acceleration, eq. (9) without noise, at a speed through the water along the heading.
    #[inline]
    pub fn angular_acceleration(&self, angular: f64, along: f64, rudder: f64) -> f64 {
        -self.c1 * angular * angular * angular + (self.c2 * rudder - self.c3 * angular) * along
    }

    /// How fast a small change of the angular velocity decays, in 1/s: the linearization of eq. (9), and 0 where it
    /// would grow.
    pub(crate) fn turn_damping(&self, angular: f64, along: f64) -> f64 {
        (3.0 * self.c1 * angular * angular + self.c3 * along).max(0.0)
    }

    /// Explicit Euler over `dt`: accelerations at the given velocity.
    ///
    /// A spin that a collision left so fast that −c1·α̇³ would turn it round within one step
    /// (c1·α̇²·dt > 1) is stopped instead: beyond 2, explicit steps would grow without end.
    #[inline]
    pub(crate) fn explicit(
        &self,
        velocity: &Velocity,
        axis: Vec2,
        drive: &Drive,
        dt: f64,
    ) -> Velocity {
        let along = axis.dot(&(velocity.linear - drive.water));
        let spin = velocity.angular;
        let excess = (self.c1 * spin * spin * dt - 1.0).max(0.0);
        Velocity {
            linear: velocity.linear + self.linear_acceleration(velocity.linear, axis, drive) * dt,
            angular: spin
                + self.angular_acceleration(spin, along, drive.rudder) * dt
                + excess * spin
                + drive.noise,
        }
    }

    /// One over the effective linear weight, 1 + dt/2·c0.
    #[inline]
    pub fn linear_mobility(&self, dt: f64) -> f64 {
        1.0 / (1.0 + 0.5 * dt * self.c0)
    }

    /// Change of the velocity over `dt` without contacts, with drag centered in the substep.
    #[inline]
    pub(crate) fn centered_change(
        &self,
        velocity: Vec2,
        axis: Vec2,
        drive: &Drive,
        dt: f64,
    ) -> Vec2 {
        self.linear_acceleration(velocity, axis, drive) * (dt * self.linear_mobility(dt))
    }

    /// The spin that a boat would be driven to, held to its own or to a bound of those at which eq. (9) comes to rest: the
    /// roots of c1·w³ = (c2·s − c3·w)·u·ẋ with c1 > 0.
    #[cold]
    fn held_back(&self, driven: f64, spin: f64, along: f64, rudder: f64) -> f64 {
        let push = along.abs() / self.c1;
        let fastest = (self.c3 * push).sqrt() + libm::cbrt(self.c2 * rudder.abs() * push);
        let most = spin.abs().max(fastest);
        driven.clamp(-most, most)
    }

    /// Second order over `dt` with drag, heading drive and angular damping centered in the substep:
    /// Crank–Nicolson, linearized once for the angular velocity. `contact_change` is the change of
    /// velocity that persistent contacts are expected to make in the substep, so that the heading's
    /// drive u·ẋ is centered too while a boat leans on something.
    ///
    /// The angular rate 3·c1·α̇² + c3·u·ẋ is negative for a backing boat that does not turn yet: the
    /// weight 1 + dt/2·rate is replaced there by 1/(1 − dt/2·rate), equal to second order and positive
    /// at any dt. Eq. (9) drives no backing boat past the spin at which it comes to rest; where a step of
    /// this order would (at 0.1 s and more), it ends there.
    #[inline]
    pub fn centered(
        &self,
        velocity: &Velocity,
        axis: Vec2,
        drive: &Drive,
        contact_change: Vec2,
        dt: f64,
    ) -> FreeVelocity {
        let change = self.centered_change(velocity.linear, axis, drive, dt);
        let middle = velocity.linear + (change + contact_change) * 0.5;
        let along = axis.dot(&(middle - drive.water));

        let spin = velocity.angular;
        let half_rate = 0.5 * dt * (3.0 * self.c1 * spin * spin + self.c3 * along);
        let angular_mobility = if half_rate >= 0.0 {
            1.0 / (1.0 + half_rate)
        } else {
            1.0 - half_rate
        };
        let mut torque = self.angular_acceleration(spin, along, drive.rudder) * dt;
        let driven = spin + torque * angular_mobility;
        if along < 0.0 && torque * self.angular_acceleration(driven, along, drive.rudder) < 0.0 {
            torque = (self.held_back(driven, spin, along, drive.rudder) - spin) / angular_mobility;
        }
        torque += drive.noise;
        FreeVelocity {
            velocity: Velocity {
                linear: velocity.linear + change,
                angular: spin + torque * angular_mobility,
            },
            angular_mobility,
        }
    }
}
