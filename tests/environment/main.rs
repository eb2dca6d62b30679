//! The environment's core without Python, one file per law.
#![allow(
    clippy::disallowed_methods,
    reason = "the machine's own elementary functions check those of the library"
)]

mod batches;
mod episodes;
mod leader_targets;
mod observations;
mod pilots;
mod same_bits_of_training;
mod stored_states;
mod support;
