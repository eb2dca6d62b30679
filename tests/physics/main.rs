//! The laws of the physics, one file a law: each opens with the law it checks and starts with a case
//! whose answer is known on paper. Slow tests are ignored by default: `cargo test -- --ignored`.

mod dense_reference;
mod support;

mod bad_input;
mod conservation;
mod determinism;
mod free_motion;
mod geometry;
mod hard_cases;
mod impact;
mod jam;
mod noise;
mod order_parameters;
mod overlap;
mod parameters;
mod phases;
mod placement;
mod published;
mod pushing;
mod sliding;
mod slivers;
mod solver;
mod solver_agreement;
mod steady_turning;
mod symmetry;
mod work_counts;
