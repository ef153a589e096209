// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of matter with depth in the layout of the shaders' uniform: `Clouds` of emit/clouds.wgsl, field by
//! field.

use super::frame::bands;
use crate::emit::bands::MOST_BANDS;
use crate::emit::filaments::{FILAMENT_LEVELS, level_variances};
use crate::emit::shape::{Cloud, WIDEST};
use crate::emit::volume::{Shape, Volume};
use crate::emit::volumes::Volumes;
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CloudUniform {
    structure: Vec4,
    shape: Vec4,
    pattern: [u32; 4],
    bands: [[u32; 4]; MOST_BANDS],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CloudsUniform {
    volumes: [CloudUniform; Volume::MOST],
    variances: [Vec4; FILAMENT_LEVELS],
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::gpu::kernel::layout::layout;
    [
        layout!(CloudUniform as "Cloud": structure, shape, pattern, bands),
        layout!(CloudsUniform as "Clouds": volumes, variances),
    ]
}

fn four(numbers: [f64; 4]) -> Vec4 {
    Vec4::from_array(numbers.map(|v| v as f32))
}

/// 1 / thickness, and what a jet's walls are.
fn shape(cloud: &Cloud) -> Vec4 {
    let per_thickness = 1.0 / cloud.thickness.min(WIDEST);
    match cloud.shape {
        Shape::Jet => four([per_thickness, cloud.opening, cloud.radius, 1.0]),
        Shape::Disk | Shape::Torus | Shape::Halo => four([per_thickness, 0.0, 0.0, 0.0]),
    }
}

impl CloudsUniform {
    /// The volumes in their order; those without structure, and those that a scene has not, have the strength 0.
    pub fn new(volumes: &Volumes) -> Self {
        let mut uniform = Self::zeroed();
        uniform.variances = level_variances().map(|[fine, coarse]| four([fine, coarse, 0.0, 0.0]));
        // Shaders divide by the period.
        uniform.volumes.iter_mut().for_each(|volume| volume.structure = four([0.0, 0.0, 0.0, 1.0]));
        for (uniform, volume) in uniform.volumes.iter_mut().zip(&volumes.volumes) {
            if let Some(clouds) = &volume.clouds {
                *uniform = CloudUniform {
                    structure: four([clouds.strength, clouds.clumping, clouds.heating, clouds.period]),
                    shape: shape(&volume.cloud),
                    pattern: [clouds.bands.seed, clouds.bands.first as u32, u32::from(clouds.leans), 0],
                    bands: bands(&clouds.bands),
                };
            }
        }
        uniform
    }
}
