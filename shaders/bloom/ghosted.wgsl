// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: adds the ghosts of a lens to what the finest grid spreads already. Mirrors src/film/bloom/ghosts.rs.

#import bloom/flare
#import shared/f16

@group(0) @binding(0) var<uniform> flare: GhostNumbers;
@group(0) @binding(1) var glare: texture_2d<f32>;
@group(0) @binding(2) var drawn: texture_2d<f32>;
@group(0) @binding(3) var smooth_: sampler;
@group(0) @binding(4) var spread: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 16)
fn add_ghosts(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= textureDimensions(spread)) {
        return;
    }
    let place = (vec2<f32>(id.xy) + 0.5) * flare.fine;
    let within = clamp(place - 0.5, vec2<f32>(0.0), vec2<f32>(flare.target_cells - 1u));
    let size = vec2<f32>(textureDimensions(drawn));
    let light = textureSampleLevel(drawn, smooth_, (within + 0.5) / size, 0.0).xyz;
    let sum = flare.above * textureLoad(glare, id.xy, 0).xyz + light;
    textureStore(spread, id.xy, rounded_to_f16(vec4<f32>(sum, 1.0)));
}
