// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shape of every entry point: refuse calls from inside callbacks, run one closure under the panic guard (with a
//! context, call.rs: under its lock), and turn the result into a status, this thread's message and a log line.

use super::callback::in_callback;
use super::message::keep_message;
use super::panic::guarded;
use super::status::{self, BHR_OK, BhrStatus};
use crate::error::{Error, Result};
use crate::gpu::process_end;

/// The value of a body that succeeds.
pub(super) trait Success {
    fn status(self) -> BhrStatus;
}

impl Success for () {
    fn status(self) -> BhrStatus {
        BHR_OK
    }
}

/// The status of a success, >= 0: with news, or without.
pub(super) struct SuccessStatus(pub BhrStatus);

impl Success for SuccessStatus {
    fn status(self) -> BhrStatus {
        self.0
    }
}

/// A call that touches nothing shared: allowed inside callbacks.
pub(super) fn anywhere(function: &str, body: impl FnOnce() -> Result<()>) -> BhrStatus {
    finish(function, guarded(body))
}

/// A call without a context that reaches drivers or shared state: refused inside callbacks, and in the end of the
/// process.
pub(super) fn outside_callbacks<T: Success>(function: &str, body: impl FnOnce() -> Result<T>) -> BhrStatus {
    finish(function, refuse_in_callback().and_then(|()| refuse_at_the_end()).and_then(|()| guarded(body)))
}

/// Keeps the message and logs it. The status of `result`.
pub(super) fn finish<T: Success>(function: &str, result: Result<T>) -> BhrStatus {
    let error = match result {
        Ok(success) => return success.status(),
        Err(error) => error,
    };
    // `allocate` leaves the message empty where there is no memory for one.
    let message = if error.message.is_empty() { "no memory is left" } else { &error.message };
    ::log::error!(target: "bhr", "{function}: {message}");
    keep_message(format_args!("{function}: {message}"));
    status::of(error.kind)
}

/// Errors: INVALID_STATE inside a callback.
pub(super) fn refuse_in_callback() -> Result<()> {
    if in_callback() {
        return Err(Error::state("called from inside a log or progress callback; return from it first"));
    }
    Ok(())
}

/// Errors: INVALID_STATE on the thread that ends the process, if a driver was loaded.
pub(super) fn refuse_at_the_end() -> Result<()> {
    if process_end::is_here() {
        return Err(Error::state("the process is ending, and with it the drivers that contexts use"));
    }
    Ok(())
}

/// Destroys what is a driver's; in the end of the process it is left to the system, as the driver may be gone already.
pub(super) fn give_back<T: 'static>(function: &str, owned: T, end: impl FnOnce(&T)) {
    if process_end::is_here() {
        return process_end::keep(owned);
    }
    let ended = guarded(|| {
        end(&owned);
        Ok(())
    });
    // Dropped under a guard of its own: a second panic while one unwinds would end the process.
    let dropped = guarded(move || {
        drop(owned);
        Ok(())
    });
    finish(function, ended.and(dropped));
}
