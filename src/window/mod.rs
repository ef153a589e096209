// SPDX-License-Identifier: MIT OR Apache-2.0
//! Windows of the host, as their platforms know them: handles, sizes, pacing, and frames put there as memory. Hosts'
//! handles come in as a [`NativeWindow`]; nothing here knows C, a GPU, or what a frame shows. Without the cargo feature
//! `window` every window is UNSUPPORTED.

pub(crate) mod claim;
mod native;
#[cfg_attr(
    not(all(feature = "window", unix, not(target_vendor = "apple"), not(target_os = "android"))),
    path = "free_desktop_absent.rs"
)]
mod free_desktop;
#[cfg_attr(not(feature = "window"), path = "memory_absent.rs")]
pub(crate) mod memory;

pub use native::{Handles, NativeWindow};

use crate::error::{Error, Result};
use crate::platform;
use free_desktop::{FramePacer, X11Window};

/// How frames reach the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PresentMode {
    /// Frames wait for the display, and are never torn.
    Vsync,
    /// Frames are shown at once, and may tear.
    Immediate,
    /// The newest frame is shown at the display's rate.
    Mailbox,
}

/// Tells when a window takes its next frame, for windows whose VSYNC is not left to the driver.
pub trait Pacer: Send {
    /// Waits until the window takes a frame, a second at most; whether it does. Errors: SURFACE_LOST.
    fn wait(&mut self) -> Result<bool>;
    /// Asks to be told when the window takes the frame after the one that is presented next. Errors: SURFACE_LOST.
    fn ask(&mut self) -> Result<()>;
    /// Called when the request may have been lost: the next frame need not wait.
    fn forget(&mut self);
}

/// A window of the host's that was looked at and found there, with what it takes to present to it.
pub struct Window {
    native: NativeWindow,
    x11: Option<X11Window>,
}

impl Window {
    /// Errors: INVALID_ARGUMENT for a window that is not there; UNSUPPORTED for a kind that this platform does not
    /// have, for all without the feature `window`.
    pub fn open(native: NativeWindow) -> Result<Self> {
        native.check_platform()?;
        if let NativeWindow::Win32 { hwnd, .. } = native
            && !platform::window_exists(hwnd)
        {
            return Err(Error::argument(format!("window handle is {hwnd:#x}; Windows has no such window")));
        }
        Ok(Self { native, x11: X11Window::open(&native)? })
    }

    /// The handle to present through.
    pub fn handles(&self) -> Handles {
        self.x11.as_ref().map_or_else(|| self.native.handles(), |window| window.handles())
    }

    /// Whether it is still there, as far as this platform tells.
    pub fn exists(&self) -> bool {
        !self.is_gone() && self.x11.as_ref().is_none_or(|window| window.size().is_some())
    }

    /// Whether the window is gone, as far as that can be told without asking a server; always false but on Windows. It
    /// has to be asked there, as drivers may go on taking frames for a destroyed window.
    pub fn is_gone(&self) -> bool {
        matches!(self.native, NativeWindow::Win32 { hwnd, .. } if !platform::window_exists(hwnd))
    }

    /// Its size in pixels, where the platform knows it: X11.
    pub fn size(&self) -> Option<[u32; 2]> {
        self.x11.as_ref().and_then(|window| window.size())
    }

    /// Bits of a pixel that count, where the platform knows them: X11.
    pub fn depth(&self) -> Option<u8> {
        self.x11.as_ref().map(|window| window.depth())
    }

    /// The complaints of the window's server about frames that nobody waited for.
    pub(crate) fn drop_errors(&self) {
        if let Some(window) = &self.x11 {
            window.drop_errors();
        }
    }

    /// `None`: the driver's VSYNC is good enough. Errors: UNSUPPORTED when the window needs one and cannot have it.
    pub fn pacer(&self) -> Result<Option<Box<dyn Pacer>>> {
        match self.native {
            NativeWindow::Wayland { display, surface } => {
                FramePacer::new(display, surface).map(|pacer| Some(Box::new(pacer) as Box<dyn Pacer>))
            }
            _ => Ok(None),
        }
    }

    pub(crate) fn claim_key(&self) -> claim::Key {
        self.x11.as_ref().map_or_else(|| self.native.claim_key(), |window| window.claim_key())
    }
}
