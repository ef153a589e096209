// SPDX-License-Identifier: MIT OR Apache-2.0
// Metering: how a frame's light is measured and changed. Mirrors `MeterParams` of src/film/metering.rs, where the
// formulas, sources and reasons are.

#requires var meter: MeterParams

struct MeterParams {
    cells: vec2<u32>,
    blocks: vec2<u32>,
    side: u32,
    own: f32,
    above: f32,
    strength: f32,
    percentile: f32,
    aim: f32,
    least: f32,
    most: f32,
    adaptation: f32,
    highlights: f32,
    shadows: f32,
    per_pixel: f32,
}
