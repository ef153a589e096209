// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `memory` without the feature `window`: no window takes frames.

use super::Window;
use crate::error::{Error, Result};

pub const MAX_SIDE: u32 = 1;
pub const MAX_PIXELS: u64 = 1;

/// There is none.
pub enum MemoryWindow {}

impl MemoryWindow {
    /// Errors: UNSUPPORTED.
    pub fn new(_: &Window) -> Result<Self> {
        Err(Error::unsupported("this library was built without windows"))
    }

    pub fn present(&mut self, _: &Window, _: [u32; 2], _: &[u8]) -> Result<()> {
        match *self {}
    }
}
