// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: gives the pixels of a tile the media that the blocks about them tell, and lists those of which they do not
// (emit/half.wgsl). Four pixels amid the same blocks go together: 2 q + 1 and 2 q + 2 of a row are quad q.

#import constants
#import camera/projection
#import emit/half
#import shared/frame
#import shared/not_inlined
#import shared/pass
#import traced/own_rays

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
// Records in the layout of traced/layout.wgsl: of pixels, and of blocks.
@group(0) @binding(2) var record_meta: texture_2d<u32>;
@group(0) @binding(3) var block_meta: texture_2d<u32>;
@group(0) @binding(4) var block_disk: texture_2d_array<f32>;
@group(0) @binding(5) var record_disk: texture_storage_2d_array<rgba32float, write>;

// Whether media are I_nu and optical depth.
override SHOWS_DEPTH: bool = false;

// The bits of TracedMeta's first word that tell which media a ray has: its fate, and the orders that are kept.
const MEDIA_BITS: u32 = 0xffff0003u;

// The texel of the first of the quad's blocks.
var<private> first_texel: vec2<u32>;
// The media of the quad's four pixels, row by row.
var<private> found: array<vec4<f32>, 4>;

@compute @workgroup_size(8, 16)
fn fill_media(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    let begin = pass_.origin + 1;
    let quad = ((begin - 1) >> vec2<u32>(1u)) + vec2<i32>(id.xy);
    let first = quad - 1;
    first_texel = vec2<u32>(first - vec2<i32>(first_block(begin.x), first_block(begin.y)));
    let corner = 2 * quad + 1 - begin;
    if any(corner >= vec2<i32>(pass_.size) - 2) {
        return;
    }
    // One of them may lie before the tile: then it has a very large number.
    let pixel = vec2<u32>(corner);
    let key = block_key(first);
    // The pixels that are told, a bit each.
    var told = 0u;
    for (var i = 0u; i < 4u; i += 1u) {
        let at = pixel + corner_of(i);
        if !outside_tile(at) && (textureLoad(record_meta, at + 1u, 0).x & MEDIA_BITS) == key {
            told |= 1u << i;
        }
    }
    for (var k = 0u; k <= countOneBits(key >> 16u) && told != 0u; k += 1u) {
        if !interpolate(frame.medium_layer + k) {
            told = 0u;
        }
        for (var i = 0u; i < 4u; i += 1u) {
            if (told & (1u << i)) != 0u {
                textureStore(record_disk, pixel + corner_of(i) + 1u, frame.medium_layer + k, found[i]);
            }
        }
    }
    for (var i = 0u; i < 4u; i += 1u) {
        let at = pixel + corner_of(i);
        if (told & (1u << i)) == 0u && !outside_tile(at) && has_look_direction(pixel_place(at)) {
            note_own_ray(at);
        }
    }
}

// The place of pixel `i` of a quad in it.
fn corner_of(i: u32) -> vec2<u32> {
    return vec2<u32>(i & 1u, i >> 1u);
}

// The bits that all of the quad's blocks have, of which `first` is the first; no bits of any ray where they differ, or
// where a border lies among them.
fn block_key(first: vec2<i32>) -> u32 {
    let key = textureLoad(block_meta, first_texel + 1u, 0).x & MEDIA_BITS;
    var alike = true;
    for (var i = 1u; i < 15u; i += 1u) {
        // All but the corners.
        if ((0x6ff6u >> i) & 1u) != 0u {
            let there = textureLoad(block_meta, first_texel + vec2<u32>(i & 3u, i >> 2u), 0).x;
            alike = alike && (there & MEDIA_BITS) == key;
        }
    }
    // A fisheye's circle and the faces of a cube are convex.
    let low = vec2<f32>(block_place(first.x, pass_.offset.x), block_place(first.y, pass_.offset.y));
    let high = low + f32(3 * BLOCK);
    alike = alike && same_face(low.x, high.x) && has_look_direction(low) && has_look_direction(high)
        && has_look_direction(vec2<f32>(low.x, high.y)) && has_look_direction(vec2<f32>(high.x, low.y));
    return select(0xffffffffu, key, alike);
}

// Finds the media of the quad's pixels in a layer of the blocks; whether they are even enough.
fn interpolate(layer: u32) -> bool {
    found = array<vec4<f32>, 4>();
    // The middle two of each row, of the rows before.
    var columns = array<vec4<f32>, 8>();
    var across = vec4<f32>(0.0);
    var darkest = vec2<f32>(1e30);
    var least = vec2<f32>(1e30);
    for (var row = 0u; row < 4u; row += 1u) {
        let at = first_texel + vec2<u32>(0u, row);
        let a = textureLoad(block_disk, at, layer, 0);
        let b = textureLoad(block_disk, at + vec2<u32>(1u, 0u), layer, 0);
        let c = textureLoad(block_disk, at + vec2<u32>(2u, 0u), layer, 0);
        let d = textureLoad(block_disk, at + vec2<u32>(3u, 0u), layer, 0);
        // On the line between the nearest, and what the cubic adds to that.
        let left = b * HALF_LINE.y + c * HALF_LINE.z;
        let right = b * HALF_LINE.z + c * HALF_LINE.y;
        let left_more = a * HALF_CUBIC.x + b * HALF_CUBIC.y + c * HALF_CUBIC.z + d * HALF_CUBIC.w - left;
        let right_more = a * HALF_CUBIC.w + b * HALF_CUBIC.z + c * HALF_CUBIC.y + d * HALF_CUBIC.x - right;
        found[0] += HALF_CUBIC[row] * left + HALF_LINE[row] * left_more;
        found[1] += HALF_CUBIC[row] * right + HALF_LINE[row] * right_more;
        found[2] += HALF_CUBIC[3u - row] * left + HALF_LINE[3u - row] * left_more;
        found[3] += HALF_CUBIC[3u - row] * right + HALF_LINE[3u - row] * right_more;
        columns[2u * row] = b;
        columns[2u * row + 1u] = c;
        if row == 1u || row == 2u {
            across = max(across, bend(a, b, c, d));
            let brightest = vec2<f32>(max(max(b.x, b.y), b.z), max(max(c.x, c.y), c.z));
            darkest = min(darkest, vec2<f32>(min(brightest.x, brightest.y), min(b.w, c.w)));
            least = min(least, min(b.xy, c.xy));
        }
    }
    let left = bend(columns[0], columns[2], columns[4], columns[6]);
    let right = bend(columns[1], columns[3], columns[5], columns[7]);
    let bends = across + max(left, right);
    for (var i = 0u; i < 4u; i += 1u) {
        // Cubics overshoot.
        found[i] = max(found[i], vec4<f32>(0.0));
        found[i].w = min(found[i].w, 1.0);
    }
    if SHOWS_DEPTH {
        return depth_is_even(bends.xy, least, frame.half_tolerance);
    }
    return light_is_even(bends, darkest, frame.least_light, frame.half_tolerance);
}
