//! Flocks of radio-controlled boats in an annular pool, aligning through frictionless, perfectly
//! inelastic collisions alone, with a few steerable leaders among them (Tarcai et al. 2011).
//!
//! # Flow
//! parameters → [`Flock`] → order parameters and observations → (Python) environment → policy.
//!
//! # Units
//! | quantity | unit |
//! |---|---|
//! | length | cm |
//! | time | s (kept as integer ticks of 1 ns) |
//! | angle | rad, headings counter-clockwise from x |
//! | mass | 1 a boat, so impulses are cm/s and forces cm/s² |
//! | c1, c2, c3 | s, 1/(cm·s), 1/cm |
//!
//! # Words
//! boat, leader, normal boat, flock, pool, pose, heading, hull (capsule), gap (signed, negative =
//! overlap), contact, island (boats joined by contacts), impulse, scheme (how a time step is taken),
//! solver (how the contact problem is solved), phase, LAP frame, order parameter, rudder command,
//! control step (policy) and substep (physics), flock batch.

pub mod animation;
pub mod arrangement;
pub mod boat;
pub mod collective_state;
pub mod contact;
pub mod dynamics;
pub mod environment;
pub mod error;
pub mod flock;
pub mod flock_batch;
pub mod frame_image;
pub mod geometry;
pub mod lap_frame;
mod names;
pub mod observation;
pub mod observed_law;
pub mod order_parameters;
mod parallel;
pub mod parameters;
pub mod phase_schedule;
pub mod placement;
pub mod pool;
pub mod preset;
pub mod random_streams;
pub mod recording;
pub mod scheme;
mod sealed_bytes;
pub mod snapshot;
pub mod statistics;

#[cfg(feature = "python")]
mod python;

pub use error::{FlockError, Result};
pub use flock::Flock;
pub use flock_batch::FlockBatch;
pub use frame_image::FrameRenderer;
pub use order_parameters::OrderParameters;
pub use parameters::FlockParameters;
