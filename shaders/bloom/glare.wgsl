// SPDX-License-Identifier: MIT OR Apache-2.0
// The light that film/develop.wgsl and film/develop_rows.wgsl develop in frames with bloom: the share that a pixel
// keeps of its own light, and its share of the light that the finest grid spreads, which falls linearly from the cells'
// centres.

#import bloom/level
#import shared/pass
#requires fn as_metered(light: vec4<f32>, place: vec2<i32>) -> vec4<f32>

// The number of pixels along a cell's side; it is even.
override STEP: u32 = 2u;

@group(1) @binding(0) var exposed_light: texture_2d<f32>;
@group(1) @binding(1) var glare: texture_2d<f32>;
@group(1) @binding(2) var smooth_: sampler;
@group(1) @binding(3) var<uniform> level: BloomLevel;

fn tile_light(id: vec2<u32>) -> vec4<f32> {
    let place = pass_.origin + vec2<i32>(id) + 1;
    let light = textureLoad(exposed_light, place - pass_.light_origin, 0);
    let between = (vec2<f32>(place) + 0.5) / f32(STEP) - 0.5;
    let inside = clamp(between, vec2<f32>(0.0), vec2<f32>(level.cells - 1u));
    let scattered = textureSampleLevel(glare, smooth_, (inside + 0.5) / vec2<f32>(textureDimensions(glare)), 0.0);
    let glared = vec4<f32>(level.own * light.xyz + level.above * scattered.xyz, light.w);
    return as_metered(glared, place);
}
