// SPDX-License-Identifier: MIT OR Apache-2.0
// The light that film/develop.wgsl and film/develop_rows.wgsl develop in frames without bloom: the sum of a tile's
// samples.

@group(1) @binding(0) var radiance: texture_2d<f32>;

fn tile_light(id: vec2<u32>) -> vec4<f32> {
    return textureLoad(radiance, id, 0);
}
