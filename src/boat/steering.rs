//! The paper's fixed steering law, eq. (10).

use crate::geometry::{Vec2, wrap_angle};
use std::f64::consts::{FRAC_PI_2, PI};

use crate::parameters::Target;

/// Rudder command of eq. (10): s = clamp(6·(β − α)/π, −1, 1), with β − α wrapped into (−π, π];
/// proportional up to 30° of misalignment, constant beyond.
pub fn steering_law(misalignment: f64) -> f64 {
    (6.0 * wrap_angle(misalignment) / PI).clamp(-1.0, 1.0)
}

/// β − α of a boat: how far counter-clockwise it has to turn to head along the target's tangent at
/// its own polar angle θ. Clockwise motion heads along θ − π/2.
pub fn misalignment(position: Vec2, heading: f64, target: Target) -> f64 {
    let polar_angle = position.y.atan2(position.x);
    wrap_angle(polar_angle - target.sign() * FRAC_PI_2 - heading)
}
