// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames into a window as plain memory, where no GPU device can present to it: by XCB to X11 windows, by the
//! softbuffer crate to others. (Softbuffer's own X11 loads Xlib into every process that loads bhr, and sets Xlib's
//! error handler.)

use super::native::Handles;
use super::{Window, native::NativeWindow};
use crate::error::{Error, ErrorKind, Result};
use raw_window_handle as rwh;
use std::num::NonZeroU32;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The longest side of such a window, in which X11's requests have 16 bits for coordinates.
pub const MAX_SIDE: u32 = i16::MAX as u32;
/// The most pixels of such a window: softbuffer counts the bytes of two frames in an i32.
pub const MAX_PIXELS: u64 = 1 << 28;

/// A window that takes frames as memory.
pub enum MemoryWindow {
    #[cfg(all(unix, not(target_vendor = "apple"), not(target_os = "android")))]
    X11(x11::Painter),
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
        #[cfg(all(unix, not(target_vendor = "apple"), not(target_os = "android")))]
        if let Some(window) = &window.x11 {
            return x11::Painter::new(window).map(Self::X11);
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
    #[cfg_attr(
        not(all(unix, not(target_vendor = "apple"), not(target_os = "android"))),
        expect(unused_variables, reason = "softbuffer's surface knows its window")
    )]
    pub fn present(&mut self, window: &Window, size: [u32; 2], pixels: &[u8]) -> Result<()> {
        match self {
            #[cfg(all(unix, not(target_vendor = "apple"), not(target_os = "android")))]
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

#[cfg(all(unix, not(target_vendor = "apple"), not(target_os = "android")))]
mod x11 {
    use super::super::visual::PixelForm;
    use super::super::x11::X11Window;
    use super::{lost, unsupported};
    use crate::allocate::reserve;
    use crate::error::Result;
    use x11rb::connection::{Connection, RequestConnection};
    use x11rb::protocol::xproto::{ConnectionExt, CreateGCAux, Gcontext, ImageFormat};

    /// The bytes of a PutImage request before its pixels.
    const HEAD: usize = 64;

    /// Puts images into a window.
    pub struct Painter {
        context: Gcontext,
        form: PixelForm,
        /// The rows of a request, where the window's pixels have another form than those of frames.
        rows: Vec<u8>,
    }

    impl Painter {
        pub fn new(window: &X11Window) -> Result<Self> {
            let connection = window.connection();
            let asked = connection.get_window_attributes(window.id()).map_err(unsupported)?;
            let visual = asked.reply().map_err(unsupported)?.visual;
            let form = PixelForm::new(connection.setup(), window.depth, visual).map_err(unsupported)?;
            let context = connection.generate_id().map_err(unsupported)?;
            let created = connection.create_gc(context, window.id(), &CreateGCAux::new().graphics_exposures(0));
            created.map_err(unsupported)?.check().map_err(unsupported)?;
            Ok(Self { context, form, rows: Vec::new() })
        }

        /// Waits until the server has it. Errors: SURFACE_LOST; OUT_OF_MEMORY.
        pub fn put(&mut self, window: &X11Window, [width, height]: [u32; 2], pixels: &[u8]) -> Result<()> {
            let connection = window.connection();
            let (row, put_row) = (width as usize * 4, self.form.row_bytes(width as usize));
            let rows = connection.maximum_request_bytes().saturating_sub(HEAD) / put_row.max(1);
            let rows = rows.clamp(1, height as usize);
            let mut last = None;
            for (piece, y) in pixels.chunks(row * rows).zip((0..).step_by(rows)) {
                let lines = piece.len() / row;
                if !self.form.is_bgra() {
                    self.rows.clear();
                    reserve(&mut self.rows, put_row * lines, "a window's pixels")?;
                    self.rows.resize(put_row * lines, 0);
                    for (bgra, out) in piece.chunks_exact(row).zip(self.rows.chunks_exact_mut(put_row)) {
                        self.form.write_row(bgra, out);
                    }
                }
                let put = connection.put_image(
                    ImageFormat::Z_PIXMAP,
                    window.id(),
                    self.context,
                    width as u16,
                    lines as u16,
                    0,
                    y,
                    0,
                    window.depth,
                    if self.form.is_bgra() { piece } else { &self.rows },
                );
                last = Some(put.map_err(lost)?);
            }
            let Some(last) = last else { return Ok(()) };
            let checked = last.check().map_err(lost);
            window.drop_errors();
            checked
        }
    }
}
