//! Motion of a flock from one substep to the next.
//!
//! `Integrator` holds the state. A substep draws noise, works out what drives the boats, moves their
//! velocities without contacts, solves the contacts and moves the poses; the scheme decides where in the
//! substep each of these happens.

mod checkpoint;
mod contacts;
mod dispatch;
mod forcing;
mod leapfrog;
mod moreau;
mod noise;
mod paper;
mod phase_schedule;
mod state;
mod substep;

pub(crate) use checkpoint::Checkpoint;
pub use phase_schedule::{Phase, PhaseMoment, PhaseSchedule, sampled_analysis_window};
pub(crate) use state::Integrator;
pub use substep::Steering;
pub(crate) use substep::Substep;
