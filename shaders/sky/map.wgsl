// SPDX-License-Identifier: MIT OR Apache-2.0
// The light of sky maps in a pixel. Mirrors src/sky/filter.rs, where the reasons are, on the texels of src/sky/map.rs.

#import constants
#import records/record
#import shared/math
#requires fn to_sky(d: vec3<f32>) -> vec3<f32>
#requires fn sampled(map: texture_2d<f32>, place: vec2<f32>, level: f32) -> vec3<f32>

// Whether maps have their levels as textures do, and a sampler filters them; else all levels lie in one
// (src/gpu/frame/resources/sky_maps.rs), and texels are read one by one.
override MAP_SAMPLER: bool = false;

// The patch of a pixel, and what taps it asks for: the direction of its major axis, sky axes; its axes, rad; the least
// texel that taps are taken from, rad.
struct Patch {
    axis: vec3<f32>,
    major: f32,
    minor: f32,
    least: f32,
}

// Taps in a row: their number; the pairs of them about the middle, of which the fraction is the outermost one's weight;
// the distance from each tap to the next, rad.
struct Row {
    count: u32,
    reach: f32,
    step: f32,
}

fn map_patch(footprint: Footprint) -> Patch {
    let dx = footprint.dx;
    let dy = footprint.dy;
    let xx = dot(dx, dx);
    let yy = dot(dy, dy);
    let xy = dot(dx, dy);
    let half_difference = 0.5 * (xx - yy);
    let half_split = sqrt(half_difference * half_difference + xy * xy);
    let stretch = max(sqrt(0.5 * (xx + yy) + half_split), TINY_AXIS);
    let squeezed = abs(dx.x * dy.y - dx.y * dy.x) / stretch;
    let along = select(vec2<f32>(xy, half_split - half_difference), vec2<f32>(half_split + half_difference, xy),
        half_difference >= 0.0);
    let axis = (dx * along.x + dy * along.y) / max(length(along) * stretch, 1e-36);
    let major = min(stretch, TAU);
    let spread = clamp(major * (1.0 / WIDE_TAP), MAX_SPREAD, MOST_SPREAD);
    if xx + yy < WHOLE_SKY {
        let direction = to_sky(footprint.p) * axis.x + to_sky(footprint.q) * axis.y;
        return Patch(direction, major, min(squeezed, major), major / spread);
    }
    return Patch(vec3<f32>(0.0), 0.0, 0.0, 1e15);
}

// Linear Rec. 709 radiance of a map, whose finest level is of `size`, in a pixel at rest. `d`: sky axes.
fn map_light(map: texture_2d<f32>, size: vec2<u32>, d: vec3<f32>, patch_: Patch) -> vec3<f32> {
    let texel = min(PI / f32(size.y), TAU / f32(size.x));
    let last = firstLeadingBit(size.x);
    let finest = SHORT_ROW * texel;
    let minor2 = max(patch_.minor * patch_.minor - finest * finest, 0.0);
    let tap = max(sqrt(texel * texel + minor2 / 3.0), patch_.least);
    let level = min(level_of(tap / texel), f32(last));
    let finer = u32(level);
    let share = level - f32(finer);
    // Each tap reads two levels, or one where the other has no share (of magnified maps): a turn for each, so that
    // lavapipe, which runs whatever an `if` leaves out, does not read it for nothing. A sampler reads both itself; its
    // weights have 8 bits on GPUs, which shows by a few steps of 255 in dark texels beside bright ones.
    let double = select(0u, 1u, share > 0.0 && !MAP_SAMPLER);
    let line = sqrt(max(patch_.major * patch_.major + 3.0 * (texel * texel - tap * tap), 0.0));
    let row = row_of_taps(line, tap);
    let count = row.count << double;
    let extent = f32(row.count) * row.step;
    let is_straight = extent * extent * (abs(d.z) + extent) < STRAIGHT * tap * length(d.xy);
    let begin = map_place(d);
    let step = straight_step(d, patch_.axis) * row.step;
    let first = 0.5 * f32(row.count - 1u);
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var k = 0u; k < count; k += 1u) {
        let coarser = k & double;
        let i = f32(k >> double) - first;
        let level_share = select(select(1.0 - share, share, coarser == 1u), 1.0, MAP_SAMPLER);
        let weight = level_share * clamp(row.reach + 0.5 - abs(i), 0.0, 1.0);
        var place = begin + step * i;
        if !is_straight && row.count > 1u {
            let turn = sincos(i * row.step);
            place = map_place(d * turn.y + patch_.axis * turn.x);
        }
        if MAP_SAMPLER {
            sum += weight * sampled(map, place, level);
        } else {
            sum += weight * map_bilinear(map, size, place, min(finer + coarser, last));
        }
        total += weight;
    }
    return sum / total;
}

// Taps with the variance of a line of `length`, taken from texels of `tap`; rad.
fn row_of_taps(length: f32, tap: f32) -> Row {
    let short = SHORT_ROW * tap;
    let longer = sqrt(max(length * length - short * short, 0.0));
    let reach = max(0.5 / TAP_SPACING * longer / tap, 1.0);
    let pairs = floor(reach);
    let outer = pairs + 0.5;
    let variance = (pairs * (4.0 * pairs * pairs - 1.0) / 12.0 + (reach - pairs) * outer * outer) / reach;
    if length <= short {
        return Row(1u, 1.0, 0.0);
    }
    return Row(2u * u32(ceil(reach)), reach, longer / sqrt(12.0 * variance));
}

// The level of texels that are `ratio` times as wide as the finest: exponent and mantissa.
fn level_of(ratio: f32) -> f32 {
    return f32(bitcast<u32>(max(ratio, 1.0)) - 0x3f800000u) / 8388608.0;
}

// (u, v) of a map, from a vector of any length but 0.
fn map_place(towards: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(
        0.5 - arctan2(towards.y, towards.x) / TAU,
        0.5 - arctan2(towards.z, sqrt(towards.x * towards.x + towards.y * towards.y)) / PI,
    );
}

// The change of the place of a direction off the poles, for a step of 1 rad along a unit vector at right angles to it.
fn straight_step(d: vec3<f32>, axis: vec3<f32>) -> vec2<f32> {
    let rho2 = max(d.x * d.x + d.y * d.y, 1e-30);
    return vec2<f32>((axis.x * d.y - axis.y * d.x) / (TAU * rho2), axis.z / (-PI * sqrt(rho2)));
}

// Where a level begins in the texture (level_place of src/gpu/frame/resources/sky_maps.rs).
fn level_place(finest: vec2<u32>, level: u32) -> vec2<i32> {
    let below = vec2<u32>(finest.x - (finest.x >> (max(level, 1u) - 1u)), finest.y);
    return vec2<i32>(select(below, vec2<u32>(0u), level == 0u));
}

// The finest level lies at the texture's begin with a sampler, too.
fn map_bilinear(map: texture_2d<f32>, finest: vec2<u32>, uv: vec2<f32>, level: u32) -> vec3<f32> {
    let size = vec2<i32>(max(finest >> vec2<u32>(level), vec2<u32>(1u)));
    let begin = level_place(finest, level);
    // Straight lines of taps go at most a small part of a turn beyond the seam, but at the poles, where rows are
    // constant.
    let place = vec2<f32>(uv.x - floor(uv.x), uv.y) * vec2<f32>(size) - 0.5;
    let corner = floor(place);
    let share = place - corner;
    let left = select(i32(corner.x), size.x - 1, corner.x < 0.0);
    let right = i32(corner.x) + 1;
    let columns = vec2<i32>(min(left, size.x - 1), select(right, 0, right >= size.x));
    let rows = clamp(vec2<i32>(i32(corner.y), i32(corner.y) + 1), vec2<i32>(0), vec2<i32>(size.y - 1));
    let a = textureLoad(map, begin + vec2<i32>(columns.x, rows.x), 0).xyz;
    let b = textureLoad(map, begin + vec2<i32>(columns.y, rows.x), 0).xyz;
    let c = textureLoad(map, begin + vec2<i32>(columns.x, rows.y), 0).xyz;
    let d = textureLoad(map, begin + vec2<i32>(columns.y, rows.y), 0).xyz;
    let above = a + (b - a) * share.x;
    let below = c + (d - c) * share.x;
    return above + (below - above) * share.y;
}
