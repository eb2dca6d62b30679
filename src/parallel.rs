//! Divides the flocks of a batch among threads, also in a forked process.

use rayon::{Scope, ThreadPool, ThreadPoolBuilder};
use std::collections::VecDeque;
use std::process::id;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Number of the process to which rayon's own threads belong.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();
/// Threads of a forked child, with the number of that process.
static FORKED: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Records that rayon's own threads belong to this process. Other code may start them before the first [`map`].
#[cfg(feature = "python")]
pub(crate) fn note_process() {
    FIRST_PROCESS.get_or_init(id);
}

/// Maps items in order. The caller takes part, since waking a thread, or being woken, takes about as long as some
/// control steps. Each thread has a block of the items. The block is the same at every call, so that it stays in the
/// thread's cache. A thread that is done helps with the ends of other blocks.
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    // WebAssembly has neither threads nor processes, and asking for a process's number would end the program.
    if cfg!(target_family = "wasm") {
        return items.into_iter().map(work).collect();
    }
    let threads = rayon::current_num_threads().min(items.len());
    let is_fork = *FIRST_PROCESS.get_or_init(id) != id() && rayon::current_thread_index().is_none();
    let pool = if is_fork { pool_of_fork() } else { None };
    if threads <= 1 || (is_fork && pool.is_none()) {
        return items.into_iter().map(work).collect();
    }
    let size = items.len().div_ceil(threads);
    let mut results: Vec<_> = items.iter().map(|_| None).collect();
    let mut pairs = items.into_iter().zip(&mut results);
    let blocks: Vec<Mutex<VecDeque<_>>> = (0..threads)
        .map(|_| Mutex::new(pairs.by_ref().take(size).collect()))
        .collect();
    let take = |block: usize, is_own: bool| {
        let mut block = blocks[block].lock().unwrap_or_else(PoisonError::into_inner);
        if is_own {
            block.pop_front()
        } else {
            block.pop_back()
        }
    };
    let take_all = |own: usize| {
        for step in 0..threads {
            while let Some((item, result)) = take((own + step) % threads, step == 0) {
                *result = Some(work(item));
            }
        }
    };
    let helpers = AtomicUsize::new(0);
    match pool {
        Some(pool) => pool.in_place_scope(|scope| share(scope, threads, &take_all, &helpers)),
        None => rayon::in_place_scope(|scope| share(scope, threads, &take_all, &helpers)),
    }
    results.into_iter().flatten().collect()
}

/// How often a thread yields while it waits for another's last item, before it sleeps.
const MOST_YIELDS: u32 = 1000;

/// Does part 0 of some work on this thread and the other parts on other threads. `helpers` counts the other threads
/// that are at work.
fn share<'scope>(
    scope: &Scope<'scope>,
    parts: usize,
    work: &'scope (impl Fn(usize) + Sync),
    helpers: &'scope AtomicUsize,
) {
    for part in 1..parts {
        scope.spawn(move |_| {
            helpers.fetch_add(1, Ordering::AcqRel);
            work(part);
            helpers.fetch_sub(1, Ordering::AcqRel);
        });
    }
    work(0);
    // Waiting is cheaper than sleeping: another thread finishes its last item sooner than this thread would be woken.
    let mut patience = MOST_YIELDS;
    while helpers.load(Ordering::Acquire) > 0 && patience > 0 {
        std::thread::yield_now();
        patience -= 1;
    }
}

/// A fork copies no threads: the child would wait forever for its parent's threads. The child never drops the parent's
/// pool, since that would wait, too.
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
