//! Work shared out to threads, in a way that survives a fork: the flocks of a batch, or the islands of one flock.

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder, Yield};
use std::process::id;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// The process that rayon's own threads live in.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();
/// Threads of a forked child, and the child they live in.
static FORKED: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Notes that rayon's own threads live in this process, in case other code starts them.
#[cfg(feature = "python")]
pub(crate) fn note_process() {
    FIRST_PROCESS.get_or_init(id);
}

/// Maps items in order. One item, or one thread, is worked on at once where it is: waking a pool takes
/// about as long as a control step.
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
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

/// Does some work on one of the pool's threads and keeps so many others awake meanwhile, for [`hand_out`]: to wake
/// one takes about as long as what it is handed. Work that is on such a thread already, or has no other threads
/// beside it, is done where it is.
pub(crate) fn inside<R: Send>(others: usize, work: impl FnOnce() -> R + Send) -> R {
    if rayon::current_thread_index().is_some() || rayon::current_num_threads() == 1 {
        return work();
    }
    let accompanied = || {
        let is_done = AtomicBool::new(false);
        let work = || {
            let _done = SetAtEnd(&is_done);
            work()
        };
        let mut others = vec![(); others.min(rayon::current_num_threads() - 1)];
        let stay = |(): &mut ()| stay_awake(&is_done);
        rayon::join(work, || in_parallel(&mut others, &stay)).0
    };
    if *FIRST_PROCESS.get_or_init(id) == id() {
        return rayon::join(accompanied, || ()).0;
    }
    match pool_of_fork() {
        Some(pool) => pool.install(accompanied),
        None => accompanied(),
    }
}

/// Sets a flag when it goes, after a panic too.
struct SetAtEnd<'a>(&'a AtomicBool);

impl Drop for SetAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Does what other threads hand out, until all is done.
fn stay_awake(is_done: &AtomicBool) {
    while !is_done.load(Ordering::Acquire) {
        if rayon::yield_now() != Some(Yield::Executed) {
            std::thread::yield_now();
        }
    }
}

/// Hands items out to workers, in order, to whichever is free. Only [`inside`] do workers have threads of their own.
pub(crate) fn hand_out<W: Send, T: Send>(
    workers: &mut [W],
    items: impl Iterator<Item = T> + Send,
    work: impl Fn(&mut W, T) + Sync,
) {
    let items = Mutex::new(items);
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let take_all = |worker: &mut W| {
        while let Some(item) = next() {
            work(worker, item);
        }
    };
    let count = workers.len().min(rayon::current_num_threads());
    in_parallel(&mut workers[..count], &take_all);
}

fn in_parallel<W: Send>(workers: &mut [W], work: &(impl Fn(&mut W) + Sync)) {
    match workers {
        [] => {}
        [alone] => work(alone),
        [first, others @ ..] => {
            rayon::join(|| work(first), || in_parallel(others, work));
        }
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
