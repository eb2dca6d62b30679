//! The environment's core without Python, one file per law.

mod batches;
mod episodes;
mod observations;
mod stored_states;
mod support;
