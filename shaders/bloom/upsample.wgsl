// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: each cell of a grid gets its share of the light that the coarser grids spread, on top of what it spreads
// itself.

#import bloom/level
#import shared/f16

@group(0) @binding(0) var<uniform> level: BloomLevel;
@group(0) @binding(1) var finer: texture_2d<f32>;
@group(0) @binding(2) var coarser: texture_2d<f32>;
@group(0) @binding(3) var smooth_: sampler;
@group(0) @binding(4) var spread: texture_storage_2d<rgba16float, write>;

// The light at a place between coarser cells, whose centres lie at whole numbers; beyond the last cells it is theirs.
fn between(place: vec2<f32>) -> vec3<f32> {
    let inside = clamp(place, vec2<f32>(0.0), vec2<f32>(level.cells - 1u));
    return textureSampleLevel(coarser, smooth_, (inside + 0.5) / vec2<f32>(textureDimensions(coarser)), 0.0).xyz;
}

@compute @workgroup_size(8, 16)
fn upsample(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= level.fine) {
        return;
    }
    // Along each side the coarser cell that this one lies in gives 10 / 16, the next on this one's half 5 / 16, the
    // other 1 / 16. The first two are one sample, 1/3 of the way from one to the other.
    let half_ = select(vec2<f32>(-1.0), vec2<f32>(1.0), (id.xy & vec2<u32>(1u)) == vec2<u32>(1u));
    let own = vec2<f32>(id.xy / 2u);
    let near = own + half_ / 3.0;
    let far = own - half_;
    let upsampled = (225.0 * between(near)
        + 15.0 * (between(vec2<f32>(far.x, near.y)) + between(vec2<f32>(near.x, far.y)))
        + between(far)) / 256.0;
    let light = level.own * textureLoad(finer, id.xy, 0).xyz + level.above * upsampled;
    textureStore(spread, id.xy, rounded_to_f16(vec4<f32>(light, 1.0)));
}
