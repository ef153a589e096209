// SPDX-License-Identifier: MIT OR Apache-2.0
// Footprints of traced pixels, from their neighbours' records, which traced/pixels.wgsl wrote. The layout of the
// textures is in traced/layout.wgsl.

#import camera/projection
#import records/record
#import shared/math
#import shared/pass
#import traced/layout

@group(1) @binding(0) var record_sky: texture_2d<f32>;
@group(1) @binding(1) var record_meta: texture_2d<u32>;
@group(1) @binding(2) var record_disk: texture_2d_array<f32>;

// The place of the record at hand in the textures.
var<private> traced_pixel: vec2<u32>;
// Whether the neighbours to the left and to the right are of the same face.
var<private> traced_joined: vec2<bool>;

// Goes to the tile's pixel `id`.
fn set_traced_pixel(id: vec2<u32>) {
    traced_pixel = id + 1u;
    let x = pixel_place(id).x - sample_shift.x;
    traced_joined = vec2<bool>(same_face(x, x - 1.0), same_face(x, x + 1.0));
}

// Whether the neighbours at -+ step may be compared with the pixel.
fn traced_neighbours(step: vec2<u32>) -> vec2<bool> {
    return select(traced_joined, vec2<bool>(true), step.x == 0u);
}

// The footprint of the pixel, whose own ray goes to `here`, about the direction `sky` of one of its samples.
fn sky_footprint(here: vec3<f32>, sky: vec3<f32>) -> Footprint {
    let dx = derivative_of_direction(here, vec2<u32>(1u, 0u));
    let dy = derivative_of_direction(here, vec2<u32>(0u, 1u));
    var footprint = footprint_of(sky, dx.xyz, dy.xyz);
    footprint.dx = select(vec2<f32>(1e30), footprint.dx, dx.w != 0.0);
    footprint.dy = select(vec2<f32>(1e30), footprint.dy, dy.w != 0.0);
    return footprint;
}

// d(sky direction) / d(pixel) along the neighbours at -+ step: central where both escaped, else one-sided; w is 0
// where neither did, which only the mean sky can stand for.
fn derivative_of_direction(here: vec3<f32>, step: vec2<u32>) -> vec4<f32> {
    let before = textureLoad(record_sky, traced_pixel - step, 0);
    let after = textureLoad(record_sky, traced_pixel + step, 0);
    let joined = traced_neighbours(step);
    let has_before = joined.x && before.w != 0.0;
    let has_after = joined.y && after.w != 0.0;
    let first = select(here, before.xyz, has_before);
    let last = select(here, after.xyz, has_after);
    let difference = (last - first) * select(1.0, 0.5, has_before && has_after);
    return vec4<f32>(difference, select(0.0, 1.0, has_before || has_after));
}

// The turn of the sky direction to the neighbours at -+ step, on the side where it turns more: between two that are a
// whole turn apart it would seem to be none.
fn widest_turn(here: vec3<f32>, step: vec2<u32>) -> f32 {
    let before = textureLoad(record_sky, traced_pixel - step, 0);
    let after = textureLoad(record_sky, traced_pixel + step, 0);
    let joined = traced_neighbours(step);
    let back = select(0.0, length(before.xyz - here), joined.x && before.w != 0.0);
    return max(back, select(0.0, length(after.xyz - here), joined.y && after.w != 0.0));
}

fn place_of(crossing: vec4<f32>) -> EmissionPoint {
    return EmissionPoint(-log(crossing.x), crossing.z, crossing.w);
}

// The crossing of the plane of this order, if it is the disk's; else 0.
fn crossing_of_order(pixel: vec2<u32>, order: u32) -> vec4<f32> {
    let orders = unpack_meta(textureLoad(record_meta, pixel, 0)).orders;
    if (orders & (1u << order)) == 0u {
        return vec4<f32>(0.0);
    }
    return textureLoad(record_disk, pixel, countOneBits(orders & ((1u << order) - 1u)), 0);
}

// d(place) / d(pixel) of a crossing, from the crossings of its order at -+ step, as derivative_of_direction.
fn derivative_of_place(here: vec4<f32>, order: u32, step: vec2<u32>) -> EmissionPoint {
    let before = crossing_of_order(traced_pixel - step, order);
    let after = crossing_of_order(traced_pixel + step, order);
    let joined = traced_neighbours(step);
    let has_before = joined.x && before.x > 0.0;
    let has_after = joined.y && after.x > 0.0;
    if !has_before && !has_after {
        return EmissionPoint(1e30, 0.0, 0.0);
    }
    let share = select(1.0, 0.5, has_before && has_after);
    let first = place_of(select(here, before, has_before));
    let last = place_of(select(here, after, has_after));
    let turn = wrap_angle(last.azimuth - first.azimuth);
    return EmissionPoint(share * (last.ln_r - first.ln_r), share * turn, share * (last.delay - first.delay));
}
