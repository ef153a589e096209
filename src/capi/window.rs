// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrWindow: a window of the host's, as the raw-window-handle crate describes it. Its fields are read and checked
//! here; nothing behind its pointers is touched.

use super::entry::anywhere;
use super::pointer::{check_reserved, unknown};
use super::status::BhrStatus;
use super::versioned::{self, Versioned, pointers_before_u64};
use crate::error::{Error, Result};
use crate::window::NativeWindow;
use std::ffi::c_void;
use std::num::{NonZeroIsize, NonZeroU32};
use std::ptr::{NonNull, null_mut};

/// The kind of a BhrWindow. It decides which fields are read; the others are ignored.
pub type BhrWindowKind = i32;
/// X11 through Xlib: display = Display *, id = Window.
pub const BHR_WINDOW_XLIB: BhrWindowKind = 1;
/// X11 through XCB: display = xcb_connection_t *, id = xcb_window_t.
pub const BHR_WINDOW_XCB: BhrWindowKind = 2;
/// Wayland: display = wl_display *, handle = wl_surface *.
pub const BHR_WINDOW_WAYLAND: BhrWindowKind = 3;
/// Windows: handle = HWND, aux = HINSTANCE; NULL: the window's own.
pub const BHR_WINDOW_WIN32: BhrWindowKind = 4;
/// macOS: handle = NSView *.
pub const BHR_WINDOW_APPKIT: BhrWindowKind = 5;
/// iOS: handle = UIView *.
pub const BHR_WINDOW_UIKIT: BhrWindowKind = 6;
/// macOS, iOS: handle = CAMetalLayer *.
pub const BHR_WINDOW_METAL_LAYER: BhrWindowKind = 7;
/// Android: handle = ANativeWindow *.
pub const BHR_WINDOW_ANDROID: BhrWindowKind = 8;

/// The constant of a kind that is listed above.
fn kind_name(kind: BhrWindowKind) -> &'static str {
    match kind {
        BHR_WINDOW_XLIB => "BHR_WINDOW_XLIB",
        BHR_WINDOW_XCB => "BHR_WINDOW_XCB",
        BHR_WINDOW_WAYLAND => "BHR_WINDOW_WAYLAND",
        BHR_WINDOW_WIN32 => "BHR_WINDOW_WIN32",
        BHR_WINDOW_APPKIT => "BHR_WINDOW_APPKIT",
        BHR_WINDOW_UIKIT => "BHR_WINDOW_UIKIT",
        BHR_WINDOW_METAL_LAYER => "BHR_WINDOW_METAL_LAYER",
        BHR_WINDOW_ANDROID => "BHR_WINDOW_ANDROID",
        _ => "no BHR_WINDOW constant",
    }
}

/// A window of the host's. It stays the host's, and it and its display must outlive every surface made from it.
/// Begin with bhr_window_init, or with all bytes 0 and struct_size, then set kind and what the kind names. Handles
/// are those of the raw-window-handle crate.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrWindow {
    /// sizeof(BhrWindow).
    pub struct_size: u32,
    /// BHR_WINDOW_*.
    pub kind: BhrWindowKind,
    /// The connection to the display, where the kind has one.
    pub display: *mut c_void,
    /// The window, view, layer or surface, where the kind has a pointer to it.
    pub handle: *mut c_void,
    /// A second pointer, for Windows only.
    pub aux: *mut c_void,
    /// X11: the id of the window.
    pub id: u64,
    /// X11: the id of the window's visual; may be 0.
    pub visual_id: u64,
    /// X11: the number of the window's screen; may be 0.
    pub screen: i32,
    /// Reserved: 0.
    pub reserved: u32,
}

// SAFETY: repr(C), size first, no padding but behind the pointers, integers and nullable pointers.
unsafe impl Versioned for BhrWindow {
    const NAME: &'static str = "BhrWindow";
    const SIZES: &'static [usize] = &[32 + pointers_before_u64(3)];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            kind: 0,
            display: null_mut(),
            handle: null_mut(),
            aux: null_mut(),
            id: 0,
            visual_id: 0,
            screen: 0,
            reserved: 0,
        }
    }
}

/// Sets struct_size and clears the rest: kind and handles have no defaults. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_window_init(window: *mut BhrWindow, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_window_init", || unsafe { versioned::init(window, "window", struct_size) })
}

/// The host's window, checked. Errors: INVALID_ARGUMENT for NULL, an unknown kind, or a field its kind needs and
/// that is 0.
///
/// # Safety
/// `window` is NULL or points to a BhrWindow.
pub(super) unsafe fn read(window: *const BhrWindow, name: &str) -> Result<NativeWindow> {
    // SAFETY: this function's contract.
    let given = unsafe { versioned::read(window, name) }?;
    check_reserved(given.reserved, name)?;
    let needed = |field: &str, value: &str| {
        let kind = kind_name(given.kind);
        Error::argument(format!("{name} {field} is {value}; windows of kind {kind} need it"))
    };
    let display = || NonNull::new(given.display).ok_or_else(|| needed("display", "NULL"));
    let handle = || NonNull::new(given.handle).ok_or_else(|| needed("handle", "NULL"));
    let xcb_id = |field: &str, value: u64| {
        u32::try_from(value).map_err(|_| Error::argument(format!("{name} {field} is {value:#x}; XCB's have 32 bits")))
    };
    Ok(match given.kind {
        BHR_WINDOW_XLIB => {
            let display = display()?;
            let window = Some(given.id).filter(|id| *id != 0).ok_or_else(|| needed("id", "0"))?;
            NativeWindow::Xlib { display, window, visual: given.visual_id, screen: given.screen }
        }
        BHR_WINDOW_XCB => {
            let connection = display()?;
            let window = NonZeroU32::new(xcb_id("id", given.id)?).ok_or_else(|| needed("id", "0"))?;
            let visual = NonZeroU32::new(xcb_id("visual_id", given.visual_id)?);
            NativeWindow::Xcb { connection, window, visual, screen: given.screen }
        }
        BHR_WINDOW_WAYLAND => NativeWindow::Wayland { display: display()?, surface: handle()? },
        BHR_WINDOW_WIN32 => NativeWindow::Win32 {
            hwnd: NonZeroIsize::new(given.handle.addr() as isize).ok_or_else(|| needed("handle", "NULL"))?,
            hinstance: NonZeroIsize::new(given.aux.addr() as isize),
        },
        BHR_WINDOW_APPKIT => NativeWindow::AppKit { view: handle()? },
        BHR_WINDOW_UIKIT => NativeWindow::UiKit { view: handle()? },
        BHR_WINDOW_METAL_LAYER => NativeWindow::MetalLayer { layer: handle()? },
        BHR_WINDOW_ANDROID => NativeWindow::Android { window: handle()? },
        kind => return unknown(kind, &format!("{name} kind"), "BHR_WINDOW_XLIB (1) to BHR_WINDOW_ANDROID (8)"),
    })
}
