//! Motion of a boat without contacts, eqs (8) and (9).
//!
//! Eq. (9) is grouped as −c1·α̇³ + (c2·s − c3·α̇)(u·ẋ) + c4·η. With the printed grouping a rudder could
//! never start a turn. That contradicts the paper's own description: a stopped boat does not steer, a
//! moving one prefers a nonzero turning rate.

use crate::geometry::{Vec2, Velocity};
use crate::parameters::FlockParameters;

/// Drives of a boat during a substep.
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

/// Velocity without contacts, and the inverse effective inertia by which contacts change it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeVelocity {
    /// The velocity that the boat would have without contacts.
    pub velocity: Velocity,
    /// One over the effective weight of the angular velocity, not yet divided by ρ².
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

    /// Angular acceleration, eq. (9) without noise. `along` is the boat's speed along its heading relative to the water.
    #[inline]
    pub fn angular_acceleration(&self, angular: f64, along: f64, rudder: f64) -> f64 {
        -self.c1 * angular * angular * angular + (self.c2 * rudder - self.c3 * angular) * along
    }

    /// Rate in 1/s at which a small change of the angular velocity decays, from eq. (9) linearized; 0 if the change grows.
    pub(crate) fn turn_damping(&self, angular: f64, along: f64) -> f64 {
        (3.0 * self.c1 * angular * angular + self.c3 * along).max(0.0)
    }

    /// The fraction of a spin that remains after damping at `rate` for `dt`; 0 if damping would reverse the spin. A
    /// reversed spin would be reversed again in the next step, and could grow without bound.
    #[inline]
    fn remaining_fraction(rate: f64, dt: f64) -> f64 {
        (1.0 - rate * dt).max(0.0)
    }

    /// The velocity after an explicit Euler step of `dt`. Drag and damping alone may stop a motion, but never
    /// reverse it.
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
        let rate = self.c1 * spin * spin + self.c3 * along;
        let driven =
            spin * Self::remaining_fraction(rate, dt) + self.c2 * drive.rudder * along * dt;
        let relaxed_fraction = (self.c0 * dt).min(1.0);
        let preferred = axis * drive.preferred_speed + drive.water;
        Velocity {
            linear: velocity.linear + (preferred - velocity.linear) * relaxed_fraction,
            angular: self.limited(driven, spin, along, drive.rudder) + drive.noise,
        }
    }

    /// One over the effective linear weight, 1 + dt/2·c0.
    #[inline]
    pub fn linear_mobility(&self, dt: f64) -> f64 {
        1.0 / (1.0 + 0.5 * dt * self.c0)
    }

    /// Change of the velocity over `dt` without contacts, with drag centered in the substep. The fraction by which the
    /// velocity approaches its preferred value is at most 1: otherwise drag could reverse a boat.
    #[inline]
    pub(crate) fn centered_change(
        &self,
        velocity: Vec2,
        axis: Vec2,
        drive: &Drive,
        dt: f64,
    ) -> Vec2 {
        let relaxed_fraction = (self.c0 * dt * self.linear_mobility(dt)).min(1.0);
        (axis * drive.preferred_speed + drive.water - velocity) * relaxed_fraction
    }

    /// Limits the spin of a backing boat after a step from `spin` to `driven`. Eq. (9) never drives a spin past its
    /// equilibrium, so a step that overshoots is limited to a bound of the equilibria.
    #[inline]
    fn limited(&self, driven: f64, spin: f64, along: f64, rudder: f64) -> f64 {
        let overshoots =
            || (driven - spin) * self.angular_acceleration(driven, along, rudder) < 0.0;
        if along < 0.0 && overshoots() {
            return self.within_equilibria(driven, spin, along, rudder);
        }
        driven
    }

    /// Limits the magnitude of a spin to the boat's present one, or to an upper bound of the equilibria of eq. (9),
    /// whichever is larger. Equilibria are the roots w of c1·w³ = (c2·s − c3·w)·u·ẋ with c1 > 0.
    #[cold]
    fn within_equilibria(&self, driven: f64, spin: f64, along: f64, rudder: f64) -> f64 {
        let push = along.abs() / self.c1;
        let fastest = (self.c3 * push).sqrt() + libm::cbrt(self.c2 * rudder.abs() * push);
        let most = spin.abs().max(fastest);
        driven.clamp(-most, most)
    }

    /// The velocity after `dt`, to second order: drag, heading drive and angular damping are centered in the substep
    /// (Crank–Nicolson, linearized once for the angular velocity). `contact_change` is the change of velocity that
    /// persistent contacts are expected to make in the substep. It keeps the heading drive u·ẋ centered while a boat
    /// presses against something.
    ///
    /// The slope of eq. (9), 3·c1·α̇² + c3·u·ẋ, is negative for a backing boat that does not turn yet: the
    /// weight 1 + dt/2·slope is replaced there by 1/(1 − dt/2·slope), equal to second order and positive
    /// at any dt. Damping may stop a spin, but never reverses it.
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
        let mid_velocity = velocity.linear + (change + contact_change) * 0.5;
        let along = axis.dot(&(mid_velocity - drive.water));

        let spin = velocity.angular;
        let half_slope = 0.5 * dt * (3.0 * self.c1 * spin * spin + self.c3 * along);
        let angular_mobility = if half_slope >= 0.0 {
            1.0 / (1.0 + half_slope)
        } else {
            1.0 - half_slope
        };
        let damping = self.c1 * spin * spin + self.c3 * along;
        let turn = self.c2 * drive.rudder * along * dt;
        let driven = spin * Self::remaining_fraction(damping, dt * angular_mobility)
            + turn * angular_mobility;
        let limited = self.limited(driven, spin, along, drive.rudder);
        FreeVelocity {
            velocity: Velocity {
                linear: velocity.linear + change,
                angular: limited + drive.noise * angular_mobility,
            },
            angular_mobility,
        }
    }
}
