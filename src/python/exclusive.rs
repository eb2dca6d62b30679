//! What one Python thread uses at a time, and long work that Ctrl-C ends.

use crate::contact::KeepGoing;
use crate::error::{FlockError, Result};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};
use std::thread;
use std::time::Duration;

/// An object that says so, instead of waiting, where another thread is at work with it.
#[derive(Debug)]
pub(crate) struct Exclusive<T> {
    object: RwLock<T>,
    name: &'static str,
}

impl<T> Exclusive<T> {
    /// An object that errors call `name`.
    pub(crate) fn new(object: T, name: &'static str) -> Self {
        Self {
            object: RwLock::new(object),
            name,
        }
    }

    /// The object, to read.
    ///
    /// # Errors
    /// [`FlockError::InUse`] while another thread changes it.
    pub(crate) fn read(&self) -> Result<RwLockReadGuard<'_, T>> {
        match self.object.try_read() {
            Ok(object) => Ok(object),
            Err(TryLockError::Poisoned(object)) => Ok(PoisonError::into_inner(object)),
            Err(TryLockError::WouldBlock) => Err(FlockError::InUse(self.name)),
        }
    }

    /// The object, to change.
    ///
    /// # Errors
    /// [`FlockError::InUse`] while another thread uses it.
    pub(crate) fn write(&self) -> Result<RwLockWriteGuard<'_, T>> {
        match self.object.try_write() {
            Ok(object) => Ok(object),
            Err(TryLockError::Poisoned(object)) => Ok(PoisonError::into_inner(object)),
            Err(TryLockError::WouldBlock) => Err(FlockError::InUse(self.name)),
        }
    }
}

/// Boats that are placed at once, too fast to interrupt.
const FEW_BOATS: usize = 1000;
/// Time between two checks of Python's signals.
const PATIENCE: Duration = Duration::from_millis(20);

/// Work on so many boats, without the interpreter lock, that stops where a signal's handler
/// raises: it has a thread of its own then, since Python checks signals in this one.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    boats: usize,
    work: impl FnOnce(KeepGoing) -> Result<T> + Send,
) -> PyResult<T> {
    if boats <= FEW_BOATS {
        return Ok(py.detach(|| work(&|| true))?);
    }
    let stopped = AtomicBool::new(false);
    let (sender, receiver) = channel();
    thread::scope(|scope| {
        let stopped = &stopped;
        scope.spawn(move || {
            let keep_going = || !stopped.load(Ordering::Relaxed);
            // Nobody listens any more where the wait has ended with an error.
            let _ = sender.send(work(&keep_going));
        });
        // What comes through a channel is to be had by one thread at a time.
        let receiver = std::sync::Mutex::new(receiver);
        loop {
            let outcome = py.detach(|| {
                let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
                receiver.recv_timeout(PATIENCE)
            });
            match outcome {
                Ok(done) => return Ok(done?),
                Err(RecvTimeoutError::Disconnected) => return Err(FlockError::Interrupted.into()),
                Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| {
                    stopped.store(true, Ordering::Relaxed);
                })?,
            }
        }
    })
}
