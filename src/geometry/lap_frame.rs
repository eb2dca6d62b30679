//! The local-angle polar (LAP) frame of Section 2.3: outward radial and tangential axes at each
//! boat's own polar angle θ. Orientations and tangential velocities count clockwise as positive, the
//! camera's y-down convention, so that φ = 0 points at the outer wall and +π/2 is clockwise motion.

use super::{Pose, Vec2, turned_left, wrap_angle};

/// The axes at one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LapFrame {
    /// Unit vector away from the pool's center.
    pub outward: Vec2,
    /// Unit vector along clockwise motion.
    pub clockwise: Vec2,
}

impl LapFrame {
    /// The axes at a position; at the very center, those of θ = 0.
    pub fn at(position: Vec2) -> Self {
        let outward = position
            .try_normalize(0.0)
            .unwrap_or_else(|| Vec2::new(1.0, 0.0));
        Self {
            outward,
            clockwise: -turned_left(outward),
        }
    }

    /// LAP components (outward, clockwise) of a world vector.
    pub fn components(&self, world: Vec2) -> Vec2 {
        Vec2::new(world.dot(&self.outward), world.dot(&self.clockwise))
    }
}

/// LAP orientation φ = wrap(θ − α) in (−π, π] (figure 3).
pub fn orientation(pose: &Pose) -> f64 {
    wrap_angle(libm::atan2(pose.position.y, pose.position.x) - pose.heading)
}
