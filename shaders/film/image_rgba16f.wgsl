// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes pixels of format RGBA16F into an image that the host shares: the numbers of develop_rgba16f in film/film.wgsl.
// The bindings are those of film/packed.wgsl.

#import constants
#import film/encode
#import film/film
#import film/params
#import shared/f16
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var target_image: texture_storage_2d<rgba16float, write>;

fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let light = rounded_to_f16(vec4<f32>(limited(radiance.xyz, MAX_F16), alpha_of(radiance.w)));
    textureStore(target_image, pass_.image_origin + id, light);
}
