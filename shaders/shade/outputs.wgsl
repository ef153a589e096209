// SPDX-License-Identifier: MIT OR Apache-2.0
// Writes what hosts ask of a pixel's ray beside its light: one number or four for each output. Mirrors
// src/scene/output.rs, where they are defined. Knows neither how the record was made nor where the numbers go.

#import constants
#import camera/observer
#import camera/projection
#import emit/plane
#import records/record
#import shared/fate
#import shared/frame
#import shared/math
#import shade/wanted
#import shared/pass
#requires fn next_crossing() -> Crossing
#requires fn medium_before(k: u32) -> vec4<f32>
#requires fn with_sky(record: Record) -> Record
#requires fn wanted_output(k: u32) -> vec4<u32>
#requires fn output_count() -> u32
#requires fn output_crossings() -> u32
#requires fn put_numbers(k: u32, at: u32, place: vec2<u32>, bits: vec4<u32>)

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> pass_: Pass;
// The tables of light, as shade/shade.wgsl has them.
@group(0) @binding(2) var light_tables: texture_2d<f32>;

const NOTHING: u32 = 0x7fc00000u;
// From such an offset on, crossings have no delay.
const NO_DELAY: f32 = 1e37;
const INFINITE: u32 = 0x7f800000u;

fn light_table(i: u32) -> vec4<f32> {
    return textureLoad(light_tables, vec2<u32>(i % TABLE_WIDTH, i / TABLE_WIDTH), 0);
}

// Puts the numbers of output `k`, of the tile's pixel `id`, as bits: f32 constants may be neither NaN nor infinite.
fn put_output(k: u32, id: vec2<u32>, bits: vec4<u32>) {
    let to = outputs.places[k];
    put_numbers(k, to.x + id.y * to.y + id.x * wanted_output(k).z, to.zw + id, bits);
}

fn to_scene(v: vec3<f32>) -> vec3<f32> {
    return outputs.scene_x.xyz * v.x + outputs.scene_y.xyz * v.y + outputs.scene_z.xyz * v.z;
}

// The bits of the number that stands for an order where there is no crossing.
fn without_crossing(fate: u32) -> u32 {
    let in_sky = bitcast<u32>(-1.0);
    let captured = bitcast<u32>(-2.0);
    return select(select(NOTHING, captured, fate == FATE_CAPTURED), in_sky, fate == FATE_ESCAPED);
}

// The bits of the distance to what the ray meets first.
fn depth_of(fate: u32, first: Crossing, n: vec3<f32>) -> u32 {
    let mass = outputs.scene_x.w;
    if first.u > 0.0 && first.order == 0u {
        return bitcast<u32>(mass * crossing_distance(first));
    }
    return select(bitcast<u32>(mass * closest_approach(n)), INFINITE, first.u <= 0.0 && fate == FATE_ESCAPED);
}

fn crossing_output(kind: u32, crossing: Crossing) -> vec4<u32> {
    let mass = outputs.scene_x.w;
    if kind == OUTPUT_POSITION {
        return bitcast<vec4<u32>>(vec4<f32>(mass * to_scene(crossing_place(crossing)), f32(crossing.order)));
    }
    var bits = bitcast<vec4<u32>>(vec4<f32>(mass / crossing.u, crossing.place.azimuth, crossing.g,
        mass * (crossing.place.delay + frame.delay_offset)));
    bits.w = select(bits.w, NOTHING, frame.delay_offset >= NO_DELAY);
    return bits;
}

// The outputs that are no crossing's own; `whole`: the record with its sky, where somebody asks for that.
fn ray_output(kind: u32, seen: bool, whole: Record, first: Crossing, open: f32, look: vec3<f32>) -> vec4<u32> {
    let escaped = whole.fate == FATE_ESCAPED;
    var bits = vec4<u32>(NOTHING);
    switch kind {
        case OUTPUT_SKY: {
            let sky = bitcast<vec4<u32>>(vec4<f32>(to_scene(whole.sky), whole.sky_redshift));
            bits = select(vec4<u32>(0u), sky, seen && escaped);
        }
        case OUTPUT_TRANSMISSION: {
            bits.x = select(0u, bitcast<u32>(open), seen && escaped);
        }
        case OUTPUT_DEPTH: {
            bits.x = select(NOTHING, depth_of(whole.fate, first, aberrate(look).n), seen);
        }
        case OUTPUT_POSITION: {
            bits.w = select(NOTHING, without_crossing(whole.fate), seen);
        }
        case OUTPUT_REDSHIFT: {
            let elsewhere = select(NOTHING, bitcast<u32>(whole.sky_redshift), escaped);
            bits.x = select(NOTHING, select(elsewhere, bitcast<u32>(first.g), first.u > 0.0), seen);
        }
        case OUTPUT_ORDER: {
            let elsewhere = without_crossing(whole.fate);
            bits.x = select(NOTHING, select(elsewhere, bitcast<u32>(f32(first.order)), first.u > 0.0), seen);
        }
        case OUTPUT_DEFLECTION: {
            let chart = frame.placed_r * look.x + frame.placed_theta * look.y + frame.placed_phi * look.z;
            let angle = arctan2(length(cross(chart, whole.sky)), dot(chart, whole.sky));
            bits.x = select(NOTHING, bitcast<u32>(angle), seen && escaped);
        }
        default: {
        }
    }
    return bits;
}

fn take_record(id: vec2<u32>, record: Record) {
    let place = pixel_place(id);
    let seen = has_look_direction(place);
    var whole = record;
    if record.fate == FATE_ESCAPED && outputs.asks_sky != 0u {
        whole = with_sky(record);
    }
    var open = 1.0;
    var given = 0u;
    var first: Crossing;
    // max_crossings bounds what next_crossing gives, and outputs.crossings is no more.
    for (var k = 0u; k < output_crossings(); k += 1u) {
        var crossing = next_crossing();
        if crossing.u <= 0.0 {
            break;
        }
        crossing.share = disk_covers(crossing.u);
        if VOLUMES {
            open *= medium_before(k).w;
        }
        open *= 1.0 - plane_opacity(crossing);
        if k == 0u {
            first = crossing;
        }
        for (var i = 0u; i < output_count(); i += 1u) {
            let wanted = wanted_output(i);
            let of_crossing = wanted.x == OUTPUT_POSITION || wanted.x == OUTPUT_DISK;
            // Lanes that have left the loop may go on writing (Mesa 22.3): what they write must be no other's.
            if crossing.u > 0.0 && seen && of_crossing && wanted.y == k {
                put_output(i, id, crossing_output(wanted.x, crossing));
            }
        }
        given = k + 1u;
    }
    if VOLUMES {
        open *= medium_before(given).w;
    }
    let look = look_direction(place.x, place.y);
    for (var i = 0u; i < output_count(); i += 1u) {
        let wanted = wanted_output(i);
        let of_crossing = wanted.x == OUTPUT_POSITION || wanted.x == OUTPUT_DISK;
        if !(of_crossing && seen && wanted.y < given) {
            put_output(i, id, ray_output(wanted.x, seen, whole, first, open, look));
        }
    }
}
