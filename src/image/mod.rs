// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pixels in memory and in files: formats, strides, and reading and writing image files. Knows neither scenes nor
//! tracers.

mod copiers;
pub mod memory;
pub mod file;

pub use copiers::Copiers;
pub use file::{Alpha, Attribute, Effort, Layer, Loaded, Pixels, load, load_text, probe, save, save_layers, save_text};
pub use memory::{ImageMut, ImageRef, Layout, MAX_SIDE, PixelFormat};
