//! What every engine has in common.

use flockenv::contact::Statistics;
use flockenv::geometry::{Pose, Velocity};
use std::time::Duration;

/// A scene in motion.
pub trait Engine {
    /// Takes so many steps: noise, forces of eqs (8) and (9), contacts, motion.
    fn advance(&mut self, steps: usize);
    /// Poses of all boats.
    fn poses(&self) -> Vec<Pose>;
    /// Velocities of all boats.
    fn velocities(&self) -> Vec<Velocity>;
    /// What the outer wall carried in the last step, in cm/s².
    fn wall_force(&self) -> f64;
    /// Time spent so far in the engine's own step call, where noise and forces are applied outside it.
    fn step_call(&self) -> Option<Duration> {
        None
    }
    /// Whether the motion left the range of sensible numbers; nothing moves any more then.
    fn is_lost(&self) -> bool {
        false
    }
    /// What flockenv did so far.
    fn statistics(&self) -> Option<Statistics> {
        None
    }
}
