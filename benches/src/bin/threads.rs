//! The time of a step with two threads: `threads FOLDER [--trial]` writes threads.csv. It is a separate program, since
//! rapier's threads are a feature with which it is compiled.

use flockenv_benches::measure::{Effort, threads};
use std::path::Path;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let folder = arguments.get(1).expect("threads FOLDER [--trial]");
    let is_trial = arguments.iter().any(|argument| argument == "--trial");
    let effort = if is_trial {
        Effort::Trial
    } else {
        Effort::Full
    };
    // Rapier uses the threads of the global pool, and Box2D starts its own.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads::THREADS);
    pool.build_global().expect("the first pool");
    threads::measure(effort).write(Path::new(folder), "threads.csv");
}
