//! BhrSurface: rendering into a window of the host's. This version has none: arguments are checked, then the answer
//! is UNSUPPORTED.

use super::context::BhrContext;
use super::entry::{on_context, outside_callbacks};
use super::pointer::{Out, is_null, unknown};
use super::status::BhrStatus;
use super::window::{self, BhrWindow};
use crate::error::{Error, Result};
use crate::image::MAX_SIDE;

/// A window that a context renders into.
pub struct BhrSurface {
    _none: (),
}

/// How frames reach the screen.
pub type BhrPresentMode = i32;
/// At the display's rate, never torn.
pub const BHR_PRESENT_VSYNC: BhrPresentMode = 0;
/// At once; may tear.
pub const BHR_PRESENT_IMMEDIATE: BhrPresentMode = 1;
/// The newest frame at the display's rate; older ones are dropped.
pub const BHR_PRESENT_MAILBOX: BhrPresentMode = 2;

fn check_mode(mode: BhrPresentMode) -> Result<()> {
    match mode {
        BHR_PRESENT_VSYNC | BHR_PRESENT_IMMEDIATE | BHR_PRESENT_MAILBOX => Ok(()),
        _ => unknown(mode, "mode", "BHR_PRESENT_VSYNC (0), _IMMEDIATE (1), _MAILBOX (2)"),
    }
}

fn check_size(width: u32, height: u32) -> Result<()> {
    // 0 x 0 is a minimised window.
    if width <= MAX_SIDE && height <= MAX_SIDE {
        return Ok(());
    }
    Err(Error::argument(format!("surface size is {width} x {height}; each side must lie in [0, {MAX_SIDE}]")))
}

fn no_surfaces() -> Result<()> {
    Err(Error::unsupported("this version has no windows; bhr_render_image renders into memory"))
}

/// A call on a surface. None exists, so past the argument checks there is one answer.
fn on_surface(function: &str, surface: *const BhrSurface, check: impl FnOnce() -> Result<()>) -> BhrStatus {
    outside_callbacks(function, || {
        if surface.is_null() {
            return Err(is_null("surface"));
        }
        check()?;
        no_surfaces()
    })
}

/// Makes a surface of width x height pixels from a window. macOS: on the main thread only. Errors: INVALID_ARGUMENT
/// for NULL, a bad window, an unknown mode; UNSUPPORTED otherwise in this version.
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
        on_context("bhr_surface_create", context, |_state| {
            out.required("out_surface")?;
            window::read(window, "window")?;
            check_size(width, height)?;
            check_mode(mode)?;
            no_surfaces()
        })
    }
}

/// Follows a window's new size in pixels; 0 x 0: minimised. Errors: INVALID_ARGUMENT for NULL; UNSUPPORTED
/// otherwise in this version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_resize(surface: *mut BhrSurface, width: u32, height: u32) -> BhrStatus {
    on_surface("bhr_surface_resize", surface, || check_size(width, height))
}

/// Changes how frames reach the screen; a mode that the window does not have falls back to VSYNC. Errors:
/// INVALID_ARGUMENT for NULL or an unknown mode; UNSUPPORTED otherwise in this version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_set_present_mode(surface: *mut BhrSurface, mode: BhrPresentMode) -> BhrStatus {
    on_surface("bhr_surface_set_present_mode", surface, || check_mode(mode))
}

/// Renders the scene into the surface's window and presents it. Errors: INVALID_ARGUMENT for NULL; UNSUPPORTED
/// otherwise in this version.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_render_surface(context: *mut BhrContext, surface: *mut BhrSurface) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_render_surface", context, |_state| {
            if surface.is_null() {
                return Err(is_null("surface"));
            }
            no_surfaces()
        })
    }
}

/// Ends a surface; the window stays the host's. NULL is a no-op, and any destroy order is safe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_surface_destroy(surface: *mut BhrSurface) {
    let _ = surface;
}
