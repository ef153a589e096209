// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lens tables: for one observer, the fates of all its light rays, so that looking in a direction costs an
//! interpolation instead of an integration. Knows light and observers only: no scene, no pixel, no thread.
//!
//! Spin 0: every ray lies in a plane and depends on one number, its angle from the hole. `coordinate`: the logarithmic
//! axis along which rays are tabulated; `schwarzschild`: the family of rays of one observer, integrated ray by ray;
//! `table`: the tables and looking them up; `plane`: from the ray in its own plane to the chart. With spin:
//! `critical`: the critical curve on the observer's sky; `kerr`: tables in two dimensions about it.

pub mod coordinate;
pub mod critical;
pub mod schwarzschild;
pub mod table;
pub mod plane;
pub mod kerr;
#[cfg(test)]
mod tests;

pub use coordinate::LENS;
pub use plane::{OrbitPlane, PlaneImage, PlaneSky, Turn};
pub use schwarzschild::{Branch, Column, Family, Resolution};
pub use table::{Crossing, SchwarzschildLens, SchwarzschildLookup};
