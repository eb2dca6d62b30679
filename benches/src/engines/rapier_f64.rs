//! Rapier in double precision.

use rapier2d_f64 as rapier;

type Real = f64;

#[path = "rapier.rs"]
mod world;

pub use world::{Rapier, Settings};
