// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames into a window as plain memory, where no GPU device can present to it: by XCB to X11 windows, by the
//! softbuffer crate to others. (Softbuffer's own X11 loads Xlib into every process that loads bhr, and sets Xlib's
//! error handler.)

#[cfg_attr(not(all(unix, not(target_vendor = "apple"), not(target_os = "android"))), path = "memory/painter_absent.rs")]
mod painter;

use super::native::Handles;
use super::{Window, native::NativeWindow};
use crate::error::{Error, ErrorKind, Result};
use painter::Painter;
use raw_window_handle as rwh;
use std::num::NonZeroU32;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The longest side of such a window, in which X11's requests have 16 bits for coordinates.
pub const MAX_SIDE: u32 = i16::MAX as u32;
/// The most pixels of such a window: softbuffer counts the bytes of two frames in an i32.
pub const MAX_PIXELS: u64 = 1 << 28;

/// A window that takes frames as memory.
pub enum MemoryWindow {
    X11(Painter),
    Other(Box<softbuffer::Surface<Shared, Shared>>),
}

/// Handles that the owner of the [`MemoryWindow`] keeps valid.
#[derive(Clone, Copy)]
pub struct Shared {
    display: rwh::RawDisplayHandle,
    window: rwh::RawWindowHandle,
}

// SAFETY: the handles are only handed on; the header tells the host which platforms want which thread.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

impl rwh::HasDisplayHandle for Shared {
    fn display_handle(&self) -> Result<rwh::DisplayHandle<'_>, rwh::HandleError> {
        // SAFETY: the host keeps its window and display until the surface ends.
        Ok(unsafe { rwh::DisplayHandle::borrow_raw(self.display) })
    }
}

impl rwh::HasWindowHandle for Shared {
    fn window_handle(&self) -> Result<rwh::WindowHandle<'_>, rwh::HandleError> {
        // SAFETY: as above.
        Ok(unsafe { rwh::WindowHandle::borrow_raw(self.window) })
    }
}

fn unsupported(error: impl std::fmt::Display) -> Error {
    Error::unsupported(format!("the window takes no frames as memory: {error}"))
}

fn lost(error: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::SurfaceLost, format!("the window took no frame: {error}"))
}

impl MemoryWindow {
    /// Errors: UNSUPPORTED, with the platform's reason.
    pub fn new(window: &Window) -> Result<Self> {
        if let Some(window) = &window.x11 {
            return Painter::new(window).map(Self::X11);
        }
        if matches!(window.native, NativeWindow::Android { .. } | NativeWindow::UiKit { .. }) {
            return Err(unsupported("not on this platform"));
        }
        let Handles::Raw(display, window) = window.handles() else { return Err(unsupported("it is a bare layer")) };
        let shared = Shared { display, window };
        let made = catch_unwind(|| {
            let context = softbuffer::Context::new(shared).map_err(unsupported)?;
            softbuffer::Surface::new(&context, shared).map_err(unsupported)
        });
        let surface = made.map_err(|_| unsupported("the softbuffer crate gave up"))??;
        Ok(Self::Other(Box::new(surface)))
    }

    /// Shows `pixels`, rows of `size` BGRA pixels without gaps, from the window's top left corner. Errors:
    /// SURFACE_LOST.
    pub fn present(&mut self, window: &Window, size: [u32; 2], pixels: &[u8]) -> Result<()> {
        match self {
            Self::X11(painter) => match &window.x11 {
                Some(window) => painter.put(window, size, pixels),
                None => Err(Error::internal("an X11 painter on another window")),
            },
            Self::Other(surface) => {
                let [Some(width), Some(height)] = size.map(NonZeroU32::new) else { return Ok(()) };
                // This is unwind safe: a window that failed is not used again.
                let put = catch_unwind(AssertUnwindSafe(|| {
                    surface.resize(width, height).map_err(lost)?;
                    let mut buffer = surface.buffer_mut().map_err(lost)?;
                    for (out, pixel) in buffer.iter_mut().zip(pixels.as_chunks::<4>().0) {
                        // Blue, green, red, and a byte that is zero.
                        *out = u32::from_le_bytes(*pixel) & 0xff_ffff;
                    }
                    buffer.present().map_err(lost)
                }));
                // Softbuffer panics without descriptors, memory, or a connection.
                put.unwrap_or_else(|_| Err(lost("the softbuffer crate gave up")))
            }
        }
    }
}
