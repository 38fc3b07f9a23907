//! Solves that Python's signals, such as Ctrl-C, can end.

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::Duration;

/// How often the calling thread looks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// The requests to stop of all solves that are running.
static RUNNING: Mutex<Vec<Weak<AtomicBool>>> = Mutex::new(Vec::new());

/// Ends the solves that are running on any thread; each raises KeyboardInterrupt.
#[pyfunction]
pub fn cancel() {
    let running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    running.iter().filter_map(Weak::upgrade).for_each(|flag| flag.store(true, Ordering::Relaxed));
}

/// Runs a solve without the GIL on a thread of its own, while the calling thread waits for it and for
/// signals, which only the main thread can handle.
///
/// # Errors
/// What the handler of a signal raises, and KeyboardInterrupt if the solve was ended by [`cancel`].
pub fn interruptible<T: Send>(py: Python<'_>, solve: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let flag = Arc::new(AtomicBool::new(false));
    {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        running.retain(|other| other.strong_count() > 0);
        running.push(Arc::downgrade(&flag));
    }
    let found = py.detach(|| {
        thread::scope(|scope| {
            let (send, receive) = sync_channel(1);
            let flag = &*flag;
            let solving = scope.spawn(move || send.send(solve(flag)));
            loop {
                match receive.recv_timeout(LOOK) {
                    Ok(found) => break Ok(found),
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(raised) = Python::attach(|py| py.check_signals()) {
                            flag.store(true, Ordering::Relaxed);
                            break Err(raised);
                        }
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        let panicked = solving.join().err().unwrap_or_else(|| Box::new("no result"));
                        resume_unwind(panicked);
                    }
                }
            }
        })
    });
    if found.is_ok() && flag.load(Ordering::Relaxed) {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    found
}
