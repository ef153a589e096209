// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky at infinity: the embedded star catalogue, random stars, the index that finds the stars of a pixel, and the
//! rule that draws them; pictures of the whole sky, the Milky Way's and the host's, and how they are filtered; the
//! coordinate grid. Works in sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole); knows nothing of
//! holes, lenses and cameras.

pub mod catalogue;
pub(crate) mod grid;
mod map;
mod compressed;
mod stored;
pub(crate) mod shift;
pub(crate) mod filter;
pub mod galaxy;
pub mod index;
mod growing_index;
pub mod procedural;
mod field;
pub mod milky_way;
pub(crate) mod stars;

pub use compressed::{CompressedMap, RowReader};
pub use field::StarField;
pub use grid::under_grid;
pub use index::StarIndex;
pub use map::{GrowingMap, Level, MAX_MAP_SIZE, SkyMap};
pub use shift::shifted_map_light;
pub use stars::least_patch;
pub use stored::{MapFile, StoredMap};
