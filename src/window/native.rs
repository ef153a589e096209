// SPDX-License-Identifier: MIT OR Apache-2.0
//! A host's window by its platform's handles, and the raw-window-handle that stands for it. Follows no handle, except
//! that it asks Windows for the HINSTANCE of a window whose host gave none.

use super::claim;
use crate::error::{Error, Result};
use crate::platform::{self, SYSTEM, System};
use raw_window_handle as rwh;
use std::ffi::c_void;
use std::num::{NonZeroIsize, NonZeroU32};
use std::ptr::NonNull;

/// Handles as in the raw-window-handle crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NativeWindow {
    /// X11 through Xlib: `Display *`, `Window`.
    Xlib { display: NonNull<c_void>, window: u64, visual: u64, screen: i32 },
    /// X11 through XCB: `xcb_connection_t *`, `xcb_window_t`.
    Xcb { connection: NonNull<c_void>, window: NonZeroU32, visual: Option<NonZeroU32>, screen: i32 },
    /// `wl_display *`, `wl_surface *`.
    Wayland { display: NonNull<c_void>, surface: NonNull<c_void> },
    /// `HWND`, `HINSTANCE`; if the latter is absent, Windows is asked for the window's own.
    Win32 { hwnd: NonZeroIsize, hinstance: Option<NonZeroIsize> },
    /// `NSView *`.
    AppKit { view: NonNull<c_void> },
    /// `UIView *`.
    UiKit { view: NonNull<c_void> },
    /// `CAMetalLayer *`.
    MetalLayer { layer: NonNull<c_void> },
    /// `ANativeWindow *`.
    Android { window: NonNull<c_void> },
}

// SAFETY: the handles are only handed on; the header tells the host which platforms want which thread.
unsafe impl Send for NativeWindow {}
// SAFETY: as above.
unsafe impl Sync for NativeWindow {}

/// The handle that a window is presented through.
#[derive(Clone, Copy, Debug)]
pub enum Handles {
    Raw(rwh::RawDisplayHandle, rwh::RawWindowHandle),
    /// A `CAMetalLayer *`, which raw-window-handle has no kind for.
    MetalLayer(NonNull<c_void>),
}

impl NativeWindow {
    /// The name in `BHR_WINDOW_*`.
    fn kind(&self) -> &'static str {
        match self {
            Self::Xlib { .. } => "XLIB",
            Self::Xcb { .. } => "XCB",
            Self::Wayland { .. } => "WAYLAND",
            Self::Win32 { .. } => "WIN32",
            Self::AppKit { .. } => "APPKIT",
            Self::UiKit { .. } => "UIKIT",
            Self::MetalLayer { .. } => "METAL_LAYER",
            Self::Android { .. } => "ANDROID",
        }
    }

    /// Errors: UNSUPPORTED for a kind that this platform does not have, for all without the feature `window`.
    pub fn check_platform(&self) -> Result<()> {
        if !cfg!(feature = "window") {
            return Err(Error::unsupported("this library was built without windows (cargo feature `window`)"));
        }
        let here = match self {
            Self::Xlib { .. } | Self::Xcb { .. } | Self::Wayland { .. } => SYSTEM == System::FreeDesktop,
            Self::Win32 { .. } => SYSTEM == System::Windows,
            Self::AppKit { .. } => SYSTEM == System::MacOs,
            Self::UiKit { .. } => SYSTEM == System::Ios,
            Self::MetalLayer { .. } => SYSTEM.is_apples(),
            Self::Android { .. } => SYSTEM == System::Android,
        };
        if here {
            return Ok(());
        }
        let platform = std::env::consts::OS;
        Err(Error::unsupported(format!("window kind is BHR_WINDOW_{}; {platform} has no such windows", self.kind())))
    }

    /// The window as the raw-window-handle crate describes it.
    pub fn handles(&self) -> Handles {
        match *self {
            Self::Xlib { display, window, visual, screen } => {
                let mut handle = rwh::XlibWindowHandle::new(window as _);
                handle.visual_id = visual as _;
                Handles::Raw(rwh::XlibDisplayHandle::new(Some(display), screen).into(), handle.into())
            }
            Self::Xcb { connection, window, visual, screen } => {
                let mut handle = rwh::XcbWindowHandle::new(window);
                handle.visual_id = visual;
                Handles::Raw(rwh::XcbDisplayHandle::new(Some(connection), screen).into(), handle.into())
            }
            Self::Wayland { display, surface } => Handles::Raw(
                rwh::WaylandDisplayHandle::new(display).into(),
                rwh::WaylandWindowHandle::new(surface).into(),
            ),
            Self::Win32 { hwnd, hinstance } => {
                let mut handle = rwh::Win32WindowHandle::new(hwnd);
                // Vulkan presents to no window without one.
                handle.hinstance = hinstance.or_else(|| platform::program_of_window(hwnd));
                Handles::Raw(rwh::WindowsDisplayHandle::new().into(), handle.into())
            }
            Self::AppKit { view } => {
                Handles::Raw(rwh::AppKitDisplayHandle::new().into(), rwh::AppKitWindowHandle::new(view).into())
            }
            Self::UiKit { view } => {
                Handles::Raw(rwh::UiKitDisplayHandle::new().into(), rwh::UiKitWindowHandle::new(view).into())
            }
            Self::MetalLayer { layer } => Handles::MetalLayer(layer),
            Self::Android { window } => {
                Handles::Raw(rwh::AndroidDisplayHandle::new().into(), rwh::AndroidNdkWindowHandle::new(window).into())
            }
        }
    }

    pub(super) fn claim_key(&self) -> claim::Key {
        let number = match *self {
            Self::Xlib { window, .. } => window,
            Self::Xcb { window, .. } => window.get().into(),
            Self::Win32 { hwnd, .. } => hwnd.get() as u64,
            Self::Wayland { surface: pointer, .. }
            | Self::AppKit { view: pointer }
            | Self::UiKit { view: pointer }
            | Self::MetalLayer { layer: pointer }
            | Self::Android { window: pointer } => pointer.addr().get() as u64,
        };
        (self.kind().to_owned(), number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rwh::{RawDisplayHandle, RawWindowHandle};

    fn pointer(address: usize) -> NonNull<c_void> {
        NonNull::new(std::ptr::without_provenance_mut(address)).unwrap()
    }

    fn all() -> [NativeWindow; 8] {
        let (id, hwnd) = (NonZeroU32::new(0x20).unwrap(), NonZeroIsize::new(-0x30).unwrap());
        [
            NativeWindow::Xlib { display: pointer(0x10), window: 0x24, visual: 0x21, screen: 3 },
            NativeWindow::Xcb { connection: pointer(0x11), window: id, visual: NonZeroU32::new(0x22), screen: 4 },
            NativeWindow::Wayland { display: pointer(0x12), surface: pointer(0x23) },
            NativeWindow::Win32 { hwnd, hinstance: NonZeroIsize::new(0x31) },
            NativeWindow::AppKit { view: pointer(0x40) },
            NativeWindow::UiKit { view: pointer(0x50) },
            NativeWindow::MetalLayer { layer: pointer(0x60) },
            NativeWindow::Android { window: pointer(0x70) },
        ]
    }

    #[test]
    fn every_kind_becomes_its_raw_window_handle() {
        let [xlib, xcb, wayland, win32, appkit, uikit, layer, android] = all().map(|window| window.handles());
        // An XID has 32 bits, in a C long.
        assert!(matches!(xlib, Handles::Raw(RawDisplayHandle::Xlib(d), RawWindowHandle::Xlib(w))
            if d.display == Some(pointer(0x10)) && d.screen == 3 && w.window == 0x24 && w.visual_id == 0x21));
        assert!(matches!(xcb, Handles::Raw(RawDisplayHandle::Xcb(d), RawWindowHandle::Xcb(w))
            if d.connection == Some(pointer(0x11)) && d.screen == 4 && w.window.get() == 0x20
                && w.visual_id.unwrap().get() == 0x22));
        assert!(matches!(wayland, Handles::Raw(RawDisplayHandle::Wayland(d), RawWindowHandle::Wayland(w))
            if d.display == pointer(0x12) && w.surface == pointer(0x23)));
        assert!(matches!(win32, Handles::Raw(RawDisplayHandle::Windows(_), RawWindowHandle::Win32(w))
            if w.hwnd.get() == -0x30 && w.hinstance.unwrap().get() == 0x31));
        assert!(matches!(appkit, Handles::Raw(RawDisplayHandle::AppKit(_), RawWindowHandle::AppKit(w))
            if w.ns_view == pointer(0x40)));
        assert!(matches!(uikit, Handles::Raw(RawDisplayHandle::UiKit(_), RawWindowHandle::UiKit(w))
            if w.ui_view == pointer(0x50) && w.ui_view_controller.is_none()));
        assert!(matches!(layer, Handles::MetalLayer(l) if l == pointer(0x60)));
        assert!(matches!(android, Handles::Raw(RawDisplayHandle::Android(_), RawWindowHandle::AndroidNdk(w))
            if w.a_native_window == pointer(0x70)));
    }

    #[cfg(feature = "window")]
    #[test]
    fn kinds_of_other_platforms_are_refused_by_name() {
        let refused = all().iter().filter_map(|window| window.check_platform().err()).collect::<Vec<_>>();
        // Each platform has one to three of the eight kinds.
        assert!((5..8).contains(&refused.len()));
        assert!(refused.iter().all(|e| e.message.contains("BHR_WINDOW_")), "{refused:?}");
    }
}
