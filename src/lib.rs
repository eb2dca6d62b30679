//! Flocks of radio-controlled boats in an annular pool, aligning through frictionless, perfectly
//! inelastic collisions alone, with a few steerable leaders among them (Tarcai et al. 2011).
//!
//! # Example
//! Three of 27 boats steer by the paper's law for ten seconds:
//!
//! ```
//! use flockenv::flock::Flock;
//! use flockenv::parameters::{FlockParameters, Preset};
//!
//! let parameters = FlockParameters {
//!     n_boats: 27,
//!     n_leaders: 3,
//!     ..FlockParameters::preset(Preset::Simulation)
//! };
//! let mut flock = Flock::new(parameters, 7)?;
//! flock.advance(10.0, None)?;
//! let order = flock.order_parameters(Flock::WITHOUT_LEADERS)?;
//! println!("{} s: polarization {:.2}", flock.time_s(), order.psi_o);
//! # assert!((0.0..=1.0).contains(&order.psi_o));
//! # Ok::<(), flockenv::FlockError>(())
//! ```
//!
//! The folder `examples` shows self-propelled rods in a dish, a custom steering law, and a batch of environments.
//!
//! # Flow
//! [`parameters`] → [`geometry`] → [`boat`] → [`contact`] → [`integrator`] → [`flock`] → [`environment`] →
//! policy (Python). Measurements are in [`analysis`], pictures in `draw`.
//!
//! # Features
//! - `draw`: pictures of flocks
//! - `clarabel`: a third contact solver, to check the others against
//! - `python`: the Python bindings; turns on both other features
//!
//! # Units
//! | quantity | unit |
//! |---|---|
//! | length | cm |
//! | time | s (kept as integer ticks of 1 ns) |
//! | angle | rad, headings counter-clockwise from x |
//! | mass | 1 per boat, so impulses are cm/s and forces cm/s² |
//! | c1, c2, c3 | s, 1/(cm·s), 1/cm |
//!
//! # Words
//! boat, leader, normal boat, flock, pool, pose, heading, hull (capsule), gap (signed, negative =
//! overlap), contact, island (boats joined by contacts), impulse, scheme (how a time step is taken),
//! solver (how the contact problem is solved), phase, LAP frame, order parameter, rudder command,
//! control step (policy) and substep (physics).

#![warn(unreachable_pub)]

pub mod analysis;
pub mod boat;
mod by_name;
pub mod clock;
pub mod contact;
pub mod draw;
pub mod environment;
pub mod error;
pub mod flock;
pub mod geometry;
pub mod integrator;
mod parallel;
pub mod parameters;
pub mod policies;
pub mod random;
mod sealed_bytes;
pub mod training;

#[cfg(feature = "python")]
mod python;

pub use analysis::OrderParameters;
#[cfg(feature = "draw")]
pub use draw::FrameRenderer;
pub use error::{FlockError, Result};
pub use flock::Flock;
pub use parameters::FlockParameters;
