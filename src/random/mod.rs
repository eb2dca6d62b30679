//! Randomness: named, seeded streams, and the Brownian paths of the noise.

mod brownian;
mod normal;
mod streams;

pub use brownian::BrownianPaths;
pub(crate) use streams::{Stream, StreamRng};
