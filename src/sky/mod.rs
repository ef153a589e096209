//! What lies at infinity: the embedded star catalogue, random stars, the index that finds the stars of a pixel, and the rule that draws them.
//! Works in sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole); knows nothing of holes, lenses and cameras.

pub mod catalogue;
mod field;
pub mod galaxy;
pub mod index;
pub mod procedural;
mod stars;

pub use field::StarField;
pub use index::StarIndex;
pub use stars::least_patch;
