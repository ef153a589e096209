// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bytes on a device that are counted while something lives.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that a total counts as long as this lives.
pub struct Counted {
    bytes: u64,
    total: Arc<AtomicU64>,
}

impl Counted {
    pub fn new(total: Arc<AtomicU64>, bytes: u64) -> Self {
        total.fetch_add(bytes, Ordering::Relaxed);
        Self { bytes, total }
    }

    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.total.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}
