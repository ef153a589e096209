// SPDX-License-Identifier: MIT OR Apache-2.0
//! The state of a thread that code relies upon without asking, and that a host may have changed: how floating point
//! rounds and whether it traps, whether the thread may be cancelled, and how much stack is left. A [`Call`] sets it as
//! bhr, drivers and codecs need it, and gives it back; [`call_host`] gives it back for the length of a callback. The
//! room `platform` knows how that is done; this one nothing of what the calls do.

pub use crate::platform::on_enough_stack;

use crate::platform::{self, ControlWords, Uncancelled, on_host_stack};
use std::cell::Cell;
use std::marker::PhantomData;

thread_local! {
    /// The host's control words, while this thread is inside one of its calls.
    static HOST_WORDS: Cell<Option<ControlWords>> = const { Cell::new(None) };
}

/// A call of the host's runs on this thread, with the default control words and without cancellation, for as long as
/// this value lives. Then all is as it was, the flags of floating point too: a call raises and clears none. But from
/// the first call on the library stays in the process: threads that it starts, or that drivers do, may outlive the
/// call.
pub struct Call {
    /// The words of a call around this one, where a callback has made it.
    outer: Option<ControlWords>,
    _uncancelled: Uncancelled,
    /// A call belongs to its thread.
    _thread: PhantomData<*const ()>,
}

impl Call {
    pub fn enter() -> Self {
        platform::stay_mapped();
        let uncancelled = Uncancelled::begin();
        let outer = HOST_WORDS.replace(Some(ControlWords::of_thread()));
        ControlWords::set_default();
        Self { outer, _uncancelled: uncancelled, _thread: PhantomData }
    }
}

impl Drop for Call {
    fn drop(&mut self) {
        if let Some(host) = HOST_WORDS.replace(self.outer) {
            host.set();
        }
    }
}

/// Calls code of the host's. Inside a [`Call`] it finds its own control words, and gets as much stack as it would have
/// had without bhr; what it makes of the control words holds for the rest of the host's code. It is not cancelled: the
/// unwinding that cancellation is would go through frames of bhr's and of drivers.
pub fn call_host<R>(code: impl FnOnce() -> R) -> R {
    let Some(host) = HOST_WORDS.get() else {
        // A thread of bhr's, or of a driver's, which gets its own words back.
        let own = ControlWords::of_thread();
        let result = on_host_stack(code);
        own.set();
        return result;
    };
    host.set();
    let result = on_host_stack(code);
    HOST_WORDS.set(Some(ControlWords::of_thread()));
    ControlWords::set_default();
    result
}

/// To be called first by each thread that the library starts: it has the control words of the thread that started it.
pub fn begin_own_thread() {
    ControlWords::set_default();
}

#[cfg(test)]
mod tests;
