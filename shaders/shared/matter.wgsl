// SPDX-License-Identifier: MIT OR Apache-2.0
// A volume or a hot spot as the kernels of a frame see it. Mirrors `MatterUniform` of
// src/gpu/frame/uniforms/matter.rs; what its numbers mean stands in src/emit/volume.rs and src/emit/hot_spot.rs.

struct Matter {
    // SHAPE_*, MOTION_*, 1 for a power law and 0 for a blackbody's light; 0.
    kind: vec4<u32>,
    // 1/r between which it is, outer end first, and the greatest |cos theta|; +1 or -1: its sense of motion.
    reach: vec4<f32>,
    // Inner, outer, radius, width. A spot: radius, size, azimuth at the frame's time, angular velocity towards +phi.
    radii: vec4<f32>,
    // Thickness, opening, slope, ISCO.
    form: vec4<f32>,
    // KEPLERIAN: sub_keplerian, infall; ANGULAR_MOMENTUM: l0; RIGID: angular velocity; OUTFLOW: speed, base. 0, 0.
    motion: vec4<f32>,
    // Absorption, temperature, reference radius, temperature slope.
    glow: vec4<f32>,
    // ln of the reference luminance, spectral index, brightness, the least density that is not left out.
    light: vec4<f32>,
    // Linear Rec. 709; 0.
    tint: vec4<f32>,
}
