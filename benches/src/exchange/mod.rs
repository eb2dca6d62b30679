//! Engines in other languages take part through files: they read their tasks in `tasks.json`, and write `results.json` and
//! the files of poses and velocities that it names.

mod judge;
mod task;

pub use judge::judge;
pub use task::write_tasks;
