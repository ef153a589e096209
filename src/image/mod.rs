// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pixels in memory and in files: formats, strides, and reading and writing image files; and tables of colours. Knows
//! neither scenes nor tracers.

mod copiers;
mod pixel_format;
pub mod memory;
pub(crate) mod primaries;
mod colour_space;
mod kept;
pub mod rgb9e5;
pub mod bc6h;
mod lut;
pub mod file;

pub use colour_space::ColourSpace;
pub use copiers::Copiers;
pub use file::{
    Alpha, Attribute, BlockFile, Channels, Effort, Layer, Loaded, Pixels, Values, load, load_blocks, load_text, probe,
    save, save_blocks, save_layers, save_text,
};
#[cfg(feature = "exr")]
pub use file::{load_channels, save_channels};
pub use kept::{FromFile, KeptFile};
pub use lut::{Lut, LutFile};
pub use memory::{ImageMut, ImageRef, Layout, MAX_SIDE, PixelFormat};
