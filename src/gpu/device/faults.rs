// SPDX-License-Identifier: MIT OR Apache-2.0
//! Failures of a device that tests ask for, at a place and a time that no driver could be made to fail at. Knows
//! neither devices nor tests.

use crate::error::{Error, ErrorKind, Result};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// The failure that is to come, if one is.
#[derive(Default)]
pub struct Faults {
    /// Whether one is to come: all that other devices ask.
    armed: AtomicBool,
    /// The begin of the message of the call that is to fail, and how many such calls pass before it does.
    next: Mutex<Option<(&'static str, u32)>>,
}

impl Faults {
    /// After `passing` more calls whose messages begin with `what`, one fails.
    pub fn arm(&self, what: &'static str, passing: u32) {
        *self.next.lock().unwrap_or_else(PoisonError::into_inner) = Some((what, passing));
        self.armed.store(true, Ordering::Release);
    }

    /// Errors: OUT_OF_MEMORY, once, when its time has come.
    pub fn check(&self, what: &str) -> Result<()> {
        if !self.armed.load(Ordering::Acquire) {
            return Ok(());
        }
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        match next.as_mut() {
            Some((at, passing)) if *at == what && *passing > 0 => *passing -= 1,
            Some((at, _)) if *at == what => {
                *next = None;
                self.armed.store(false, Ordering::Release);
                return Err(Error::new(ErrorKind::OutOfMemory, format!("{what}: failed, as a test asked")));
            }
            _ => {}
        }
        Ok(())
    }
}
