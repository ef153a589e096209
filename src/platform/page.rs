// SPDX-License-Identifier: MIT OR Apache-2.0
//! A web page: WebAssembly without threads, files or a process.

pub use super::bare::*;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::Duration;
pub use web_time::Instant;

/// A page has no process, and never becomes another.
pub fn process_id() -> u32 {
    0
}

/// The page's thread may not wait. Errors: what has not come is late.
pub fn receive_within<T>(from: &Receiver<T>, _: Duration) -> Result<T, RecvTimeoutError> {
    from.try_recv().map_err(|error| match error {
        TryRecvError::Empty => RecvTimeoutError::Timeout,
        TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
    })
}
