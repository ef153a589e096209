// SPDX-License-Identifier: MIT OR Apache-2.0
// One sample of one tile: the uniform `pass_`, which the kernel binds. The traced rectangle is the tile and one pixel
// around it, for the derivatives.

#requires var pass_: Pass

struct Pass {
    // The traced rectangle's top-left pixel in the full frame.
    origin: vec2<i32>,
    // The size of the traced rectangle.
    size: vec2<u32>,
    // The place of this sample in its pixel, 0 .. 1.
    offset: vec2<f32>,
    // The weight of this sample among all.
    weight: f32,
    // 1: begins a new sum.
    first: u32,
    // The number of this sample among those of the submission.
    slot: u32,
    // Samples that refine/refine.wgsl takes of a pixel that the critical curve runs through.
    curve_samples: u32,
    // Where in the full frame the texture of a frame's light begins (film/light.wgsl).
    light_origin: vec2<i32>,
    // The tile's first pixel in the image that the frame is written to (film/screen.wgsl).
    image_origin: vec2<u32>,
    // The place of the tile's first pixel in the buffer that it is written to (film/packed.wgsl), and the distance of
    // its rows, in words.
    pixels_first: u32,
    pixels_row: u32,
    // The time of this sample less that of the frame, M (emit/moment.wgsl).
    moment: f32,
    unused: u32,
}

// The shift from this sample to the place looked at, pixels: 0 but where refine/refine.wgsl spreads samples over a
// pixel.
var<private> sample_shift: vec2<f32>;

fn outside_tile(id: vec2<u32>) -> bool {
    return id.x >= pass_.size.x - 2u || id.y >= pass_.size.y - 2u;
}

// The place of the sample in the tile's pixel `id` in the full frame, pixels.
fn pixel_place(id: vec2<u32>) -> vec2<f32> {
    return vec2<f32>(pass_.origin + vec2<i32>(id) + 1) + pass_.offset + sample_shift;
}
