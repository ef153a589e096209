// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `pool` in pages, which have one thread.

use crate::error::Result;

pub(super) struct Pool;

impl Pool {
    /// No threads, however many are asked for.
    pub fn new(_: usize) -> Result<Self> {
        Ok(Self)
    }

    /// Does `work` here.
    pub fn install<T>(&self, work: impl FnOnce() -> T) -> T {
        work()
    }
}
