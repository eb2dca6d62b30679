//! Training of leaders in paired branches: two flocks that start from one state and meet one noise differ only by what
//! their leaders try.

mod branch;
mod regression;
mod settings;
mod trainer;

pub use settings::BranchSettings;
pub use trainer::Trainer;
