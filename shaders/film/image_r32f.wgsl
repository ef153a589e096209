// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes pixels of format R32F into an image that the host shares. The bindings are those of film/packed.wgsl.

#import film/film
#import film/params
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var target_image: texture_storage_2d<r32float, write>;

fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let frame_place = vec2<u32>(pass_.origin + vec2<i32>(id) + 1);
    let words = develop(radiance, frame_place.x, frame_place.y);
    let place = pass_.image_origin + id;
    textureStore(target_image, place, vec4<f32>(bitcast<f32>(words.x), 0.0, 0.0, 1.0));
}
