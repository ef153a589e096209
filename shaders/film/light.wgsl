// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes the exposed light of a frame with bloom, from shading or from the sum of samples, into a texture from which it
// then spreads. The bindings are those of film/packed.wgsl.

#import constants
#import film/encode
#import film/film
#import film/params
#import shared/f16
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var exposed_light: texture_storage_2d<rgba16float, write>;

// Alpha is kept here, and dropped in development.
fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let place = pass_.origin + vec2<i32>(id) + 1 - pass_.light_origin;
    let light = limited(radiance.xyz * film.exposure, MAX_SCENE_LIGHT);
    let alpha = limited(vec3<f32>(radiance.w), 1.0).x;
    textureStore(exposed_light, place, rounded_to_f16(vec4<f32>(light, alpha)));
}
