//! The laws of the physics, one file per law: each opens with the law it checks and starts with a case
//! whose answer is known on paper. Slow tests are ignored by default: `cargo test -- --ignored`.
#![allow(
    clippy::disallowed_methods,
    reason = "the machine's own elementary functions check those of the library"
)]

mod dense_reference;
mod reference;
mod support;

mod bad_input;
mod changes;
mod collective_state;
mod conservation;
mod damping;
mod determinism;
mod free_motion;
mod geometry;
mod hard_cases;
mod impact;
mod jam;
mod joined_walls;
mod leader_speed;
mod noise;
mod obstacle_gaps;
mod obstacle_gates;
mod obstacle_hard_cases;
mod obstacle_placement;
mod obstacles;
mod optional_effects;
mod order_parameters;
mod overlap;
mod parameters;
mod passivity;
mod phases;
mod placement;
mod published;
mod pushing;
mod quantities;
mod rest;
mod same_bits;
mod scaling;
mod sliding;
mod slivers;
mod soak;
mod solver;
mod solver_agreement;
mod speed_spread;
mod steady_turning;
mod step_error;
mod structure;
mod symmetry;
mod touches;
mod tracks;
mod turning_bias;
mod water_current;
mod water_edge;
mod work_bound;
mod work_counts;
