//! One boat: its free motion (eqs 8 and 9) and a leader's steering (eq. 10).

mod free_motion;
mod steering;

pub use free_motion::{Drive, FreeMotion, FreeVelocity};
pub use steering::{Course, DampedLaw, misalignment, steering_law};
