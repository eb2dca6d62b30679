//! Frictionless, perfectly inelastic contacts: which there are, and the impulses that hold them.
//!
//! Post-contact motion minimises Σ|Δv|² + ρ²ΣΔω² (eqs A.1 and A.2) over the velocities for which no
//! linearised gap closes beyond zero in the substep.

#[allow(
    clippy::module_inception,
    reason = "the file is named after the noun it owns"
)]
mod contact;
mod detection;
mod island;
mod loads;
mod pace;
mod passivity;
mod problem;
mod recovery;
mod resolver;
pub mod solver;

pub use contact::{Contact, ContactKey, Partner};
pub use detection::ContactDetector;
pub use island::Islands;
pub use loads::Load;
pub use problem::{ContactProblem, InverseInertia};
pub use recovery::push_apart;
pub use resolver::ContactResolver;
