//! Measures flockenv and the engines that a user would pick instead on the same scenes: how long a
//! step takes, and how far off it is.
//!
//! Scene and start → [`Configuration`] → [`Engine`] → measurements → CSV. Engines in other languages
//! take part through files: [`exchange`] writes their tasks and judges the poses they bring back.

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
