//! Pixels in memory and in files: formats, strides, and reading and writing image files. Knows neither scenes nor tracers.

pub mod file;
pub mod memory;

pub use memory::{ImageMut, ImageRef, PixelFormat};
