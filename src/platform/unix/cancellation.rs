// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cancellation of threads (pthread_cancel). It unwinds a thread from within the system call that it waits in, through
//! all frames, or ends it there without unwinding (musl): locks stay held, files stay, and Rust's frames end the
//! process. The request waits while cancellation is off.

use std::ffi::c_int;

/// PTHREAD_CANCEL_DISABLE.
const DISABLE: c_int = if cfg!(target_vendor = "apple") { 0 } else { 1 };

unsafe extern "C" {
    /// POSIX, in every libc but Android's; the crate libc does not declare it for most.
    safe fn pthread_setcancelstate(state: c_int, old: Option<&mut c_int>) -> c_int;
}

/// This thread is not cancelled for as long as this value lives.
pub struct Uncancelled {
    before: c_int,
}

impl Uncancelled {
    pub fn begin() -> Self {
        let mut before = DISABLE;
        pthread_setcancelstate(DISABLE, Some(&mut before));
        Self { before }
    }
}

impl Drop for Uncancelled {
    fn drop(&mut self) {
        // Some systems do not take NULL for the place of the old state.
        pthread_setcancelstate(self.before, Some(&mut 0));
    }
}
