// SPDX-License-Identifier: MIT OR Apache-2.0
// Makes a level of a sky map's pyramid from the host's texels, or from the level before. Mirrors src/sky/map.rs, where
// the reasons are: the mean over solid angle, then over as many columns as make a texel as wide on the sky as it is
// high. Knows no directions.

#import constants
#import shared/math
#import shared/not_inlined
#import sky/cube
#import sky/level
#requires fn source_row(y: u32) -> u32
#requires fn source_word(y: u32, at: u32) -> u32

@group(0) @binding(2) var<storage, read_write> level_words: array<u32>;

// 511 / 512 2^16.
const MOST_SKY_LIGHT: f32 = 65408.0;

// NaN and negative light become 0, infinite light the largest.
fn limited_light(v: vec3<f32>) -> vec3<f32> {
    return select(vec3<f32>(0.0), min(v, vec3<f32>(MOST_SKY_LIGHT)), v > vec3<f32>(0.0));
}

fn unpack_light(word: u32) -> vec3<f32> {
    let scale = bitcast<f32>(((word >> 27u) + 103u) << 23u);
    return vec3<f32>(vec3<u32>(word, word >> 9u, word >> 18u) & vec3<u32>(511u)) * scale;
}

fn pack_light(light: vec3<f32>) -> u32 {
    let rgb = limited_light(light);
    let top = max(rgb.x, max(rgb.y, rgb.z));
    var exponent = min(max(bitcast<u32>(top) >> 23u, 111u) - 111u, 31u);
    let first = u32(top * bitcast<f32>((151u - exponent) << 23u) + 0.5);
    exponent = select(exponent, exponent + 1u, first > 511u);
    let mantissas = min(vec3<u32>(rgb * bitcast<f32>((151u - exponent) << 23u) + 0.5), vec3<u32>(511u));
    return mantissas.x | (mantissas.y << 9u) | (mantissas.z << 18u) | (exponent << 27u);
}

// The light in the lower 16 bits, a half float. NaN and negative light are 0, infinite light is more than can be
// stored.
// (unpack2x16float takes a feature that not every device has.)
fn half_light(bits: u32) -> f32 {
    let exponent = (bits >> 10u) & 31u;
    let mantissa = bits & 1023u;
    let normal = bitcast<f32>(((exponent + 112u) << 23u) | (mantissa << 13u));
    // Multiples of 2^-24.
    let light = select(normal, f32(mantissa) * 5.960464477539063e-8, exponent == 0u);
    let nothing = (bits & 0x8000u) != 0u || (exponent == 31u && mantissa != 0u);
    return select(light, 0.0, nothing);
}

// A texel of the source.
fn source_light(x: u32, y: u32) -> vec3<f32> {
    let row = source_row(y);
    let source = not_inlined(level.source);
    if source == SKY_SOURCE_LEVEL {
        return unpack_light(source_word(y, row + x));
    }
    if source == SKY_SOURCE_FLOAT {
        let at = row + 4u * x;
        let bits = vec3<u32>(source_word(y, at), source_word(y, at + 1u), source_word(y, at + 2u));
        return limited_light(bitcast<vec3<f32>>(bits));
    }
    let at = row + 2u * x;
    let low = source_word(y, at);
    return limited_light(vec3<f32>(half_light(low), half_light(low >> 16u), half_light(source_word(y, at + 1u))));
}

// A cube's light in texel (x, y) of the map, whose middle column is forward, with longitudes to the right: the mean of
// four places, since at a cube's corners its texels are less than half as wide as the map's.
fn resampled_light(x: u32, y: u32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let quarter = vec2<f32>(vec2<u32>(i & 1u, i >> 1u)) * 0.5 + 0.25;
        let at = (vec2<f32>(vec2<u32>(x, y)) + quarter) / vec2<f32>(level.size);
        let longitude = 2.0 * PI * (at.x - 0.5);
        let latitude = PI * (0.5 - at.y);
        let east = sincos(longitude);
        let north = sincos(latitude);
        let p = vec3<f32>(north.y * east.x, north.x, north.y * east.y);
        sum += cube_light(p, level.source_size.y);
    }
    return 0.25 * sum;
}

// The source's light under column `x` of row `y`.
fn column_light(x: u32, y: u32) -> vec3<f32> {
    if not_inlined(level.cube) != 0u {
        return resampled_light(x, y);
    }
    let step = PI / f32(level.source_size.y);
    let begins = vec2<u32>(x, y) * level.source_size;
    let ends = begins + level.source_size;
    let first = begins / level.size;
    let last = min((ends + level.size - 1u) / level.size, level.source_size);
    // Relative to the first item, which keeps them exact enough.
    let low = vec2<f32>(begins - first * level.size) / vec2<f32>(level.size);
    let high = vec2<f32>(ends - first * level.size) / vec2<f32>(level.size);
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var j = first.y; j < last.y; j += 1u) {
        let at = f32(j - first.y);
        let begin = max(low.y, at);
        let end = min(high.y, at + 1.0);
        // cos(begin) - cos(end), without cancellation.
        let weight = sin(0.5 * (begin + end + 2.0 * f32(first.y)) * step) * sin(0.5 * (end - begin) * step);
        var row = vec3<f32>(0.0);
        for (var i = first.x; i < last.x; i += 1u) {
            let column = f32(i - first.x);
            let share = min(high.x, column + 1.0) - max(low.x, column);
            row += share * source_light(i, j);
        }
        sum += weight * row;
        total += weight;
    }
    return sum * (f32(level.size.x) / (f32(level.source_size.x) * total));
}

// The columns of a row that a workgroup has at hand; it makes as many texels.
var<workgroup> columns_at_hand: array<vec3<f32>, LEVEL_COLUMNS>;

// A row near a pole takes the mean over many columns, at the pole itself over all. So that threads do not each make all
// of them, those of a workgroup make some columns each, and then all take their share of these.
@compute @workgroup_size(LEVEL_COLUMNS)
fn make_level(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    unknown_zero = group.z;
    let size = level.size;
    let y = group.y + level.first_row;
    let colatitude = PI * (f32(y) + 0.5) / f32(size.y);
    let pole = y == 0u || y + 1u == size.y;
    let wide = f32(size.x) / (2.0 * f32(size.y) * sin(colatitude));
    let texels = select(min(wide, f32(size.x)), f32(size.x), pole);
    let whole = texels >= f32(size.x);
    let columns = i32(size.x);
    // The window of a texel: its first column, less the texel's, and its last.
    let first = select(i32(floor(0.5 - 0.5 * texels)), 0, texels <= 1.0);
    let last = select(i32(floor(0.5 + 0.5 * texels)), 0, texels <= 1.0);
    let corner = i32(group.x * LEVEL_COLUMNS);
    let most = i32(LEVEL_COLUMNS) - 1;
    let x = corner + i32(thread);
    // The columns of all the workgroup's windows.
    let begin = select(corner + first, 0, whole);
    let end = select(min(corner + most, columns - 1) + last, columns - 1, whole);
    var sum = vec3<f32>(0.0);
    var total = 0.0;
    for (var at = begin; at <= end; at += i32(LEVEL_COLUMNS)) {
        let own = at + i32(thread);
        columns_at_hand[thread] = vec3<f32>(0.0);
        if own <= end {
            columns_at_hand[thread] = column_light(u32((own + 2 * columns) % columns), y);
        }
        // Columns that lie wholly in every window of the workgroup are summed once, by twos.
        if whole || (at > corner + most + first && at + most < corner + last) {
            for (var half = LEVEL_COLUMNS / 2u; half > 0u; half /= 2u) {
                workgroupBarrier();
                if thread < half {
                    columns_at_hand[thread] += columns_at_hand[thread + half];
                }
            }
            workgroupBarrier();
            sum += columns_at_hand[0];
            total += f32(min(end - at, most) + 1);
            workgroupBarrier();
            continue;
        }
        workgroupBarrier();
        let from_column = max(at, x + first);
        let to_column = min(min(at + most, end), x + last);
        for (var k = from_column; k <= to_column; k += 1) {
            let covered = min(0.5 + 0.5 * texels, f32(k - x) + 1.0) - max(0.5 - 0.5 * texels, f32(k - x));
            let weight = select(covered, 1.0, texels <= 1.0);
            sum += weight * columns_at_hand[k - at];
            total += weight;
        }
        workgroupBarrier();
    }
    if x < columns {
        level_words[y * level.row - level.begin + u32(x)] = pack_light(sum / total);
    }
}
