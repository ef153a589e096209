// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrSurface: rendering into a window of the host's. One `Surface`, shared with its context, which may go first.

use super::call::{keep, on_context};
use super::context::BhrContext;
use super::entry::{SuccessStatus, destroy, give_back, outside_callbacks};
use super::log::{self, Sink};
use super::message::LastMessage;
use super::pointer::{Out, is_null, unknown};
use super::status::{BHR_FRAME_SKIPPED, BHR_OK, BhrStatus};
use super::window::{self, BhrWindow};
use crate::error::{Error, Result};
use crate::image::MAX_SIDE;
use crate::surface::{ShowOutcome, Surface};
use crate::window::PresentMode;
use std::sync::Arc;

/// A window that a context renders into. It belongs to that context; end it with bhr_surface_destroy, before or
/// after the context, before the window.
pub struct BhrSurface {
    surface: Arc<Surface>,
    sink: Option<Arc<Sink>>,
    /// The context's.
    message: Arc<LastMessage>,
}

/// How frames reach the screen.
pub type BhrPresentMode = i32;
/// Never torn: a frame waits for the display. Every window has this mode.
pub const BHR_PRESENT_VSYNC: BhrPresentMode = 0;
/// Frames are shown at once, and may tear.
pub const BHR_PRESENT_IMMEDIATE: BhrPresentMode = 1;
/// Never torn: the newest frame at the display's rate; older ones are dropped.
pub const BHR_PRESENT_MAILBOX: BhrPresentMode = 2;

fn present_mode(mode: BhrPresentMode) -> Result<PresentMode> {
    Ok(match mode {
        BHR_PRESENT_VSYNC => PresentMode::Vsync,
        BHR_PRESENT_IMMEDIATE => PresentMode::Immediate,
        BHR_PRESENT_MAILBOX => PresentMode::Mailbox,
        _ => return unknown(mode, "mode", "BHR_PRESENT_VSYNC (0), _IMMEDIATE (1), _MAILBOX (2)"),
    })
}

/// Checks the size of a surface; 0 x 0 is a minimised window.
fn check_size(width: u32, height: u32) -> Result<[u32; 2]> {
    if width <= MAX_SIDE && height <= MAX_SIDE {
        return Ok([width, height]);
    }
    Err(Error::argument(format!("surface size is {width} x {height}; each side must lie in [0, {MAX_SIDE}]")))
}

/// A call on a surface alone: refused inside callbacks, with its context's log callback listening.
///
/// # Safety
/// `surface` is NULL or came from `bhr_surface_create` and is not destroyed.
unsafe fn on_surface(
    function: &str,
    surface: *const BhrSurface,
    body: impl FnOnce(&Surface) -> Result<()>,
) -> BhrStatus {
    // SAFETY: this function's contract.
    let Some(surface) = (unsafe { surface.as_ref() }) else {
        return outside_callbacks::<()>(function, || Err(is_null("surface")));
    };
    let _scope = log::Scope::enter(surface.sink.clone());
    keep(outside_callbacks(function, || body(&surface.surface)), Some(&surface.message))
}

/// Makes a surface of a window, width x height pixels (0 x 0: minimised; else, on X11, the window's own size
/// counts). Call it on the thread that uses the display. A window takes one surface at a time; it and its display
/// must outlive that. Where the context's adapter cannot present to the window, another one does, or frames are put
/// there as memory; the log (info) says which. A host that holds XGrabServer must not call on surfaces. End
/// *out_surface with bhr_surface_destroy. docs/window.md.
/// Errors: INVALID_ARGUMENT for a window that does not exist (X11, Windows), or a side beyond 2^20; INVALID_STATE for a
/// window that has a surface; UNSUPPORTED, with every reason, for a kind of window that this platform or build does
/// not have, where nothing can present, and for sides beyond the device's images (mostly 16384); DEVICE_LOST also
/// for images that do not fit into its memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_create(
    context: *mut BhrContext,
    window: *const BhrWindow,
    width: u32,
    height: u32,
    mode: BhrPresentMode,
    out_surface: *mut *mut BhrSurface,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_surface);
        // Not NULL in the closure: `on_context` has refused that.
        let shared = || context.as_ref().map(|context| (context.sink(), context.message.clone()));
        on_context("bhr_surface_create", context, |state| {
            out.required("out_surface")?;
            let window = window::read(window, "window")?;
            let size = check_size(width, height)?;
            let surface = state.renderer.create_surface(window, size, present_mode(mode)?)?;
            let (sink, message) = shared().ok_or_else(|| is_null("context"))?;
            out.set(Box::into_raw(Box::new(BhrSurface { surface, sink, message })));
            Ok(())
        })
    }
}

/// Tells a surface its window's new size in pixels; 0 x 0: minimised, frames are skipped. Cheap: images of the new
/// size are made by the next frame. X11: frames have the size that the window really has; this call says that it has
/// changed. Wayland: call it also when a window that the host has hidden is shown again; VSYNC frames are skipped
/// until then. Windows: call it on the thread that renders, not on the window's, if these are two: it waits for a
/// frame on its way, which may wait for the window's messages.
/// Errors: INVALID_ARGUMENT for a side beyond 2^20; UNSUPPORTED for one that the device's images cannot have;
/// SURFACE_LOST.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_resize(surface: *mut BhrSurface, width: u32, height: u32) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { on_surface("bhr_surface_resize", surface, |surface| surface.resize(check_size(width, height)?)) }
}

/// Changes how frames reach the screen, from the next one on. A mode that the window does not have becomes VSYNC.
/// Errors: SURFACE_LOST.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_set_present_mode(surface: *mut BhrSurface, mode: BhrPresentMode) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_surface("bhr_surface_set_present_mode", surface, |surface| surface.set_present_mode(present_mode(mode)?))
    }
}

/// Renders the scene into the surface's window and presents it, with the film, in sRGB; the region does not count.
/// The frame is traced at BhrQuality.render_scale times the window's size and stretched to it; a CUBE's faces too,
/// if the window is not 6 times as wide as high. Returns when the frame is on its way to the screen. With VSYNC it
/// first waits until the window takes another frame, at most a second, and so do calls on the context and the
/// surface from other threads. FRAME_SKIPPED: the window is 0 x 0, hidden as far as the platform tells, or being
/// resized: wait for its next event, or try again a little later.
/// Errors: INVALID_ARGUMENT for a surface of another context; INVALID_STATE and UNSUPPORTED as bhr_render_image;
/// SURFACE_LOST, from then on, when the window is gone or the context was recovered: destroy the surface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_surface(context: *mut BhrContext, surface: *mut BhrSurface) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_render_surface", context, |state| {
            let surface = surface.as_ref().ok_or_else(|| is_null("surface"))?;
            Ok(match state.renderer.render_surface(&surface.surface)? {
                ShowOutcome::Presented => SuccessStatus(BHR_OK),
                ShowOutcome::Skipped => SuccessStatus(BHR_FRAME_SKIPPED),
            })
        })
    }
}

/// Ends a surface; the window is free for another one. NULL is a no-op; its context may be gone. No other thread may
/// use the surface any more. From inside a callback it does nothing: bhr_error_message then says so.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_destroy(surface: *mut BhrSurface) {
    const NAME: &str = "bhr_surface_destroy";
    let end = |owned: Box<BhrSurface>| {
        let BhrSurface { surface, sink, .. } = *owned;
        let _scope = log::Scope::enter(sink);
        give_back(NAME, surface, |surface| surface.end("it was destroyed"));
    };
    // SAFETY: bhr_surface_create made it with Box::into_raw, and the host destroys it once.
    unsafe { destroy(NAME, surface, end) }
}
