// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bands of structure in the layout of the shaders' uniforms: `Band` of shared/band.wgsl.

use crate::emit::bands::{Bands, MOST_BANDS};
use bytemuck::{Pod, Zeroable};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct BandUniform {
    age: f32,
    spacing: f32,
    generation: u32,
    drift: f32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(BandUniform as "Band": age, spacing, generation, drift)
}

impl BandUniform {
    /// All bands of a structure; beyond the last one it goes on.
    pub fn all(bands: &Bands) -> [Self; MOST_BANDS] {
        std::array::from_fn(|i| {
            let band = bands.band(bands.first + i as i32);
            let [age, spacing, drift] = [band.age, band.spacing, band.drift].map(|v| v as f32);
            Self { age, spacing, generation: band.generation, drift }
        })
    }
}
