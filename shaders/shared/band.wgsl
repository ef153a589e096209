// SPDX-License-Identifier: MIT OR Apache-2.0
// A band of radius in which structure is renewed, at a frame's reference time. Mirrors `BandUniform` of
// src/gpu/frame/uniforms/band.rs; what its numbers mean stands in src/emit/bands.rs.

struct Band {
    // The age of the generation that was born last, and the time from birth to birth, M.
    age: f32,
    spacing: f32,
    // The number of that generation.
    generation: u32,
    // How fast ln r of the matter changes, per M.
    drift: f32,
}
