// SPDX-License-Identifier: MIT OR Apache-2.0
// Ray records of traced pixels: reads what traced/pixels.wgsl wrote.

#import constants
#import records/record
#import shared/frame
#import traced/footprints
#import traced/layout

// The crossings of the record at hand that were not given yet, as bits, and the layer of the next.
var<private> traced_orders: u32;
var<private> traced_layer: u32;

fn ray_record(id: vec2<u32>) -> Record {
    set_traced_pixel(id);
    let m = unpack_meta(textureLoad(record_meta, traced_pixel, 0));
    traced_orders = m.orders;
    traced_layer = 0u;
    var record = Record(m.fate, m.steps, m.energy, m.angular_momentum, m.polar_momentum / frame.observer_u, m.energy,
        0.0, vec3<f32>(0.0), UNKNOWN_FOOTPRINT);
    if m.fate == FATE_ESCAPED {
        let sky = textureLoad(record_sky, traced_pixel, 0);
        record.sky = sky.xyz;
        record.sky_redshift = sky.w;
    }
    return record;
}

fn with_sky(record: Record) -> Record {
    var whole = record;
    whole.footprint = sky_footprint(record.sky, record.sky);
    return whole;
}

fn next_crossing() -> Crossing {
    var crossing: Crossing;
    if !PLANE || traced_orders == 0u {
        return crossing;
    }
    crossing.order = firstTrailingBit(traced_orders);
    traced_orders &= traced_orders - 1u;
    let here = textureLoad(record_disk, traced_pixel, traced_layer, 0);
    traced_layer += 1u;
    crossing.u = here.x;
    crossing.g = here.y;
    crossing.place = place_of(here);
    if FOOTPRINTS {
        crossing.dx = derivative_of_place(here, crossing.order, vec2<u32>(1u, 0u));
        crossing.dy = derivative_of_place(here, crossing.order, vec2<u32>(0u, 1u));
    }
    return crossing;
}

fn medium_before(k: u32) -> vec4<f32> {
    return textureLoad(record_disk, traced_pixel, frame.medium_layer + k, 0);
}

fn more_crossings() -> bool {
    return traced_orders != 0u;
}

// A pixel whose neighbour's ray meets other things, or the same inside the disk's edge and not outside: one that
// misses a thin ring on one side of it and one that does on the other differ, too.
fn edges_of_pixel(through: f32, turn: f32) -> u32 {
    let here = textureLoad(record_meta, traced_pixel, 0).x;
    let across = vec2<u32>(1u, 0u);
    let down = vec2<u32>(0u, 1u);
    let kinds = vec4<u32>(edge_between(here, traced_pixel - across), edge_between(here, traced_pixel + across),
        edge_between(here, traced_pixel - down), edge_between(here, traced_pixel + down));
    let beside = select(vec2<u32>(EDGE_NONE), kinds.xy, traced_joined);
    var widest = 0.0;
    if turn > 0.0 {
        let sky = textureLoad(record_sky, traced_pixel, 0).xyz;
        widest = length(vec2<f32>(widest_turn(sky, across), widest_turn(sky, down)));
    }
    let inside = max(turning_edge(widest), select(EDGE_NONE, EDGE_DISK, is_steep(here >> 16u)));
    return max(inside, max(max(beside.x, beside.y), max(kinds.z, kinds.w)));
}

// Whether u of the first of a pixel's crossings, whose orders are the bits, changes steeply to the next pixels.
fn is_steep(orders: u32) -> bool {
    if !PLANE || orders == 0u {
        return false;
    }
    let order = firstTrailingBit(orders);
    let here = crossing_of_order(traced_pixel, order).x;
    let right = select(here, crossing_of_order(traced_pixel + vec2<u32>(1u, 0u), order).x, traced_joined.y);
    let below = crossing_of_order(traced_pixel + vec2<u32>(0u, 1u), order).x;
    return abs(right - here) + abs(below - here) > steep_change(here);
}

fn edge_between(here: u32, pixel: vec2<u32>) -> u32 {
    let there = textureLoad(record_meta, pixel, 0).x;
    let fates = vec2<u32>(here & 3u, there & 3u);
    let parted = fates.x != fates.y && fates.x != FATE_HIDDEN && fates.y != FATE_HIDDEN;
    return select(select(EDGE_NONE, EDGE_DISK, here != there), EDGE_CURVE, parted);
}

// No record is pending here.
fn defer_pixel(id: vec2<u32>) {
}
