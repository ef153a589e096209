// SPDX-License-Identifier: MIT OR Apache-2.0
//! Image files: PNG, OpenEXR (cargo feature `exr`), PNM and KTX2. A file appears whole or not at all; a broken one is
//! an error, and what it claims to hold is checked before memory is taken for it. Each kind of file has a module of its
//! own; `support` holds what they share: limits, errors, memory. Decoders and encoders run on a thread of their own:
//! see `support::on_own_thread`.

mod layer;
mod support;
mod loaded;
mod colour;
mod icc;
#[cfg(feature = "exr")]
mod deflate;
#[cfg(feature = "exr")]
mod ordered;
#[cfg(feature = "exr")]
mod layers;
mod replace;
#[cfg(feature = "exr")]
mod exr_channels;
#[cfg(feature = "exr")]
mod exr;
#[cfg(feature = "exr")]
mod exr_values;
mod pam;
mod png_colours;
mod png;
mod pnm;
mod ktx2_header;
mod ktx2;
mod load;
mod save;
mod cube;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod colour_tests;
#[cfg(all(test, feature = "exr"))]
mod layer_tests;

pub use ktx2::BlockFile;
pub use layer::{Alpha, Attribute, Channels, Effort, Layer, Values};
#[cfg(feature = "exr")]
pub use load::load_channels;
pub use load::{decode_png, load, load_blocks, load_text};
pub use loaded::{Loaded, Pixels, srgb_to_linear};
#[cfg(feature = "exr")]
pub use save::save_channels;
pub use save::{save, save_blocks, save_layers, save_text};
pub use support::probe;
