//! The environment's core without Python, one file per law.

mod batches;
mod episodes;
mod leader_targets;
mod observations;
mod stored_states;
mod support;
