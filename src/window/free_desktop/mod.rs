// SPDX-License-Identifier: MIT OR Apache-2.0
//! Windows of X11 and of Wayland, where systems have those.

mod visual;
mod wayland;
mod x11;

pub use visual::PixelForm;
pub use wayland::FramePacer;
pub use x11::X11Window;
