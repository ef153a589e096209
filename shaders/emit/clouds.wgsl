// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of matter with depth. Mirrors src/emit/clouds.rs, where the reasons are; the struct is `CloudUniform`
// of src/gpu/frame/clouds.rs. Knows no light and no ray.
//
// A kernel declares `clouds`, a buffer with one `Cloud` for each volume of the scene, and `filament_texel` of
// emit/filaments; emit/volumes calls what is here.

#import constants
#import emit/bands
#import emit/filaments
#import emit/shape
#import shared/math
#requires var clouds: Clouds

struct Cloud {
    // The standard deviation of ln P, which is 0 without structure; clumping, heating; the period in ln r.
    structure: vec4<f32>,
    // 1 over the thickness; JET: opening, radius, and 1; else 0.
    shape: vec4<f32>,
    // Seed, number of the first band (i32), 1 if the angular velocity changes with the distance from the axis, else 0;
    // 0.
    pattern: vec4<u32>,
    // Age, time from birth to birth (f32), number of the youngest generation, drift (f32).
    bands: array<vec4<u32>, MOST_BANDS>,
}

struct Clouds {
    volumes: array<Cloud, MOST_VOLUMES>,
}

// Where and when matter is asked for: r, cos th, azimuth, M after the reference time.
struct CloudPlace {
    r: f32,
    cos: f32,
    azimuth: f32,
    later: f32,
}

// How far apart places must be to be told from each other: across the ray, M; along it, texels of the pattern.
struct Blur {
    footprint: f32,
    spacing: f32,
}

// The factors on density and temperature.
fn cloud_pattern(index: u32, at: CloudPlace, omega: f32, blur: Blur) -> vec2<f32> {
    let structure = clouds.volumes[index].structure;
    if structure.x <= 0.0 {
        return vec2<f32>(1.0);
    }
    let ln_r = log(at.r);
    let sin = sqrt(max((1.0 - at.cos) * (1.0 + at.cos), 1e-12));
    let height = cloud_height(index, at.r, at.cos);
    let texels = cloud_texels(index);
    let pattern = clouds.volumes[index].pattern;
    // Texels per rad: around, and across the shape.
    let around = texels.x / sin;
    let across = texels.z * height.y * sin;
    let least = max(CLOUD_SPACED * blur.spacing, around / max(texels.y, across));
    let widest = CLOUD_SHARP * blur.footprint / at.r;
    let lean = select(0.0, abs(at.cos) / sin, pattern.z == 1u);

    let shown = bands_at(ln_r);
    let first = band_index(shown.first, bitcast<i32>(pattern.y));
    let next = band_index(shown.first + 1, bitcast<i32>(pattern.y));
    let bands = array<vec4<u32>, 2>(clouds.volumes[index].bands[first], clouds.volumes[index].bands[next]);
    let alive = array<Generations, 2>(generations(bands[0], at.later), generations(bands[1], at.later));
    let count = alive[0].count + select(0u, alive[1].count, shown.count == 2u);
    var sum = 0.0;
    var lost = vec2<f32>(0.0);
    // One loop over the generations of both bands: lavapipe's run through all loops of a thread 65535 times at most.
    for (var k = 0u; k < count; k += 1u) {
        var band = bands[0];
        var of_band = alive[0];
        var share = shown.shares.x;
        var number = shown.first;
        var old = k;
        if k >= alive[0].count {
            band = bands[1];
            of_band = alive[1];
            share = shown.shares.y;
            number += 1;
            old -= alive[0].count;
        }
        let weight = share * select(of_band.weights.x, of_band.weights.y, old == 1u);
        let age = of_band.young + f32(old) * bitcast<f32>(band.y);
        let key = generation_key(number, of_band.youngest - old, pattern.x);
        let wound = texels.x * SHEAR * abs(omega) * age;
        let leaning = wound * lean;
        let outwards = sqrt(texels.y * texels.y + wound * wound);
        let upwards = sqrt(across * across + leaning * leaning);
        let seen = max(widest * max(max(outwards, upwards), around), max(wound, leaning) / (WOUND * texels.y));
        let level = max(log2(max(seen, least)), 0.0);
        let from_seed = vec3<f32>(vec3<u32>(key & 0xffffu, key >> 16u, mix_bits(key) & 0xffffu)) / 65536.0;
        let place = from_seed + vec3<f32>(
            (at.azimuth - omega * age) / TAU,
            (ln_r - bitcast<f32>(band.w) * age) / structure.w,
            height.x / FILAMENT_HEIGHT,
        );
        let s = structure.x * weight;
        sum += s * filament_value(place, level);
        let variance = filament_variance(level);
        lost += vec2<f32>(filament_log_mean(structure.y * s, variance), filament_log_mean(s, variance));
    }
    return exp(vec2<f32>(structure.y * sum - lost.x, structure.z * (sum - lost.y)));
}

// A coordinate across the shape that matter keeps while it moves, and its change with cos th.
fn cloud_height(index: u32, r: f32, c: f32) -> vec2<f32> {
    let shape = clouds.volumes[index].shape;
    if shape.w == 0.0 {
        return vec2<f32>(c * shape.x, shape.x);
    }
    let side = select(OPPOSITE, -OPPOSITE, c < 0.0);
    return vec2<f32>((abs(c) - jet_wall(r, shape.y, shape.z)) * shape.x + side, shape.x);
}

// Texels of the finest level per rad of azimuth, per e-fold of the radius and per thickness.
fn cloud_texels(index: u32) -> vec3<f32> {
    return vec3<f32>(FILAMENT_COLUMNS / TAU, FILAMENT_ROWS / clouds.volumes[index].structure.w,
        FILAMENT_LAYERS / FILAMENT_HEIGHT);
}

// The most texels of the finest level that a stretch of a ray passes, along which 1/r goes from u.x to u.y, cos th from
// c.x to c.y, and which sweeps the angle `swept`. 0 without structure.
fn cloud_passed(index: u32, u: vec2<f32>, c: vec2<f32>, swept: f32) -> f32 {
    if clouds.volumes[index].structure.x <= 0.0 {
        return 0.0;
    }
    let texels = cloud_texels(index);
    let height = cloud_height(index, 1.0 / u.x, c.x);
    let climb = cloud_height(index, 1.0 / u.y, c.y).x - height.x;
    let sheared = texels.x * HALF_SHEARED;
    let sin = sqrt(max(1.0 - max(c.x * c.x, c.y * c.y), 0.0));
    let around = swept * min(texels.x / max(sin, 0.05), max(texels.y, texels.z * height.y * sin));
    let outwards = log(u.x / u.y) * sqrt(texels.y * texels.y + sheared * sheared);
    let across = climb * texels.z;
    return sqrt(outwards * outwards + across * across + around * around);
}

// The number of samples that the texels `passed` at the radius r want, where a pixel is `footprint` wide.
fn cloud_samples(index: u32, passed: f32, r: f32, footprint: f32) -> f32 {
    let texels = cloud_texels(index);
    let sheared = texels.x * HALF_SHEARED;
    let finest = max(sqrt(texels.y * texels.y + sheared * sheared), texels.z * clouds.volumes[index].shape.x);
    return passed / (CLOUD_SPACING * max(CLOUD_COARSE * footprint / r * finest, 1.0));
}

// The share of the places that structure wants, where what is in front lets the share `through` of the light pass, and
// it sends the share `weight` of what it might.
fn cloud_worth(through: f32, weight: f32) -> f32 {
    return max(pow(max(through * weight, 1e-30), WORTH), LEAST_WORTH);
}

// The angle by which a ray with the impact parameter `b` has been bent between two radii, of which `swept` is that
// about the hole. `passed`: it came closer to the hole in between.
fn cloud_bend(swept: f32, b: f32, begin: f32, end: f32, passed: bool) -> f32 {
    let x = arctan2(sqrt(max(begin * begin - b * b, 0.0)), b);
    let y = arctan2(sqrt(max(end * end - b * b, 0.0)), b);
    return max(swept - select(abs(x - y), x + y, passed), 0.0);
}

// The width that a pixel sees of matter at r = `end`, from r = `begin` at a distance, M.
fn cloud_footprint(pixel_angle: f32, distance: f32, b: f32, begin: f32, end: f32, bend: f32) -> f32 {
    let parted = begin * end / max(b, LEAST_B) * max(exp(bend + 0.4) - 1.5 - 0.5 * bend, 0.0);
    return pixel_angle * sqrt(distance * (distance + parted));
}
