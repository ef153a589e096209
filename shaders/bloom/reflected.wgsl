// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: the light of each cell of the source that reaches ghosts. Mirrors src/film/bloom/ghosts.rs.

#import bloom/flare
#import bloom/tail
#import shared/f16

@group(0) @binding(0) var<uniform> flare: GhostNumbers;
@group(0) @binding(1) var gathered: texture_2d<f32>;
@group(0) @binding(2) var reflected_light: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 16)
fn reflect_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= flare.source_cells) {
        return;
    }
    let from_end = vec2<i32>(flare.source_cells) - 1 - vec2<i32>(id.xy);
    let part = covered(from_end.x, flare.tail_x) * covered(from_end.y, flare.tail_y)
        * reflected((vec2<f32>(id.xy) + 0.5) * flare.step, flare.middle);
    let light = part * textureLoad(gathered, id.xy, 0).xyz;
    textureStore(reflected_light, id.xy, rounded_to_f16(vec4<f32>(light, 1.0)));
}
