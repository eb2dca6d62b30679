//! The engines.

mod box2d;
mod controlled;
mod driver;
mod flockenv;
pub mod rapier_f32;
pub mod rapier_f64;
mod walls;

pub use box2d::Box2d;
pub use controlled::Controlled;
pub use driver::Driver;
pub use flockenv::Ours;
pub use walls::{CHORDS, Side, circle};
