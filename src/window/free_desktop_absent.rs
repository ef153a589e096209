// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `free_desktop` on systems whose windows are neither X11's nor Wayland's, and without the feature
//! `window`.

use super::{Handles, NativeWindow, Pacer, claim};
use crate::error::{Error, Result};
use std::ffi::c_void;
use std::ptr::NonNull;

/// There is none.
pub enum X11Window {}

impl X11Window {
    pub fn open(_: &NativeWindow) -> Result<Option<Self>> {
        Ok(None)
    }

    pub fn handles(&self) -> Handles {
        match *self {}
    }

    pub fn size(&self) -> Option<[u32; 2]> {
        match *self {}
    }

    pub fn depth(&self) -> u8 {
        match *self {}
    }

    pub fn drop_errors(&self) {
        match *self {}
    }

    pub fn claim_key(&self) -> claim::Key {
        match *self {}
    }
}

/// There is none.
pub enum FramePacer {}

impl FramePacer {
    /// Errors: UNSUPPORTED.
    pub fn new(_: NonNull<c_void>, _: NonNull<c_void>) -> Result<Self> {
        Err(Error::unsupported("there is no Wayland here"))
    }
}

impl Pacer for FramePacer {
    fn wait(&mut self) -> Result<bool> {
        match *self {}
    }

    fn ask(&mut self) -> Result<()> {
        match *self {}
    }

    fn forget(&mut self) {
        match *self {}
    }
}
