//! Rapier in single precision, with its vector instructions.

use rapier2d as rapier;

type Real = f32;

#[path = "rapier.rs"]
#[allow(clippy::duplicate_mod, reason = "one source for both precisions")]
mod world;

pub use world::{Rapier, Settings};
