//! What lies at infinity: the embedded star catalogue, the index that finds the stars of a pixel, and the rule that draws them.
//! Works in sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole); knows nothing of holes, lenses and cameras.

pub mod catalogue;
pub mod index;
mod stars;

pub use index::StarIndex;
