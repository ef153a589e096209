// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: develops the light of a tile to pixels. The curves are in film/film.wgsl; the light comes from
// film/summed.wgsl or bloom/glare.wgsl.

#import shared/not_inlined
#import shared/pass
#requires fn tile_light(id: vec2<u32>) -> vec4<f32>
#requires fn write_pixel(id: vec2<u32>, radiance: vec4<f32>)

@group(0) @binding(0) var<uniform> pass_: Pass;

@compute @workgroup_size(8, 16)
fn develop_tile(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    if outside_tile(id.xy) {
        return;
    }
    write_pixel(id.xy, tile_light(id.xy));
}
