// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes pixels into a window's texture, from which window/present.wgsl fills the window's image. The bindings are
// those of film/packed.wgsl.

#import film/film
#import film/params
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var screen: texture_storage_2d<rgba8unorm, write>;

fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let place = vec2<u32>(pass_.origin + vec2<i32>(id) + 1);
    // A code of 8 bits is the same after unpacking and rounding.
    textureStore(screen, place, unpack4x8unorm(develop(radiance, place.x, place.y).x));
}
