//! The interface of all engines.

use flockenv::contact::Statistics;
use flockenv::geometry::{Pose, Velocity};
use std::time::Duration;

/// A scene in motion.
pub trait Engine {
    /// Takes a number of steps: noise, forces of eqs (8) and (9), contacts, motion.
    fn advance(&mut self, steps: usize);
    /// Poses of all boats.
    fn poses(&self) -> Vec<Pose>;
    /// Velocities of all boats.
    fn velocities(&self) -> Vec<Velocity>;
    /// Force on the outer wall in the last step, in cm/s².
    fn wall_force(&self) -> f64;
    /// Time spent so far in the engine's own step call; `None` if noise and forces are part of it.
    fn step_call(&self) -> Option<Duration> {
        None
    }
    /// Whether the engine failed; it does not move any more then.
    fn is_lost(&self) -> bool {
        false
    }
    /// Statistics of flockenv so far; `None` for other engines.
    fn statistics(&self) -> Option<Statistics> {
        None
    }
}
