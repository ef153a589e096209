// SPDX-License-Identifier: MIT OR Apache-2.0
//! Image files: PNG, OpenEXR (cargo feature `exr`) and PNM. A file appears whole or not at all; a broken one is an
//! error, and what it claims to hold is checked before memory is taken for it. Each kind of file has a module of its
//! own; `support` holds what they share: limits, errors, memory. Decoders and encoders run on a thread of their own:
//! see `support::on_own_thread`.

#[cfg(feature = "exr")]
mod exr;
#[cfg(feature = "exr")]
mod layers;
mod load;
mod loaded;
mod pam;
mod png;
mod pnm;
mod replace;
mod save;
mod support;
#[cfg(test)]
mod tests;

pub use load::{decode_png, load};
pub use loaded::{Loaded, Pixels, srgb_to_linear};
pub use save::{Attribute, Layer, save, save_layers};
