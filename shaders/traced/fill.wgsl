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
// Whether pixels have records here. Those that are looked up have none; nothing shines in their plane, and captured
// rays are all together, so that pixels amid rays of one fate have that fate, but for a shadow narrower than a block.
override OWN_RECORDS: bool = true;

// The bits of TracedMeta's first word that tell which media a ray has: its fate, and the orders that are kept.
const MEDIA_BITS: u32 = 0xffff0003u;
// The bits of no ray.
const NO_KEY: u32 = 0xffffffffu;

// Pixels that the workgroup lists, and the place of the first of them in the list.
var<workgroup> listed: atomic<u32>;
var<workgroup> first_listed: u32;
// The texel of the first of the quad's blocks.
var<private> first_texel: vec2<u32>;
// The media of the quad's four pixels, row by row.
var<private> found: array<vec4<f32>, 4>;

@compute @workgroup_size(8, 16)
fn fill_media(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) i: u32) {
    unknown_zero = id.z;
    if i == 0u {
        atomicStore(&listed, 0u);
    }
    workgroupBarrier();
    let begin = pass_.origin + 1;
    let quad = ((begin - 1) >> vec2<u32>(1u)) + vec2<i32>(id.xy);
    let corner = 2 * quad + 1 - begin;
    var untold = 0u;
    if all(corner < vec2<i32>(pass_.size) - 2) {
        first_texel = vec2<u32>(quad - 1 - vec2<i32>(first_block(begin.x), first_block(begin.y)));
        untold = fill_quad(vec2<u32>(corner), quad - 1);
    }
    // Pixels that lie together follow each other in the list: their rays, which run together, pass alike matter. Half
    // resolution at 1920 x 1080 takes 0.1 ms less for it (H100).
    let count = countOneBits(untold);
    let place = atomicAdd(&listed, count);
    workgroupBarrier();
    if i == 0u {
        first_listed = take_own_rays(atomicLoad(&listed));
    }
    var next = workgroupUniformLoad(&first_listed) + place;
    for (var k = 0u; k < 4u; k += 1u) {
        if (untold & (1u << k)) != 0u {
            note_own_ray(next, vec2<u32>(corner) + corner_of(k));
            next += 1u;
        }
    }
}

// Gives the pixels of a quad their media, `pixel` the first of them and `first` the first of its blocks. Those that
// the blocks do not tell, a bit each.
fn fill_quad(pixel: vec2<u32>, first: vec2<i32>) -> u32 {
    // A pixel may lie before the tile: then it has a very large number.
    let key = block_key(first);
    // The pixels that are told, a bit each.
    var told = 0u;
    for (var i = 0u; i < 4u; i += 1u) {
        let at = pixel + corner_of(i);
        var alike = key != NO_KEY;
        if OWN_RECORDS {
            alike = (textureLoad(record_meta, at + 1u, 0).x & MEDIA_BITS) == key;
        }
        if alike && !outside_tile(at) {
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
    var untold = 0u;
    for (var i = 0u; i < 4u; i += 1u) {
        let at = pixel + corner_of(i);
        if (told & (1u << i)) == 0u && !outside_tile(at) && has_look_direction(pixel_place(at)) {
            untold |= 1u << i;
        }
    }
    return untold;
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
    return select(NO_KEY, key, alike);
}

// Two blocks in the middle of a row, and places on the line between them, a quarter of the way from either.
struct Row {
    b: vec4<f32>,
    c: vec4<f32>,
    left: vec4<f32>,
    right: vec4<f32>,
}

fn row_of(row: u32, layer: u32) -> Row {
    let b = textureLoad(block_disk, first_texel + vec2<u32>(1u, row), layer, 0);
    let c = textureLoad(block_disk, first_texel + vec2<u32>(2u, row), layer, 0);
    return Row(b, c, b * HALF_LINE.y + c * HALF_LINE.z, b * HALF_LINE.z + c * HALF_LINE.y);
}

// The cubics through the four blocks of a row, less its line, and how far the line may be off.
struct RowCubics {
    left: vec4<f32>,
    right: vec4<f32>,
    bend: vec4<f32>,
}

fn cubics_of(row: u32, layer: u32, nearest: Row) -> RowCubics {
    let a = textureLoad(block_disk, first_texel + vec2<u32>(0u, row), layer, 0);
    let d = textureLoad(block_disk, first_texel + vec2<u32>(3u, row), layer, 0);
    let left = a * HALF_CUBIC.x + nearest.b * HALF_CUBIC.y + nearest.c * HALF_CUBIC.z + d * HALF_CUBIC.w;
    let right = a * HALF_CUBIC.w + nearest.b * HALF_CUBIC.z + nearest.c * HALF_CUBIC.y + d * HALF_CUBIC.x;
    return RowCubics(left - nearest.left, right - nearest.right, bend(a, nearest.b, nearest.c, d));
}

// The medium on a column of the quad from the lines and cubics of the rows, weighed from the column's nearer end.
fn medium_of_column(lines: mat4x4<f32>, near: vec4<f32>, far: vec4<f32>) -> vec4<f32> {
    let medium = lines * HALF_CUBIC + near * HALF_LINE.y + far * HALF_LINE.z;
    // Cubics overshoot.
    let least = max(medium, vec4<f32>(0.0));
    return vec4<f32>(least.xyz, min(least.w, 1.0));
}

fn brightest(medium: vec4<f32>) -> f32 {
    return max(max(medium.x, medium.y), medium.z);
}

// Finds the media of the quad's pixels in a layer of the blocks; whether they are even enough.
fn interpolate(layer: u32) -> bool {
    let first = row_of(0u, layer);
    let second = row_of(1u, layer);
    let third = row_of(2u, layer);
    let fourth = row_of(3u, layer);
    let above = cubics_of(1u, layer, second);
    let below = cubics_of(2u, layer, third);
    found[0] = medium_of_column(mat4x4<f32>(first.left, second.left, third.left, fourth.left), above.left, below.left);
    found[1] =
        medium_of_column(mat4x4<f32>(first.right, second.right, third.right, fourth.right), above.right, below.right);
    found[2] = medium_of_column(mat4x4<f32>(fourth.left, third.left, second.left, first.left), below.left, above.left);
    found[3] =
        medium_of_column(mat4x4<f32>(fourth.right, third.right, second.right, first.right), below.right, above.right);
    let left = bend(first.b, second.b, third.b, fourth.b);
    let right = bend(first.c, second.c, third.c, fourth.c);
    let bends = max(above.bend, below.bend) + max(left, right);
    let least = min(min(second.b, second.c), min(third.b, third.c));
    if SHOWS_DEPTH {
        return depth_is_even(bends.xy, least.xy, frame.half_tolerance);
    }
    let darkest = min(min(brightest(second.b), brightest(second.c)), min(brightest(third.b), brightest(third.c)));
    return light_is_even(bends, vec2<f32>(darkest, least.w), frame.least_light, frame.half_tolerance);
}
