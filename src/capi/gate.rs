// SPDX-License-Identifier: MIT OR Apache-2.0
//! A gate that callbacks of the host pass: once it is closed none runs any more, and those that run are waited for.

use crate::gpu::process_end;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a context waits for calls and callbacks that are running when the process ends: they may wait for the
/// thread that ends it.
pub(super) const AT_THE_END: Duration = Duration::from_secs(3);

#[derive(Default)]
pub(super) struct Gate {
    state: Mutex<State>,
    idle: Condvar,
}

#[derive(Default)]
struct State {
    closed: bool,
    /// Callbacks that are running now.
    running: u32,
}

/// A callback is running for as long as this value lives.
pub(super) struct RunningCallback<'a>(&'a Gate);

impl Gate {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A panic leaves nothing under this lock half done.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets a callback in; `None` when the gate is closed.
    pub fn enter(&self) -> Option<RunningCallback<'_>> {
        let mut state = self.lock();
        if state.closed {
            return None;
        }
        state.running += 1;
        Some(RunningCallback(self))
    }

    /// Waits for those that run, on the thread that ends the process for [`AT_THE_END`] at most.
    pub fn close(&self) {
        let mut state = self.lock();
        state.closed = true;
        let limit = process_end::is_here().then(|| Instant::now() + AT_THE_END);
        while state.running > 0 {
            let Some(limit) = limit else {
                state = self.idle.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = limit.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return;
            }
            state = self.idle.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    #[cfg(test)]
    pub fn running(&self) -> u32 {
        self.lock().running
    }
}

impl Drop for RunningCallback<'_> {
    fn drop(&mut self) {
        self.0.lock().running -= 1;
        self.0.idle.notify_all();
    }
}
