//! Limits on the cost of a load step, and the request to cancel.

use super::options::ContinuationOptions;
use super::status::Status;
use std::fmt::Debug;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A request to end a solve, polled in every iteration by all threads.
pub trait Cancel: Debug + Sync {
    /// Whether the solve is to end.
    fn is_requested(&self) -> bool;
}

impl Cancel for AtomicBool {
    fn is_requested(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}

/// Counts the iterations of a load step against its limits.
#[derive(Clone, Debug)]
pub(super) struct Budget<'a> {
    max_iterations: usize,
    /// A lower limit, for the first of two ways to solve a step.
    first_attempt: Option<usize>,
    max_time: Option<Duration>,
    /// Set from outside when the solve is to end.
    cancel: Option<&'a dyn Cancel>,
    iterations: usize,
    deadline: Option<Instant>,
    /// Checks since the last poll.
    checks: usize,
}

/// Number of checks per poll of the clock and the request to cancel, which are slow to read.
const POLL_INTERVAL: usize = 8;

impl<'a> Budget<'a> {
    pub fn new(options: &ContinuationOptions, cancel: Option<&'a dyn Cancel>) -> Self {
        let max_time = Duration::try_from_secs_f64(options.max_seconds).ok();
        Self {
            max_iterations: options.max_iterations,
            first_attempt: None,
            max_time,
            cancel,
            iterations: 0,
            deadline: None,
            checks: 0,
        }
    }

    /// Resets the budget for a load step; its first check polls.
    pub fn restart(&mut self) {
        self.iterations = 0;
        self.checks = POLL_INTERVAL;
        self.deadline = self.max_time.and_then(|time| Instant::now().checked_add(time));
    }

    /// Sets a lower limit of iterations, or removes it; returns the one before.
    pub fn limit(&mut self, iterations: Option<usize>) -> Option<usize> {
        std::mem::replace(&mut self.first_attempt, iterations)
    }

    pub fn count(&mut self) {
        self.iterations += 1;
    }

    /// Iterations of this load step.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// The reason to end the load step now, if there is one.
    pub fn exhausted(&mut self) -> Option<Status> {
        if self.iterations > self.first_attempt.unwrap_or(self.max_iterations).min(self.max_iterations) {
            return Some(Status::IterationLimit);
        }
        self.checks += 1;
        if self.checks < POLL_INTERVAL {
            return None;
        }
        self.checks = 0;
        if self.cancel.is_some_and(Cancel::is_requested) {
            Some(Status::Cancelled)
        } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            Some(Status::TimeLimit)
        } else {
            None
        }
    }
}
