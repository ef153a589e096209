// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: shades several samples of each pixel of the lists of records/edges.wgsl, and hands their mean to take_light
// in place of the pixel's light. Mirrors src/cpu/refine.rs and src/scene/refine.rs, where the reasons are. Knows no way
// to make records.
//
// Two rows of workgroups take the lists of EDGE_CURVE and EDGE_DISK, the longer rays first, so that others fill the
// time until the last of them ends. One row takes the pixels that the second of those listed.

#import constants
#import camera/observer
#import camera/projection
#import emit/clouds
#import records/record
#import records/edges
#import refine/cell
#import refine/strips
#import shade/shade
#import shared/fate
#import shared/math
#import shared/not_inlined
#import shared/frame
#import shared/pass
#requires fn ray_record(id: vec2<u32>) -> Record
#requires fn next_crossing() -> Crossing
#requires fn rewind_crossings()
#requires fn with_sky(record: Record) -> Record
#requires fn sample_turn() -> f32
#requires fn take_light(id: vec2<u32>, light: vec4<f32>)

// The structure of matter with depth: emit/clouds.wgsl.
// No uniform: lavapipe crashes with a fourth (shared/not_inlined.wgsl).
@group(0) @binding(10) var<storage, read> clouds: Clouds;
@group(0) @binding(11) var baked_0: texture_3d<f32>;
@group(0) @binding(12) var baked_1: texture_3d<f32>;
@group(0) @binding(13) var baked_2: texture_3d<f32>;
@group(0) @binding(14) var baked_3: texture_3d<f32>;
@group(0) @binding(15) var baked_sampler: sampler;

fn baked_factor(index: u32, place: vec3<f32>, level: f32) -> f32 {
    switch index {
        case 1u: { return textureSampleLevel(baked_1, baked_sampler, place, level).x; }
        case 2u: { return textureSampleLevel(baked_2, baked_sampler, place, level).x; }
        case 3u: { return textureSampleLevel(baked_3, baked_sampler, place, level).x; }
        default: { return textureSampleLevel(baked_0, baked_sampler, place, level).x; }
    }
}

// The list of records/edges.wgsl that this workgroup goes over, LIST_*.
var<private> list: u32;
// The samples of a pixel: 4, its quarters, or two in each of the strips along the critical curve, CURVE_SAMPLES or
// fewer.
var<private> samples: u32;

const LANES: u32 = 64u;
const NO_LANE: u32 = LANES;
// The orders of crossings that samples are compared by: images of higher ones are e^-pi as wide each, far below what
// shows. Every one takes workgroup memory, which bounds how many threads run at once.
const LANE_ORDERS: u32 = 8u;

// The sample of each thread: u of its crossings by order, 0 where there is none, and with FOOTPRINTS their azimuth and
// delay; its sky direction, and its fate as a number; how far it turned (sample_turn); its light times its share of the
// pixel.
var<workgroup> lane_u: array<f32, LANES * LANE_ORDERS>;
var<workgroup> lane_place: array<vec2<f32>, LANES * LANE_ORDERS>;
var<workgroup> lane_sky: array<vec4<f32>, LANES>;
var<workgroup> lane_turn: array<f32, LANES>;
var<workgroup> lane_light: array<vec4<f32>, LANES>;
// The numbers of the first pixel of the workgroup's list and of the one behind its last.
var<workgroup> listed: vec2<u32>;

var<private> lane: u32;
// The lanes of the samples before and after this one along the strip or row, and before and after across; NO_LANE
// where there is none.
var<private> beside: vec4<u32>;

@compute @workgroup_size(64)
fn refine(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) i: u32) {
    unknown_zero = group.z;
    lane = i;
    // Browsers want every thread of a workgroup to meet its barriers, and see it in values of the whole workgroup only,
    // not in variables of a thread.
    let groups_list = select(select(LIST_CURVE, LIST_DISK, group.y == 1u), LIST_RAGGED, groups.y == 1u);
    let samples_each = select(pass_.curve_samples, EDGE_SAMPLES, groups_list == LIST_DISK);
    list = groups_list;
    samples = not_inlined(samples_each);
    whole_plane = true;
    if i == 0u {
        listed = listed_pixels(list);
    }
    let ends = workgroupUniformLoad(&listed);
    let pixels = LANES / samples_each;
    for (var first = ends.x + group.x * pixels; first < ends.y; first += groups.x * pixels) {
        refine_sample(first + i / samples, ends.y);
    }
}

// The sample of this thread in the list's pixel `entry`; beyond the list's end it shades the last one's and writes
// nothing.
fn refine_sample(entry: u32, end: u32) {
    let id = listed_pixel(list, min(entry, end - 1u));
    let weight = go_to_cell(id);
    var record = ray_record(id);
    if record.fate == FATE_ESCAPED {
        record = with_sky(record);
    }
    lane_sky[lane] = vec4<f32>(record.sky, f32(record.fate));
    lane_turn[lane] = sample_turn();
    for (var k = 0u; k < LANE_ORDERS; k += 1u) {
        lane_u[lane * LANE_ORDERS + k] = 0.0;
    }
    for (var k = 0u; k < not_inlined(frame.max_crossings); k += 1u) {
        let crossing = next_crossing();
        if crossing.u <= 0.0 {
            break;
        }
        if crossing.order >= LANE_ORDERS {
            break;
        }
        let at = lane * LANE_ORDERS + crossing.order;
        lane_u[at] = crossing.u;
        if FOOTPRINTS {
            lane_place[at] = vec2<f32>(crossing.place.azimuth, crossing.place.delay);
        }
    }
    rewind_crossings();
    workgroupBarrier();
    if record.fate == FATE_ESCAPED {
        record.footprint = cell_footprint(record.sky);
    }
    lane_light[lane] = weight * shade_record(id, record);
    workgroupBarrier();
    if entry < end && sample_index() == 0u {
        if in_quarters() && needs_strips() {
            // Such a pixel needs the samples of EDGE_CURVE, which are taken later.
            note_ragged(id);
        } else {
            take_light(id, mean_light());
        }
    }
    workgroupBarrier();
}

fn in_quarters() -> bool {
    return samples == EDGE_SAMPLES;
}

// Whether the critical curve, and thin images with it, may cross this thread's pixel. go_to_cell sets it, so that
// level_about is called at one place only; in a pixel in quarters only for the first lane.
var<private> near_curve: bool;

// Cell::first_half of this thread's sample in a strip.
var<private> first_half: f32;

// Goes to the place of this thread's sample in the tile's pixel `id`; the share of the pixel that it stands for.
fn go_to_cell(id: vec2<u32>) -> f32 {
    sample_shift = vec2<f32>(0.0);
    var about = vec3<f32>(0.0);
    if !in_quarters() || sample_index() == 0u {
        go_to_pixel(pixel_place(id));
        about = level_about();
        near_curve = !(curve_distance(about) >= CURVE_REACH);
    }
    if in_quarters() {
        sample_shift = quarter_place() - 0.5;
        beside = beside_cell(true, true, 2u);
        return 0.25;
    }
    let strips = strips_of(about);
    let strip = sample_index() / 2u;
    let cell = strip_cell(strips);
    let outside = strip >= strips.captured;
    beside = beside_cell(strip > 0u && (strip > strips.captured || !outside),
        strip + 1u < strip_count() && (strip + 1u < strips.captured || outside), 2u);
    sample_shift = corrected_place(strips, cell) - 0.5;
    first_half = cell.first_half;
    return cell.weight;
}

// The lanes beside this one: one apart along the strip or row, `step` apart across, if they are `before` or `after`.
fn beside_cell(before: bool, after: bool, step: u32) -> vec4<u32> {
    let odd = (lane & 1u) != 0u;
    let second = (lane & 2u) != 0u;
    let along = select(vec2<u32>(NO_LANE, lane + 1u), vec2<u32>(lane - 1u, NO_LANE), odd);
    let has_before = before && (second || !in_quarters());
    let has_after = after && (!second || !in_quarters());
    return vec4<u32>(along, select(NO_LANE, lane - step, has_before), select(NO_LANE, lane + step, has_after));
}

// The place of this thread's sample in its pixel, 0 .. 1: the middle of its quarter.
fn quarter_place() -> vec2<f32> {
    return vec2<f32>(f32(lane & 1u), f32((lane >> 1u) & 1u)) * 0.5 + 0.25;
}

fn mean_light() -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var k = 0u; k < samples; k += 1u) {
        sum += lane_light[lane + k];
    }
    return sum;
}

// The footprint of this thread's cell about its sky direction, from the directions of those beside it.
fn cell_footprint(sky: vec3<f32>) -> Footprint {
    let dx = change_of_sky(sky, beside.xy);
    let dy = change_of_sky(sky, beside.zw);
    let across = with_whole_turns(dx.xyz, sky, change_of_turn(beside.xy));
    let along = with_whole_turns(dy.xyz, sky, change_of_turn(beside.zw));
    var footprint = footprint_of(sky, across, along);
    footprint.dx = select(vec2<f32>(1e30), footprint.dx, dx.w != 0.0);
    footprint.dy = select(vec2<f32>(1e30), footprint.dy, dy.w != 0.0);
    return footprint;
}

fn has_escaped(other: u32) -> bool {
    return lane_sky[other].w == f32(FATE_ESCAPED);
}

// The change of the sky direction from one cell to the next: central where the rays of both others escaped, else
// one-sided; w is 0 where none did.
fn change_of_sky(here: vec3<f32>, others: vec2<u32>) -> vec4<f32> {
    let lanes = min(others, vec2<u32>(LANES - 1u));
    let escaped = vec2<bool>(has_escaped(lanes.x), has_escaped(lanes.y));
    let there = escaped & (others < vec2<u32>(NO_LANE));
    let first = select(here, lane_sky[lanes.x].xyz, there.x);
    let last = select(here, lane_sky[lanes.y].xyz, there.y);
    return vec4<f32>((last - first) * select(1.0, 0.5, all(there)), select(0.0, 1.0, any(there)));
}

// The change of sample_turn from one cell to the next, as change_of_sky, if that spans more than half a turn; else 0.
fn change_of_turn(others: vec2<u32>) -> f32 {
    if !SPINNING {
        return 0.0;
    }
    let lanes = min(others, vec2<u32>(LANES - 1u));
    let escaped = vec2<bool>(has_escaped(lanes.x), has_escaped(lanes.y));
    let there = escaped & (others < vec2<u32>(NO_LANE));
    let here = lane_turn[lane];
    let first = select(here, lane_turn[lanes.x], there.x);
    let last = select(here, lane_turn[lanes.y], there.y);
    let known = abs(here) < UNKNOWN_TURN && abs(first) < UNKNOWN_TURN && abs(last) < UNKNOWN_TURN;
    let change = (last - first) * select(1.0, 0.5, all(there));
    return select(0.0, change, known && abs(last - first) > PI);
}

// A cell's change of the sky direction `d`, of which the part about the hole's axis is `turn`, unless that is 0.
fn with_whole_turns(change: vec3<f32>, d: vec3<f32>, turn: f32) -> vec3<f32> {
    let around = vec3<f32>(-d.y, d.x, 0.0);
    let length2 = max(dot(around, around), 1e-30);
    return change + around * select(turn - dot(change, around) / length2, 0.0, turn == 0.0);
}

// u of the crossing of `order` in a lane; 0 where there is none.
fn crossing_in(other: u32, order: u32) -> f32 {
    let known = lane_u[min(other, LANES - 1u) * LANE_ORDERS + min(order, LANE_ORDERS - 1u)];
    return select(0.0, known, other < NO_LANE && order < LANE_ORDERS);
}

// The change of a crossing's place from one cell to the next, as change_of_sky.
fn change_of_place(here: Crossing, order: u32, others: vec2<u32>) -> EmissionPoint {
    let u = vec2<f32>(crossing_in(others.x, order), crossing_in(others.y, order));
    let there = u > vec2<f32>(0.0);
    let lanes = min(others, vec2<u32>(LANES - 1u)) * LANE_ORDERS + min(order, LANE_ORDERS - 1u);
    let place = vec2<f32>(here.place.azimuth, here.place.delay);
    let from_u = select(here.u, u.x, there.x);
    let to_u = select(here.u, u.y, there.y);
    let change = select(place, lane_place[lanes.y], there.y) - select(place, lane_place[lanes.x], there.x);
    let share = select(1.0, 0.5, all(there));
    let known = EmissionPoint(share * log(from_u / to_u), share * wrap_angle(change.x), share * change.y);
    if any(there) {
        return known;
    }
    return EmissionPoint(1e30, 0.0, 0.0);
}

// The sample has its sky, with the footprint of its cell.
fn seen_sky(here: Record) -> Record {
    return here;
}

fn seen_crossing() -> Crossing {
    var crossing = next_crossing();
    if FOOTPRINTS && crossing.u > 0.0 {
        crossing.dx = change_of_place(crossing, crossing.order, beside.xy);
        crossing.dy = change_of_place(crossing, crossing.order, beside.zw);
    }
    return crossing;
}

// The light of a crossing over its cell, as crossing_emission: that of two parts, the halves of a strip's cell, or two
// ranges of u.
fn seen_emission(here: Record, crossing: Crossing, open: f32) -> vec4<f32> {
    let order = crossing.order;
    let others = vec4<f32>(crossing_in(beside.x, order), crossing_in(beside.y, order), crossing_in(beside.z, order),
        crossing_in(beside.w, order));
    let cell = cell_crossing(crossing.u, others);
    var emission = vec4<f32>(0.0);
    // Sums of light, and of it times the difference of u from the crossing's, and that squared.
    var lit = vec3<f32>(0.0);
    for (var i = 0u; i < not_inlined(2u); i += 1u) {
        var part = cell;
        var weight = 1.0;
        if !in_quarters() {
            part = half_cell(cell, f32(i) * 2.0 - 1.0);
            weight = select(first_half, 1.0 - first_half, i == 1u);
        }
        var levels = levels_on_disk(part);
        if in_quarters() {
            let middle = 0.5 * (levels.x + levels.y);
            levels = select(vec2<f32>(levels.x, middle), vec2<f32>(middle, levels.y), i == 1u);
        }
        let seen = covered(part, levels);
        if seen.x > 0.0 {
            var covering = crossing;
            covering.share = seen.x;
            covering.u = clamp(seen.y, frame.disk_u.x, frame.disk_u.y);
            covering.g = redshift_beside(here.energy, here.angular_momentum, here.sky_redshift * here.energy,
                covering.u, vec2<f32>(crossing.u, crossing.g));
            let light = weight * crossing_emission(here, covering, open);
            emission += light;
            let range = levels.y - levels.x;
            let spread2 = min(range * range, dot(part.du, part.du));
            let off = covering.u - crossing.u;
            lit += (light.x + light.y + light.z) * vec3<f32>(1.0, off, off * off + spread2 / 12.0);
        }
    }
    let mean = lit.yz / lit.x;
    let spread2 = dot(cell.du, cell.du);
    let extent = sqrt(12.0 * max(mean.y - mean.x * mean.x, 0.0) / spread2);
    let known = lit.x > 0.0 && spread2 > 0.0;
    lit_range = select(vec2<f32>(crossing.u, 1.0), vec2<f32>(crossing.u + mean.x, min(extent, 1.0)), known);
    return emission;
}

// 1/r about which the light of the crossing shaded last leaves, and the share that it has of the change of 1/r over the
// cell.
var<private> lit_range: vec2<f32>;

fn lit_crossing(crossing: Crossing) -> Crossing {
    if FOOTPRINTS {
        return lit_about(crossing, lit_range.x, lit_range.y);
    }
    return crossing;
}

// How much u of the crossing of `order` may change between the samples of a pixel.
fn even_change(order: u32, high: f32) -> f32 {
    return min(EVEN_CHANGE * (frame.disk_u.y - frame.disk_u.x), select(1e30, DIRECT_CHANGE * high, order == 0u));
}

// For the first of a pixel's 4 lanes: whether its quarters do not suffice.
fn needs_strips() -> bool {
    let evenness = quarters_evenness();
    if evenness != EVEN {
        return evenness == RAGGED;
    }
    // The critical curve and thin images may cross the pixel with all samples on one side.
    return near_curve;
}

// How evenly a pixel changes from one of its quarters to the next: so unevenly that more samples are needed.
const RAGGED: u32 = 0u;
const EVEN: u32 = 1u;
// Evenly, and the disk hides all that lies behind it.
const HIDDEN: u32 = 2u;

// For the first of a pixel's 4 lanes.
fn quarters_evenness() -> u32 {
    let far = frame.disk_u.x;
    let near = frame.disk_u.y;
    let opaque_u = opaque_u_at();
    var hidden = false;
    var ragged = false;
    for (var k = 0u; k < min(not_inlined(frame.max_crossings), LANE_ORDERS); k += 1u) {
        var low = 1e30;
        var high = 0.0;
        var present = 0u;
        for (var s = 0u; s < 4u; s += 1u) {
            let u = lane_u[(lane + s) * LANE_ORDERS + k];
            present += select(0u, 1u, u > 0.0);
            low = min(low, select(1e30, u, u > 0.0));
            high = max(high, u);
        }
        let span = high - low;
        // A crossing that some do not have goes through infinity, u = 0, on its way to them.
        let partial = present < 4u && PARTIAL_REACH * high >= far;
        let steep = present == 4u && span > even_change(k, high) && high + span >= far && low - span <= near;
        ragged = ragged || (!hidden && present > 0u && (partial || steep));
        hidden = hidden || (present == 4u && low - span >= opaque_u.x && high + span <= opaque_u.y);
    }
    for (var s = 1u; s < 4u; s += 1u) {
        ragged = ragged || (!hidden && lane_sky[lane + s].w != lane_sky[lane].w);
    }
    return select(select(EVEN, HIDDEN, hidden), RAGGED, ragged);
}
