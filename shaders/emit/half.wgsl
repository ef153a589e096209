// SPDX-License-Identifier: MIT OR Apache-2.0
// Matter with depth at half resolution: which blocks of 2 x 2 pixels a pixel's medium is found from, and whether they
// tell it. Mirrors src/emit/half.rs, where the rule and the reasons are. Knows no textures.

#import constants

// The number of the first of the four blocks of a row that a pixel's medium is found from.
fn first_block(pixel: i32) -> i32 {
    return ((pixel - 1) >> 1u) - 1;
}

// The place of a block's ray along a row, for samples that lie at `offset` in their pixels, 0 .. 1.
fn block_place(block: i32, offset: f32) -> f32 {
    return f32(BLOCK * block) + 0.5 + offset;
}

// How far the line between the middle two of four values may be off.
fn bend(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) -> vec4<f32> {
    return (0.5 * OFF_LINE) * (abs(a - 2.0 * b + c) + abs(b - 2.0 * c + d));
}

// Whether light (xyz, and in w the share that passes) is even enough that bends so. `darkest`: the least of what it is
// at the four blocks nearest, of light the brightest component; light as dark as `least` need not be told exactly.
fn light_is_even(bends: vec4<f32>, darkest: vec2<f32>, least: f32, tolerance: f32) -> bool {
    return all(bends <= tolerance * vec4<f32>(vec3<f32>(darkest.x + least), darkest.y + HALF_LEAST_SHARE));
}

// Whether I_nu and optical depth are even enough that bend so. `least`: of either at the four blocks nearest.
fn depth_is_even(bends: vec2<f32>, least: vec2<f32>, tolerance: f32) -> bool {
    return all(bends <= tolerance * vec2<f32>(least.x, least.y + HALF_LEAST_DEPTH));
}
