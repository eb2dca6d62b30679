//! How a time step is taken.

mod leapfrog;
mod moreau;
mod paper;

pub use leapfrog::leapfrog;
pub use moreau::moreau;
pub use paper::paper;
