// SPDX-License-Identifier: MIT OR Apache-2.0
//! The structure of matter with depth in the layout of the shaders' uniform: `Clouds` of emit/clouds.wgsl, field by
//! field.

use crate::emit::baking::BakeKey;
use crate::emit::shape::WIDEST;
use crate::emit::volume::{Shape, Volume};
use bytemuck::{Pod, Zeroable};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CloudUniform {
    strength: f32,
    heat_power: f32,
    heat_log: f32,
    period: f32,
    per_thickness: f32,
    is_jet: u32,
    opening: f32,
    radius: f32,
    first_ln_r: f32,
    per_reach: f32,
    seen_rows: f32,
    finest: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CloudsUniform {
    volumes: [CloudUniform; Volume::MOST],
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::gpu::kernel::layout::layout;
    [
        layout!(CloudUniform as "Cloud": strength, heat_power, heat_log, period, per_thickness, is_jet, opening,
            radius, first_ln_r, per_reach, seen_rows, finest),
        layout!(CloudsUniform as "Clouds": volumes),
    ]
}

impl CloudUniform {
    fn new(key: &BakeKey) -> Self {
        let BakeKey { clouds, cloud, .. } = key;
        let is_jet = cloud.shape == Shape::Jet;
        let of_jet = |number: f64| if is_jet { number as f32 } else { 0.0 };
        let [heat_power, heat_log] = clouds.heating_powers();
        let [first, last] = clouds.grid.ln_r;
        Self {
            strength: clouds.strength as f32,
            heat_power: heat_power as f32,
            heat_log: heat_log as f32,
            period: clouds.period as f32,
            per_thickness: (1.0 / cloud.thickness.min(WIDEST)) as f32,
            is_jet: is_jet.into(),
            opening: of_jet(cloud.opening),
            radius: of_jet(cloud.radius),
            first_ln_r: first as f32,
            per_reach: (1.0 / (last - first)) as f32,
            seen_rows: clouds.seen_rows() as f32,
            finest: key.finest as f32,
        }
    }
}

impl CloudsUniform {
    /// `keys`: those of the volumes' structure, in their order; those without structure, and those that a
    /// scene has not, have the strength 0.
    pub fn new(keys: &[Option<BakeKey>]) -> Self {
        let mut uniform = Self::zeroed();
        // Shaders divide by the period.
        uniform.volumes.iter_mut().for_each(|volume| volume.period = 1.0);
        for (uniform, key) in uniform.volumes.iter_mut().zip(keys) {
            if let Some(key) = key {
                *uniform = CloudUniform::new(key);
            }
        }
        uniform
    }
}
