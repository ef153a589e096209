// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes pixels of format RGBA8 into a window's texture, from which window/present.wgsl fills the window's image, or
// into an image that the host shares. The bindings are those of film/packed.wgsl.

#import film/film
#import film/params
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var screen: texture_storage_2d<rgba8unorm, write>;

fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let frame_place = vec2<u32>(pass_.origin + vec2<i32>(id) + 1);
    // A code of 8 bits is the same after unpacking and rounding.
    let codes = unpack4x8unorm(develop(radiance, frame_place.x, frame_place.y).x);
    textureStore(screen, pass_.image_origin + id, codes);
}
