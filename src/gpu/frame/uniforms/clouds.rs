// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of matter with depth in the layout of the shaders' uniform: `Clouds` of emit/clouds.wgsl, field by
//! field.

use super::band::BandUniform;
use crate::emit::bands::MOST_BANDS;
use crate::emit::clouds::Clouds;
use crate::emit::filaments::{FILAMENT_LEVELS, level_variances};
use crate::emit::shape::{Cloud, WIDEST};
use crate::emit::volume::{Shape, Volume};
use crate::emit::volumes::Volumes;
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CloudUniform {
    strength: f32,
    clumping: f32,
    heating: f32,
    period: f32,
    per_thickness: f32,
    is_jet: u32,
    opening: f32,
    radius: f32,
    seed: u32,
    first_band: i32,
    leans: u32,
    unused: u32,
    bands: [BandUniform; MOST_BANDS],
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
        layout!(CloudUniform as "Cloud": strength, clumping, heating, period, per_thickness, is_jet, opening,
            radius, seed, first_band, leans, unused, bands),
        layout!(CloudsUniform as "Clouds": volumes, variances),
    ]
}

impl CloudUniform {
    fn new(clouds: &Clouds, cloud: &Cloud) -> Self {
        let is_jet = cloud.shape == Shape::Jet;
        let of_jet = |number: f64| if is_jet { number as f32 } else { 0.0 };
        Self {
            strength: clouds.strength as f32,
            clumping: clouds.clumping as f32,
            heating: clouds.heating as f32,
            period: clouds.period as f32,
            per_thickness: (1.0 / cloud.thickness.min(WIDEST)) as f32,
            is_jet: is_jet.into(),
            opening: of_jet(cloud.opening),
            radius: of_jet(cloud.radius),
            seed: clouds.bands.seed,
            first_band: clouds.bands.first,
            leans: clouds.leans.into(),
            unused: 0,
            bands: BandUniform::all(&clouds.bands),
        }
    }
}

impl CloudsUniform {
    /// The volumes in their order; those without structure, and those that a scene has not, have the strength 0.
    pub fn new(volumes: &Volumes) -> Self {
        let mut uniform = Self::zeroed();
        uniform.variances = level_variances().map(|[fine, coarse]| Vec4::new(fine as f32, coarse as f32, 0.0, 0.0));
        // Shaders divide by the period.
        uniform.volumes.iter_mut().for_each(|volume| volume.period = 1.0);
        for (uniform, volume) in uniform.volumes.iter_mut().zip(&volumes.volumes) {
            if let Some(clouds) = &volume.clouds {
                *uniform = CloudUniform::new(clouds, &volume.cloud);
            }
        }
        uniform
    }
}
