//! Work that takes long: done without the interpreter's lock, and ended by Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Period at which signals are looked for.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Said to the work when it is no longer wanted.
#[derive(Clone, Default)]
pub(crate) struct Cancelled(Arc<AtomicBool>);

impl Cancelled {
    /// Whether it was said.
    pub(crate) fn is_said(&self) -> bool {
        self.0.load(Relaxed)
    }
}

/// Does the work on a thread of its own. On a signal whose handler raises, as Ctrl-C's does, the exception comes back at once; the
/// work is told, and work that cannot be told (a solver) comes to its end alone.
pub(crate) fn long_call<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Cancelled) -> T + Send + 'static,
) -> PyResult<T> {
    let cancelled = Cancelled::default();
    let (done, waiting) = channel();
    let told = cancelled.clone();
    std::thread::Builder::new()
        .name("quatrack".to_owned())
        .spawn(move || {
            // Nobody waits any more where it was cancelled.
            let _ = done.send(work(&told));
        })
        .map_err(|error| PyRuntimeError::new_err(format!("no thread for the work: {error}")))?;
    // A receiver is not shared between threads; it is moved into the part without the lock and back.
    let mut waiting = Some(waiting);
    loop {
        let taken = waiting.take();
        let (outcome, back) = py.detach(move || {
            let outcome = taken.as_ref().map(|receiver| receiver.recv_timeout(LOOK_EVERY));
            (outcome, taken)
        });
        waiting = back;
        match outcome {
            Some(Ok(result)) => return Ok(result),
            Some(Err(RecvTimeoutError::Timeout)) => {
                if let Err(signal) = py.check_signals() {
                    cancelled.0.store(true, Relaxed);
                    return Err(signal);
                }
            }
            _ => {
                return Err(PyRuntimeError::new_err(
                    "the work ended without a result; this is an error of the package",
                ));
            }
        }
    }
}
