//! Engines in other languages take part through files: their tasks go out as `tasks.json`; what comes
//! back are `results.json` and the poses and velocities they name.

mod judge;
mod task;

pub use judge::judge;
pub use task::write_tasks;
