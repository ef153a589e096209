// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: does what bloom/gather.wgsl does, for the finest grid's cells of 2 x 2 pixels. Their shares 1 3 3 1 are those
// of linear filtering between the pixels of two pairs, so that 4 samples serve instead of 16. Beyond the frame's border
// lies the border's pixel, which so keeps its light.

#import bloom/level
#import shared/f16

@group(0) @binding(0) var<uniform> level: BloomLevel;
@group(0) @binding(1) var pixels: texture_2d<f32>;
@group(0) @binding(2) var smooth_: sampler;
@group(0) @binding(3) var gathered: texture_storage_2d<rgba16float, write>;

// The light at a place between pixels, whose centres lie at whole numbers.
fn between(place: vec2<f32>) -> vec3<f32> {
    let inside = clamp(place, vec2<f32>(0.0), vec2<f32>(level.fine - 1u)) - vec2<f32>(level.origin);
    return textureSampleLevel(pixels, smooth_, (inside + 0.5) / vec2<f32>(textureDimensions(pixels)), 0.0).xyz;
}

@compute @workgroup_size(8, 16)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= level.count) {
        return;
    }
    let cell = level.first + id.xy;
    // Pixels -1 and 0 of the cell, by 1 : 3; pixels 1 and 2, by 3 : 1, unless the frame ends before.
    let first = vec2<f32>(2u * cell) - 0.25;
    let second = first + 1.5;
    let weight = select(vec2<f32>(0.0), vec2<f32>(1.0), 2u * cell + 1u < level.fine);
    let top = between(first) + weight.x * between(vec2<f32>(second.x, first.y));
    let bottom = between(vec2<f32>(first.x, second.y)) + weight.x * between(second);
    let sum = (top + weight.y * bottom) / ((1.0 + weight.x) * (1.0 + weight.y));
    textureStore(gathered, cell, rounded_to_f16(vec4<f32>(sum, 1.0)));
}
