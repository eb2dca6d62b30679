//! Training of leaders in paired branches: two flocks start from the same state and get the same noise, so that they
//! differ only by their leaders' actions.

mod branch;
mod regression;
mod settings;
mod trainer;

pub use settings::BranchSettings;
pub use trainer::Trainer;
