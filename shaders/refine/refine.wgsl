// Kernel: shades `pass_.refined` samples of each pixel of a list of records/edges.wgsl, and hands their mean to
// take_light in place of the pixel's light. Mirrors src/cpu/refine.rs and src/scene/refine.rs, where the reasons are.
// Knows no way to make records.

#import constants
#import camera/observer
#import camera/projection
#import records/record
#import records/edges
#import shade/shade
#import shared/not_inlined
#import shared/frame
#import shared/pass
#requires fn ray_record(id: vec2<u32>) -> Record
#requires fn next_crossing() -> Crossing
#requires fn rewind_crossings()
#requires fn take_light(id: vec2<u32>, light: vec4<f32>)

// The samples of a pixel: 4 on edges of the disk, where the cover of each one's cell is computed (whole_plane); 32
// where the critical curve runs, as what lies beside it is too thin for that.
var<private> samples: u32;

const LANES: u32 = 64u;

// The sample of each thread: u of its crossings by order, 0 where there is none; its fate; its light.
var<workgroup> lane_u: array<f32, LANES * CROSSINGS_KEPT>;
var<workgroup> lane_fate: array<u32, LANES>;
var<workgroup> lane_light: array<vec4<f32>, LANES>;
var<workgroup> listed: u32;

var<private> lane: u32;

@compute @workgroup_size(64)
fn refine(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) i: u32) {
    unknown_zero = group.z;
    lane = i;
    samples = not_inlined(pass_.refined);
    whole_plane = samples == EDGE_SAMPLES;
    if i == 0u {
        let limit = arrayLength(&edges.pixels);
        listed = min(atomicLoad(&edges.counts[list_place(list_kind())]), limit);
    }
    let count = workgroupUniformLoad(&listed);
    let pixels = LANES / samples;
    for (var first = group.x * pixels; first < count; first += groups.x * pixels) {
        refine_sample(first + i / samples, count);
    }
}

// The sample of this thread in the list's pixel `entry`; beyond the list's end it shades the last one's and writes
// nothing.
fn refine_sample(entry: u32, count: u32) {
    let id = listed_pixel(list_kind(), min(entry, count - 1u));
    if whole_plane {
        sample_shift = quarter_place() - 0.5;
    } else {
        sample_shift = curve_place(across_curve(id)) - 0.5;
    }
    let record = ray_record(id);
    lane_fate[lane] = record.fate;
    for (var k = 0u; k < CROSSINGS_KEPT; k += 1u) {
        lane_u[lane * CROSSINGS_KEPT + k] = 0.0;
    }
    if whole_plane {
        for (var k = 0u; k < not_inlined(frame.max_crossings); k += 1u) {
            let crossing = next_crossing();
            if crossing.u <= 0.0 {
                break;
            }
            lane_u[lane * CROSSINGS_KEPT + min(crossing.order, CROSSINGS_KEPT - 1u)] = crossing.u;
        }
        rewind_crossings();
    }
    workgroupBarrier();
    lane_light[lane] = shade_record(id, record);
    workgroupBarrier();
    if entry < count && sample_index() == 0u {
        if whole_plane && is_ragged() {
            // It turns out to need the samples of EDGE_CURVE.
            note_edges(id, EDGE_CURVE);
        } else {
            take_light(id, mean_light());
        }
    }
    workgroupBarrier();
}

// The list of records/edges.wgsl that this dispatch goes over.
fn list_kind() -> u32 {
    return select(1u, 0u, whole_plane);
}

fn sample_index() -> u32 {
    return lane % samples;
}

// The place of this thread's sample in its pixel, 0 .. 1: the middle of its quarter.
fn quarter_place() -> vec2<f32> {
    return vec2<f32>(f32(lane & 1u), f32((lane >> 1u) & 1u)) * 0.5 + 0.25;
}

// The same in strips at right angles to `across`.
fn curve_place(across: vec2<f32>) -> vec2<f32> {
    const GOLDEN: f32 = 0.618033988749895;
    let i = f32(sample_index());
    let n = f32(samples);
    let along = fract((i - 0.5 * (n - 1.0)) * GOLDEN + 0.5);
    // Less is rounding, at the shadow's very centre.
    let normal = select(vec2<f32>(1.0, 0.0), across * inverseSqrt(dot(across, across)), dot(across, across) > 1e-30);
    let tangent = vec2<f32>(-normal.y, normal.x);
    let foot = normal * level_of_share((i + 0.5) / n, normal);
    let wide = select(vec2<f32>(1e-6), tangent, abs(tangent) > vec2<f32>(1e-6));
    let one = (-0.5 - foot) / wide;
    let other = (0.5 - foot) / wide;
    let begins = max(min(one, other), vec2<f32>(-1.0));
    let ends = min(max(one, other), vec2<f32>(1.0));
    return 0.5 + foot + tangent * mix(max(begins.x, begins.y), min(ends.x, ends.y), along);
}

// The level of which `share` is share_below.
fn level_of_share(share: f32, slope: vec2<f32>) -> f32 {
    let most = max(abs(slope.x), abs(slope.y));
    let least = min(abs(slope.x), abs(slope.y));
    let rest = min(share, 1.0 - share);
    let corner = sqrt(2.0 * most * least * rest);
    let size = select(0.5 * (most + least) - corner, (0.5 - rest) * most, 2.0 * most * rest >= least);
    return select(size, -size, share < 0.5);
}

// The direction at right angles to the circle about the shadow's centre that runs through the pixel, in pixels right
// and down.
fn across_curve(id: vec2<u32>) -> vec2<f32> {
    sample_shift = vec2<f32>(0.0);
    let at = pixel_place(id);
    let view = camera_view(at.x, at.y);
    let seen = aberrate(view.look);
    let centre = vec3<f32>(frame.e_r.w, frame.e_theta.w, frame.e_phi.w);
    // The components of a look direction's changes along it are no changes of it.
    let across_sight = centre - seen.n * dot(centre, seen.n);
    return vec2<f32>(dot(across_sight, aberrate_change(seen, view.dx)),
        dot(across_sight, aberrate_change(seen, view.dy)));
}

fn mean_light() -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var k = 0u; k < samples; k += 1u) {
        sum += lane_light[lane + k];
    }
    return sum / f32(samples);
}

fn seen_crossing() -> Crossing {
    var crossing = next_crossing();
    crossing.share = disk_covers(crossing.u);
    if whole_plane {
        crossing.share = covered_share(crossing.u, min(crossing.order, CROSSINGS_KEPT - 1u));
        // Where nothing shines g may be no number at all.
        let shines = crossing.share > 0.0 || (crossing.u >= frame.plane_u.x && crossing.u <= frame.plane_u.y);
        crossing.g = select(1.0, crossing.g, shines);
        crossing.u = select(0.0, clamp(crossing.u, frame.plane_u.x, frame.plane_u.y), crossing.u > 0.0);
    }
    return crossing;
}

// Share of this sample's cell, of 2 x 2, in which the crossing of `order` lies on the disk, u changing evenly over the
// cell.
fn covered_share(u: f32, order: u32) -> f32 {
    let left = lane_u[(lane & ~1u) * CROSSINGS_KEPT + order];
    let right = lane_u[(lane | 1u) * CROSSINGS_KEPT + order];
    let above = lane_u[(lane & ~2u) * CROSSINGS_KEPT + order];
    let below = lane_u[(lane | 2u) * CROSSINGS_KEPT + order];
    let slope = vec2<f32>(right - left, below - above);
    let within = select(0.0, 1.0, u >= frame.disk_u.x && u <= frame.disk_u.y);
    let share = share_below(frame.disk_u.y - u, slope) - share_below(frame.disk_u.x - u, slope);
    return select(within, clamp(share, 0.0, 1.0), min(min(left, right), min(above, below)) > 0.0);
}

// Share of a cell, 1 x 1 about its middle, in which slope . (x, y) <= level: the half-plane cuts a corner off, or two
// sides.
fn share_below(level: f32, slope: vec2<f32>) -> f32 {
    let most = max(max(abs(slope.x), abs(slope.y)), 1e-20);
    let least = min(abs(slope.x), abs(slope.y));
    let corner = max(0.5 * (most + least) - abs(level), 0.0);
    let cut = corner * corner / (2.0 * most * max(least, 1e-20));
    let by_corner = select(cut, 1.0 - cut, level > 0.0);
    return select(by_corner, 0.5 + level / most, abs(level) <= 0.5 * (most - least));
}

// How much u of the crossing of `order` may change between the samples of a pixel.
fn even_change(order: u32, high: f32) -> f32 {
    return min(EVEN_CHANGE * (frame.disk_u.y - frame.disk_u.x), select(1e30, DIRECT_CHANGE * high, order == 0u));
}

// For the first of a pixel's 4 lanes: whether what the pixel shows cannot change evenly from sample to sample.
fn is_ragged() -> bool {
    let far = frame.disk_u.x;
    let near = frame.disk_u.y;
    var hidden = false;
    var ragged = false;
    for (var k = 0u; k < min(not_inlined(frame.max_crossings), CROSSINGS_KEPT); k += 1u) {
        var low = 1e30;
        var high = 0.0;
        var present = 0u;
        for (var s = 0u; s < 4u; s += 1u) {
            let u = lane_u[(lane + s) * CROSSINGS_KEPT + k];
            present += select(0u, 1u, u > 0.0);
            low = min(low, select(1e30, u, u > 0.0));
            high = max(high, u);
        }
        let span = high - low;
        // A crossing that some do not have may be anywhere.
        let partial = present < 4u && 2.0 * high >= far && 0.7 * low <= near;
        let steep = present == 4u && span > even_change(k, high) && high + span >= far && low - span <= near;
        ragged = ragged || (!hidden && present > 0u && (partial || steep));
        hidden = hidden || (frame.disk.z >= 1.0 && present == 4u && low - span >= far && high + span <= near);
    }
    for (var s = 1u; s < 4u; s += 1u) {
        ragged = ragged || (!hidden && lane_fate[lane + s] != lane_fate[lane]);
    }
    return ragged;
}
