// SPDX-License-Identifier: MIT OR Apache-2.0
//! Counts, for each thread, the calls and the callbacks of the host's that it is inside of.

use crate::thread_state;
use std::cell::Cell;
use std::thread::LocalKey;

thread_local! {
    pub(super) static CALLS: Cell<u32> = const { Cell::new(0) };
    static CALLBACKS: Cell<u32> = const { Cell::new(0) };
    static LOG_CALLBACKS: Cell<u32> = const { Cell::new(0) };
}

pub(super) fn in_callback() -> bool {
    count(&CALLBACKS) > 0
}

pub(super) fn in_log_callback() -> bool {
    count(&LOG_CALLBACKS) > 0
}

/// A counter of this thread; 0 where the thread is ending.
pub(super) fn count(counter: &'static LocalKey<Cell<u32>>) -> u32 {
    counter.try_with(Cell::get).unwrap_or(0)
}

/// Adds one to a counter of this thread for as long as it lives.
pub(super) struct Depth(&'static LocalKey<Cell<u32>>);

impl Depth {
    pub(super) fn enter(counter: &'static LocalKey<Cell<u32>>) -> Self {
        let _ = counter.try_with(|n| n.set(n.get() + 1));
        Self(counter)
    }
}

impl Drop for Depth {
    fn drop(&mut self) {
        let _ = self.0.try_with(|n| n.set(n.get().saturating_sub(1)));
    }
}

/// This thread is inside a callback of the host's for as long as this value lives.
pub(super) struct InsideCallback {
    _any: Depth,
    _log: Option<Depth>,
}

impl InsideCallback {
    pub(super) fn log() -> Self {
        Self { _any: Depth::enter(&CALLBACKS), _log: Some(Depth::enter(&LOG_CALLBACKS)) }
    }

    pub(super) fn progress() -> Self {
        Self { _any: Depth::enter(&CALLBACKS), _log: None }
    }

    /// Runs the callback, which finds the state of its thread as the host has it.
    pub(super) fn run<R>(self, callback: impl FnOnce() -> R) -> R {
        thread_state::call_host(callback)
    }
}
