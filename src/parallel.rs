//! Divides the flocks of a batch among threads, also in a forked process.

use rayon::{Scope, ThreadPool, ThreadPoolBuilder};
use std::collections::VecDeque;
use std::process::id;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Id of the process to which rayon's own threads belong.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();
/// Id of a forked child process, and the thread pool made for it.
static FORKED: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Records that rayon's own threads belong to this process. Other code may start them before the first [`map`].
#[cfg(feature = "python")]
pub(crate) fn note_process() {
    FIRST_PROCESS.get_or_init(id);
}

/// Applies `work` to the items, in parallel; returns the results in the order of the items.
///
/// The calling thread works, too, since waking a thread takes about as long as some control steps. Each thread has a
/// block of the items. The block is the same at every call, so that it stays in the thread's cache. A thread that has
/// finished its own block takes items from the ends of other blocks.
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    // WebAssembly has neither threads nor processes, and asking for the process id would end the program.
    if cfg!(target_family = "wasm") {
        return items.into_iter().map(work).collect();
    }
    let threads = rayon::current_num_threads().min(items.len());
    let is_fork = *FIRST_PROCESS.get_or_init(id) != id() && rayon::current_thread_index().is_none();
    let pool = if is_fork { pool_of_fork() } else { None };
    if threads <= 1 || (is_fork && pool.is_none()) {
        return items.into_iter().map(work).collect();
    }
    let mut results: Vec<_> = items.iter().map(|_| None).collect();
    let blocks = split(items, &mut results, threads);
    let work_from = |own_block: usize| {
        for distance in 0..threads {
            let block = &blocks[(own_block + distance) % threads];
            let is_own = distance == 0;
            while let Some((item, result)) = take(block, is_own) {
                *result = Some(work(item));
            }
        }
    };
    let helpers = AtomicUsize::new(0);
    match pool {
        Some(pool) => pool.in_place_scope(|scope| spawn(scope, threads, &work_from, &helpers)),
        None => rayon::in_place_scope(|scope| spawn(scope, threads, &work_from, &helpers)),
    }
    results.into_iter().flatten().collect()
}

/// Items of one thread, each with the slot for its result.
type Block<'a, T, R> = Mutex<VecDeque<(T, &'a mut Option<R>)>>;

/// Splits items and the slots for their results into equal blocks; the last ones may be shorter.
fn split<T, R>(items: Vec<T>, results: &mut [Option<R>], blocks: usize) -> Vec<Block<'_, T, R>> {
    let size = items.len().div_ceil(blocks);
    let mut pairs = items.into_iter().zip(results);
    (0..blocks)
        .map(|_| Mutex::new(pairs.by_ref().take(size).collect()))
        .collect()
}

/// Takes the first item of the thread's own block, or the last one of another thread's.
fn take<'a, T, R>(block: &Block<'a, T, R>, is_own: bool) -> Option<(T, &'a mut Option<R>)> {
    let mut items = block.lock().unwrap_or_else(PoisonError::into_inner);
    if is_own {
        items.pop_front()
    } else {
        items.pop_back()
    }
}

/// How often a thread yields while it waits for another's last item, before it sleeps.
const MOST_YIELDS: u32 = 1000;

/// Calls `work(0)` on this thread, and `work(1)` to `work(threads - 1)` on other threads. `helpers` holds the number of
/// other threads that are now at work.
fn spawn<'scope>(
    scope: &Scope<'scope>,
    threads: usize,
    work: &'scope (impl Fn(usize) + Sync),
    helpers: &'scope AtomicUsize,
) {
    for thread in 1..threads {
        scope.spawn(move |_| {
            helpers.fetch_add(1, Ordering::AcqRel);
            work(thread);
            helpers.fetch_sub(1, Ordering::AcqRel);
        });
    }
    work(0);
    // Yielding is cheaper than sleeping: another thread finishes its last item sooner than this thread would be woken.
    let mut yields_left = MOST_YIELDS;
    while helpers.load(Ordering::Acquire) > 0 && yields_left > 0 {
        std::thread::yield_now();
        yields_left -= 1;
    }
}

/// The thread pool of this forked process, which is made at the first call; `None` if no thread can be started.
///
/// A fork copies no threads, so the child would wait forever for its parent's pool. It never drops that pool, since
/// dropping would wait, too.
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
