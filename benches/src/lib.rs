//! Measures flockenv and alternative engines on the same scenes: the time of a step, and its error.
//!
//! Scene and start → [`Configuration`] → [`Engine`] → measurements → CSV. Engines in other languages
//! take part through files: [`exchange`] writes their tasks and measures the poses that they return.

pub mod configuration;
pub mod engine;
pub mod engines;
pub mod exchange;
pub mod measure;
pub mod scene;
pub mod table;

pub use configuration::Configuration;
pub use engine::Engine;
pub use scene::{Scene, Start};
