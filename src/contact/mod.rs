//! Frictionless, perfectly inelastic contacts, and the impulses that hold them.
//!
//! Post-contact motion minimizes Σ|Δv|² + ρ²ΣΔω² (eqs A.1 and A.2) over the velocities for which no
//! linearized gap closes beyond zero in the substep.

#[allow(
    clippy::module_inception,
    reason = "the file is named after the noun it owns"
)]
mod contact;
mod depenetration;
mod detection;
mod island;
mod known_gaps;
mod near_obstacles;
mod passivity;
mod predicted_poses;
mod problem;
mod resolver;
mod skipped_contacts;
pub mod solver;
mod statistics;
mod touches;
mod velocity_bias;
mod warm_start;

pub use contact::{Contact, Partner};
pub use depenetration::KeepGoing;
pub(crate) use depenetration::push_apart;
pub use detection::ContactDetector;
pub use island::Islands;
pub(crate) use island::{join, root};
pub use problem::{ContactProblem, InverseInertia};
pub(crate) use resolver::{ContactResolver, Divisibility, Motion, NotTaken};
pub use statistics::Statistics;
pub(crate) use warm_start::CachedImpulse;
