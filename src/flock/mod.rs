//! A flock that is placed, advanced, recorded, stored and restored.

mod change;
mod contact_force;
#[allow(
    clippy::module_inception,
    reason = "the file is named after the noun it owns"
)]
mod flock;
mod placement;
mod recorder;
mod snapshot;
mod state;
mod step;

pub use change::Change;
pub use contact_force::ContactForce;
pub use flock::Flock;
pub(crate) use flock::LATEST;
pub use recorder::{ContactSamples, Pause, Real, Recorder, Recording, Sampling};
pub use state::State;
