// SPDX-License-Identifier: MIT OR Apache-2.0
//! The windows that have a surface. A window takes one surface: which of two would show is up to the driver, if it does
//! not fail.

use crate::error::{Error, Result};
use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A window among all of the process: its server or kind, and its number there.
pub type Key = (String, u64);

static CLAIMED: Mutex<BTreeSet<Key>> = Mutex::new(BTreeSet::new());

fn claimed() -> MutexGuard<'static, BTreeSet<Key>> {
    CLAIMED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A window is taken for as long as this value lives.
pub struct Claim(Key);

impl Claim {
    /// Errors: INVALID_STATE for a window that is taken.
    pub fn new(key: Key) -> Result<Self> {
        if claimed().insert(key.clone()) {
            return Ok(Self(key));
        }
        Err(Error::state(format!("window {:#x} has a surface already; destroy that one first", key.1)))
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        claimed().remove(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn a_window_is_taken_once_at_a_time() {
        let key = || ("test".to_owned(), 7);
        let first = Claim::new(key()).unwrap();
        assert_eq!(Claim::new(key()).err().unwrap().kind, ErrorKind::InvalidState);
        let other = Claim::new(("another".to_owned(), 7)).unwrap();
        drop(first);
        drop(Claim::new(key()).unwrap());
        drop(other);
    }
}
