// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames into X11 windows by XCB.

use super::{lost, unsupported};
use crate::allocate::reserve;
use crate::error::Result;
use crate::window::free_desktop::{PixelForm, X11Window};
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
        let form = PixelForm::new(connection.setup(), window.depth(), visual).map_err(unsupported)?;
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
                window.depth(),
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
