//! The laws of the physics, one file a law: each opens with the law it checks and starts with a case
//! whose answer is known on paper. Slow tests are ignored by default: `cargo test -- --ignored`.

mod support;

mod bad_input;
mod conservation;
mod determinism;
mod free_motion;
mod geometry;
mod impact;
mod noise;
mod order_parameters;
mod parameters;
mod phases;
mod placement;
mod pushing;
mod sliding;
mod steady_turning;
mod symmetry;
