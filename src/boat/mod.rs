//! One boat: its state, its free motion (eqs 8 and 9) and a leader's steering (eq. 10).

mod free_motion;
mod state;
mod steering;

pub use free_motion::{Drive, FreeMotion};
pub use state::{Pose, Velocity};
pub use steering::{misalignment, steering_law};
