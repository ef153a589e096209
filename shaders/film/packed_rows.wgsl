// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes the pixels of a tile as film/packed.wgsl does, for kernels whose `pixels` lie in the host's memory, and, so
// that the same kernel makes the same bytes, in buffers that the host shares. The bus carries whole lines of 128 bytes
// twice as fast as the 32 bytes that a block of 8 x 4 pixels has of each row (H200: 49 against 24.5 GB/s). So a
// workgroup, which has a thread for each of ROWS_PIXELS pixels, ROWS_WIDTH wide, gathers their words and then writes
// them row by row.

#import constants
#import film/film
#import film/params
#import shared/pass

@group(2) @binding(0) var<uniform> film: FilmParams;
@group(2) @binding(1) var<storage, read_write> pixels: array<u32>;

// The words of the workgroup's pixels, row by row; a pixel has 4 at most.
var<workgroup> row_words: array<u32, 4u * ROWS_PIXELS>;
// The number of this thread's pixel among them.
var<private> rows_index: u32;

fn keep_words(words: vec4<u32>) {
    // No loop, as in packed.wgsl.
    let first = pixel_words() * rows_index;
    row_words[first] = words.x;
    if has_several_words() {
        row_words[first + 1u] = words.y;
        if is_rgba32f() {
            row_words[first + 2u] = words.z;
            row_words[first + 3u] = words.w;
        }
    }
}

fn write_pixel(id: vec2<u32>, radiance: vec4<f32>) {
    let place = vec2<u32>(pass_.origin + vec2<i32>(id) + 1);
    keep_words(develop(radiance, place.x, place.y));
}

// Once all threads have written their pixels: thread `i` writes its share of those of the workgroup at `corner`. Words
// of pixels that another kernel will write are whatever `keep_words` had last.
fn write_rows(corner: vec2<u32>, i: u32) {
    for (var k = 0u; k < pixel_words(); k += 1u) {
        let word = i + ROWS_PIXELS * k;
        let row_size = ROWS_WIDTH * pixel_words();
        let column = word % row_size;
        let id = corner + vec2<u32>(column / pixel_words(), word / row_size);
        if !outside_tile(id) {
            let first = pass_.pixels_first + id.y * pass_.pixels_row + pixel_words() * corner.x;
            pixels[first + column] = row_words[word];
        }
    }
}
