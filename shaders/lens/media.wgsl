// SPDX-License-Identifier: MIT OR Apache-2.0
// The medium along the ray of a pixel whose record is looked up: the blocks of half resolution tell it, or it was
// summed along the pixel's own ray (traced/fill.wgsl and traced/listed.wgsl leave it). Knows no tables.

// A pixel has the texel that it has in the records of traced/layout.wgsl.
@group(1) @binding(0) var media: texture_2d_array<f32>;

var<private> media_texel: vec2<u32>;

// Goes to the tile's pixel `id`.
fn set_media_pixel(id: vec2<u32>) {
    media_texel = id + 1u;
}

// Frames in whose plane anything shines trace their pixels instead, so that one medium is all.
fn medium_before(k: u32) -> vec4<f32> {
    return textureLoad(media, media_texel, k, 0);
}
