//! Solves that Python's signals, such as Ctrl-C, can end.

use flexor_engine::equilibrium::Cancel;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// How often the calling thread looks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// The requests to stop of all solves that are running.
static RUNNING: Mutex<Vec<Weak<AtomicBool>>> = Mutex::new(Vec::new());

/// Ends the solves that are running on any thread; each raises KeyboardInterrupt.
#[pyfunction]
pub fn cancel() {
    let running = locked(&RUNNING);
    running.iter().filter_map(Weak::upgrade).for_each(|flag| flag.store(true, Ordering::Relaxed));
}

/// What ends a solve: [`cancel`], or what a signal's handler raises. Only the main thread can handle
/// signals, so the thread that called looks for them: while it solves, or while it waits.
#[derive(Debug)]
struct Interrupt {
    caller: ThreadId,
    requested: Arc<AtomicBool>,
    looked: Mutex<Instant>,
    raised: Mutex<Option<PyErr>>,
}

impl Interrupt {
    fn new() -> Self {
        let requested = Arc::new(AtomicBool::new(false));
        let mut running = locked(&RUNNING);
        running.retain(|other| other.strong_count() > 0);
        running.push(Arc::downgrade(&requested));
        let (looked, raised) = (Mutex::new(Instant::now()), Mutex::new(None));
        Self { caller: thread::current().id(), requested, looked, raised }
    }

    fn look(&self) {
        if let Err(error) = Python::attach(|py| py.check_signals()) {
            *locked(&self.raised) = Some(error);
            self.requested.store(true, Ordering::Relaxed);
        }
    }

    fn is_due(&self) -> bool {
        let mut looked = locked(&self.looked);
        let due = looked.elapsed() >= LOOK;
        if due {
            *looked = Instant::now();
        }
        due
    }
}

impl Cancel for Interrupt {
    fn is_requested(&self) -> bool {
        if thread::current().id() == self.caller && self.is_due() {
            self.look();
        }
        self.requested.load(Ordering::Relaxed)
    }
}

/// Runs a solve without the GIL: on the calling thread, or on threads of its own if it is `parallel`.
///
/// # Errors
/// What the handler of a signal raises, and KeyboardInterrupt if the solve was ended by [`cancel`].
pub fn interruptible<T: Send>(
    py: Python<'_>,
    parallel: bool,
    solve: impl FnOnce(&dyn Cancel) -> T + Send,
) -> PyResult<T> {
    let interrupt = Interrupt::new();
    let found = py.detach(|| if parallel { solve_beside(&interrupt, solve) } else { solve(&interrupt) });
    if let Some(error) = locked(&interrupt.raised).take() {
        return Err(error);
    }
    if interrupt.requested.load(Ordering::Relaxed) {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    Ok(found)
}

/// Solves on another thread, while this one waits and looks for signals.
fn solve_beside<T: Send>(interrupt: &Interrupt, solve: impl FnOnce(&dyn Cancel) -> T + Send) -> T {
    thread::scope(|scope| {
        let (send, receive) = sync_channel(1);
        let solving = scope.spawn(move || send.send(solve(interrupt)));
        loop {
            match receive.recv_timeout(LOOK) {
                Ok(found) => return found,
                Err(RecvTimeoutError::Timeout) => interrupt.look(),
                Err(RecvTimeoutError::Disconnected) => {
                    resume_unwind(solving.join().err().unwrap_or_else(|| Box::new("nothing was sent")))
                }
            }
        }
    })
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
