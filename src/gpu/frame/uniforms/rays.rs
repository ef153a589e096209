// SPDX-License-Identifier: MIT OR Apache-2.0
//! Hosts' rays in the layout of the shaders' structs: `RaysUniform`, `RayStart` and `RayEnd` of geodesic/rays.wgsl,
//! field by field.

use bytemuck::{Pod, Zeroable};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct RaysUniform {
    pub step: f32,
    pub tolerance: f32,
    pub max_steps: u32,
    pub count: u32,
    pub a: f32,
    pub r_plus: f32,
    pub r_minus: f32,
    pub capture_u: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct RayStart {
    pub light: [f32; 4],
    pub curve: [f32; 4],
    pub n: [f32; 4],
    pub dn: [f32; 4],
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct RayEnd {
    pub n: [f32; 4],
    pub rest: [u32; 4],
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 3] {
    use crate::gpu::kernel::layout::layout;
    let given = layout!(RaysUniform as "RaysUniform": step, tolerance, max_steps, count, a, r_plus, r_minus, capture_u);
    [given, layout!(RayStart as "RayStart": light, curve, n, dn), layout!(RayEnd as "RayEnd": n, rest)]
}
