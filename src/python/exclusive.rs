//! Objects that refuse use by two threads at a time, and long work that Ctrl-C can end.

use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

/// An object that reports an error, instead of waiting, if another thread is using it.
#[derive(Debug)]
pub(super) struct Exclusive<T> {
    object: RwLock<T>,
    name: &'static str,
}

impl<T> Exclusive<T> {
    /// Wraps an object; errors call it `name`.
    pub(super) fn new(object: T, name: &'static str) -> Self {
        Self {
            object: RwLock::new(object),
            name,
        }
    }

    /// The object, to read.
    ///
    /// # Errors
    /// [`FlockError::InUse`] while another thread changes it.
    pub(super) fn read(&self) -> Result<RwLockReadGuard<'_, T>> {
        self.unless_in_use(self.object.try_read())
    }

    /// The object, to change.
    ///
    /// # Errors
    /// [`FlockError::InUse`] while another thread uses it.
    pub(super) fn write(&self) -> Result<RwLockWriteGuard<'_, T>> {
        self.unless_in_use(self.object.try_write())
    }

    /// The guard of a lock that was tried, even if a panic has poisoned the lock.
    fn unless_in_use<G>(&self, lock: std::result::Result<G, TryLockError<G>>) -> Result<G> {
        match lock {
            Ok(object) => Ok(object),
            Err(TryLockError::Poisoned(object)) => Ok(PoisonError::into_inner(object)),
            Err(TryLockError::WouldBlock) => Err(FlockError::InUse(self.name)),
        }
    }
}

/// Time between two checks of Python's signals.
const SIGNAL_PERIOD: Duration = Duration::from_millis(20);

/// Runs `work` without the interpreter lock, and ends it if the handler of a signal raises. `work` calls `keep_going` now
/// and then, from any thread. Only calls from this thread check for signals: Python does not handle them in threads that
/// `work` starts. Calls from the other threads return the result of the last check.
pub(super) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(KeepGoing) -> Result<T> + Send,
) -> PyResult<T> {
    let caller = thread::current().id();
    let last_check = Mutex::new((Instant::now(), None));
    let keep_going = || {
        let mut last_check = last_check.lock().unwrap_or_else(PoisonError::into_inner);
        let (time, raised) = &mut *last_check;
        if raised.is_none() && thread::current().id() == caller && time.elapsed() >= SIGNAL_PERIOD {
            *raised = Python::attach(|py| py.check_signals().err());
            *time = Instant::now();
        }
        raised.is_none()
    };
    let outcome = py.detach(|| work(&keep_going));
    let (_, raised) = last_check
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    raised.map_or_else(|| Ok(outcome?), Err)
}
