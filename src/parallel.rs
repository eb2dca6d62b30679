//! Work shared out to threads, in a way that survives a fork.

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process::id;
use std::sync::{Mutex, OnceLock, PoisonError};

/// The process that rayon's own threads live in.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();
/// Threads of a forked child, and the child they live in.
static FORKED: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Notes that rayon's own threads live in this process, in case other code starts them.
#[cfg(feature = "python")]
pub fn note_process() {
    FIRST_PROCESS.get_or_init(id);
}

/// Maps items in order. One item, or one thread, is worked on at once where it is: waking a pool takes
/// about as long as a control step.
pub fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    if items.len() <= 1 || rayon::current_num_threads() == 1 {
        return items.into_iter().map(work).collect();
    }
    if *FIRST_PROCESS.get_or_init(id) == id() {
        return items.into_par_iter().map(work).collect();
    }
    match pool_of_fork() {
        Some(pool) => pool.install(|| items.into_par_iter().map(work).collect()),
        None => items.into_iter().map(work).collect(),
    }
}

/// A fork copies no threads: the child would wait for its parent's forever. The parent's pool is never
/// dropped there, since that would wait too.
fn pool_of_fork() -> Option<&'static ThreadPool> {
    let mut forked = FORKED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((process, pool)) = *forked
        && process == id()
    {
        return Some(pool);
    }
    let pool: &'static ThreadPool = Box::leak(Box::new(ThreadPoolBuilder::new().build().ok()?));
    *forked = Some((id(), pool));
    Some(pool)
}
