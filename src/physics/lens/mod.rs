//! Lens tables: for one eye, the fates of all its light rays, so that looking in a direction costs an interpolation instead of
//! an integration. Spin 0: every ray lies in a plane and depends on one number, its angle from the hole.
//! Knows light and observers only: no scene, no pixel, no thread. `coordinate`: the logarithmic axis along which rays are
//! tabulated; `schwarzschild`: the family of rays of one eye, integrated ray by ray; `table`: the tables and looking them up;
//! `plane`: from the ray in its own plane to the chart.

pub mod coordinate;
pub mod plane;
pub mod schwarzschild;
pub mod table;

pub use plane::{OrbitPlane, PlaneImage, Turn};
pub use schwarzschild::{Branch, Column, Family, Resolution};
pub use table::{Crossing, Look, SchwarzschildLens};

#[cfg(test)]
mod tests;
