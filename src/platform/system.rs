// SPDX-License-Identifier: MIT OR Apache-2.0
//! The system that the library was built for, where it must be told from others by its name.

/// Systems, as their windows and drivers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// Linux, and others whose windows are those of X11 and Wayland.
    FreeDesktop,
    Windows,
    MacOs,
    /// iOS.
    Ios,
    /// Apple's others.
    Apple,
    Android,
    /// A web page.
    Page,
    Other,
}

/// The one that this is.
pub const SYSTEM: System = if cfg!(target_os = "android") {
    System::Android
} else if cfg!(target_os = "macos") {
    System::MacOs
} else if cfg!(target_os = "ios") {
    System::Ios
} else if cfg!(target_vendor = "apple") {
    System::Apple
} else if cfg!(unix) {
    System::FreeDesktop
} else if cfg!(windows) {
    System::Windows
} else if cfg!(target_arch = "wasm32") {
    System::Page
} else {
    System::Other
};

impl System {
    /// Whether it is one of Apple's.
    pub const fn is_apples(self) -> bool {
        matches!(self, Self::MacOs | Self::Ios | Self::Apple)
    }
}
