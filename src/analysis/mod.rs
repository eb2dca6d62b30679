//! Measurements of boats: order parameters, collective states, and positions relative to each other and to the wall.

pub mod collective_state;
mod order_parameters;
pub mod quantities;
pub mod samples;
pub mod structure;

pub use collective_state::CollectiveState;
pub use order_parameters::OrderParameters;
