// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes the pixels of a tile into the buffer that a frame's last kernel writes for the host: packed ones, to be
// copied, or the rows of a whole frame. (The uniforms of group 2 come after those of a lens: the other way round Mesa
// 22.3's lavapipe crashes.)

#import film/film
#import film/params
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var<storage, read_write> pixels: array<u32>;

fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let place = vec2<u32>(pass_.origin + vec2<i32>(id) + 1);
    let words = develop(radiance, place.x, place.y);
    let first = pass_.pixels_first + id.y * pass_.pixels_row + pixel_words() * id.x;
    // This is no loop over words[k]: with one, frames at spin 0.9 take 11 % longer (H200).
    if has_several_words() {
        pixels[first] = words.x;
        pixels[first + 1u] = words.y;
        if is_rgba32f() {
            pixels[first + 2u] = words.z;
            pixels[first + 3u] = words.w;
        }
    } else {
        pixels[first] = words.x;
    }
}
