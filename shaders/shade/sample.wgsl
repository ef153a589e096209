// SPDX-License-Identifier: MIT OR Apache-2.0
// Adds the light of one of a pixel's samples to the sum of those before.

#import shared/not_inlined
#import shared/pass

// The sum of the tile's samples before this one, and the sum with it.
@group(2) @binding(0) var radiance_before: texture_2d<f32>;
@group(2) @binding(1) var radiance: texture_storage_2d<rgba32float, write>;

fn take_light(id: vec2<u32>, light: vec4<f32>) {
    var sum = light * pass_.weight;
    if not_inlined(pass_.first) == 0u {
        sum += textureLoad(radiance_before, id, 0);
    }
    textureStore(radiance, id, sum);
}
