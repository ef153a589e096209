// The light of sky maps in a pixel. Mirrors src/sky/filter.rs, where the reasons are, on the texels of src/sky/map.rs.
// They are read one by one, as the weights of samplers have but 8 bits.

#import constants
#import records/record
#import shared/blackbody
#import shared/math
#requires fn to_sky(d: vec3<f32>) -> vec3<f32>

// A line of taps across a pixel's patch: in levels of texels of 1 rad; from tap to tap, sky axes; length in steps.
struct Taps {
    level: f32,
    step: vec3<f32>,
    spread: f32,
}

fn map_taps(footprint: Footprint) -> Taps {
    let dx = footprint.dx;
    let dy = footprint.dy;
    let stretch2 = dot(dx, dx) + dot(dy, dy);
    let cross = dx.x * dx.y + dy.x * dy.y;
    let half_difference = 0.5 * (dx.x * dx.x + dy.x * dy.x - dx.y * dx.y - dy.y * dy.y);
    let half_split = sqrt(half_difference * half_difference + cross * cross);
    let major = max(sqrt(0.5 * stretch2 + half_split), TINY_AXIS);
    let minor = max(abs(dx.x * dy.y - dx.y * dy.x) / major, major * (1.0 / sqrt(1.0 + MAX_SPREAD * MAX_SPREAD)));
    let ratio = major / minor;
    let along = select(vec2<f32>(cross, half_split - half_difference),
        vec2<f32>(half_split + half_difference, cross), half_difference >= 0.0);
    let axis = along * (minor / max(length(along), 1e-30));
    if stretch2 < WHOLE_SKY {
        return Taps(log2(minor), to_sky(footprint.p) * axis.x + to_sky(footprint.q) * axis.y,
            sqrt(max(ratio * ratio - 1.0, 0.0)));
    }
    return Taps(1e3, vec3<f32>(0.0), 0.0);
}

// Linear Rec. 709 radiance of a map, whose finest level is of `size`, in a pixel at rest. `d`: sky axes.
fn map_light(map: texture_2d<f32>, size: vec2<u32>, d: vec3<f32>, taps: Taps) -> vec3<f32> {
    let texel_angle = min(PI / f32(size.y), TAU / f32(size.x));
    let last = firstLeadingBit(size.x);
    let level = clamp(taps.level - log2(texel_angle), 0.0, f32(last));
    let finer = min(u32(level), last);
    let share = level - f32(finer);
    // Each tap reads two levels, or one where the other has no share (of magnified maps): a turn for each, so that
    // lavapipe, which runs whatever an `if` leaves out, does not read it for nothing.
    let double = select(0u, 1u, share > 0.0);
    let reach = 0.5 * taps.spread + 0.5;
    let most = ceil(reach) - 1.0;
    let count = (1u + 2u * u32(most)) << double;
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var k = 0u; k < count; k += 1u) {
        let coarser = k & double;
        let i = f32(k >> double) - most;
        let weight = clamp(reach - abs(i), 0.0, 1.0) * select(1.0 - share, share, coarser == 1u);
        sum += weight * map_bilinear(map, size, map_place(d + taps.step * i), min(finer + coarser, last));
        total += weight;
    }
    return sum / total;
}

// (u, v) of a map, from a vector of any length but 0.
fn map_place(towards: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(
        0.5 - arctan2(towards.y, towards.x) / TAU,
        0.5 - arctan2(towards.z, sqrt(towards.x * towards.x + towards.y * towards.y)) / PI,
    );
}

// Where a level begins in the texture (level_place of src/gpu/frame/sky_maps.rs).
fn level_place(finest: vec2<u32>, level: u32) -> vec2<i32> {
    let below = vec2<u32>(finest.x - (finest.x >> (max(level, 1u) - 1u)), finest.y);
    return vec2<i32>(select(below, vec2<u32>(0u), level == 0u));
}

fn map_bilinear(map: texture_2d<f32>, finest: vec2<u32>, uv: vec2<f32>, level: u32) -> vec3<f32> {
    let size = vec2<i32>(max(finest >> vec2<u32>(level), vec2<u32>(1u)));
    let begin = level_place(finest, level);
    let place = uv * vec2<f32>(size) - 0.5;
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

fn shifted_map_light(rgb: vec3<f32>, g_colour: f32, g_beaming: f32) -> vec3<f32> {
    // Most of the Milky Way is black.
    if all(rgb == vec3<f32>(0.0)) {
        return vec3<f32>(0.0);
    }
    let temperature = colour_temperature(log(max(rgb.z, TINY_LIGHT) / max(rgb.x, TINY_LIGHT)));
    let rest = blackbody_lookup(BLACKBODY_OFFSET, temperature);
    let log_reference = rest.w + log(temperature);
    let seen = shifted_blackbody(temperature, log_reference, g_colour, g_beaming);
    return min(rgb * (seen / into_gamut(rest.xyz)), vec3<f32>(MAX_MAP_LIGHT));
}

fn colour_temperature(ln_ratio: f32) -> f32 {
    let x = clamp(ln_ratio, COOLEST_RATIO, HOTTEST_RATIO);
    return 1000.0 / (0.1529064 + x * (-0.1022545
        + x * (-0.005097082 + x * (-0.005358591 + x * (-0.003424309 + x * -0.0005964595)))));
}
