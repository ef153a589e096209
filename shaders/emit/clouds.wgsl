// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of matter with depth. Mirrors src/emit/clouds.rs, where the reasons are; the struct is `CloudUniform`
// of src/gpu/frame/uniforms/clouds.rs. Knows no light and no ray.
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
    // The standard deviation of ln P, which is 0 without structure.
    strength: f32,
    clumping: f32,
    heating: f32,
    // The pattern's period in ln r.
    period: f32,
    // 1 over the thickness; 1 for a jet, else 0; and a jet's opening and radius.
    per_thickness: f32,
    is_jet: u32,
    opening: f32,
    radius: f32,
    seed: u32,
    // The number of the first band.
    first_band: i32,
    // 1 if the angular velocity changes with the distance from the axis, else 0.
    leans: u32,
    unused: u32,
    bands: array<Band, MOST_BANDS>,
}

struct Clouds {
    volumes: array<Cloud, MOST_VOLUMES>,
    // The variance of each level of the filaments and of the next one; 0, 0.
    variances: array<vec4<f32>, FILAMENT_LEVELS>,
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

// The factors on density and temperature. The two generations of a band go side by side, in the components of vectors,
// also where one has the weight 0: GPUs then wait for both at once.
fn cloud_pattern(index: u32, at: CloudPlace, omega: f32, blur: Blur) -> vec2<f32> {
    let strength = clouds.volumes[index].strength;
    if strength <= 0.0 {
        return vec2<f32>(1.0);
    }
    let clumping = clouds.volumes[index].clumping;
    let ln_r = log(at.r);
    let sin2 = max((1.0 - at.cos) * (1.0 + at.cos), 1e-12);
    let sin = sqrt(sin2);
    let height = cloud_height(index, at.r, at.cos);
    let texels = cloud_texels(index);
    let seed = clouds.volumes[index].seed;
    // Texels per rad: around, and across the shape. Names that end with 2 are squares, which spare roots.
    let around = texels.x / sin;
    let across = texels.z * height.y * sin;
    let least = max(CLOUD_SPACED * blur.spacing, around / max(texels.y, across));
    let widest = CLOUD_SHARP * blur.footprint / at.r;
    let lean2 = select(0.0, at.cos * at.cos / sin2, clouds.volumes[index].leans == 1u);
    let wound_texels = 1.0 / (WOUND * texels.y);

    let shown = bands_at(ln_r);
    var sum = 0.0;
    var lost = vec2<f32>(0.0);
    for (var k = 0u; k < shown.count; k += 1u) {
        let number = shown.first + i32(k);
        let band = clouds.volumes[index].bands[band_index(number, clouds.volumes[index].first_band)];
        let alive = generations(band, at.later);
        let age = alive.young + vec2<f32>(0.0, band.spacing);
        let keys = vec2<u32>(generation_key(number, alive.youngest, seed),
            generation_key(number, alive.youngest - 1u, seed));
        let wound = (texels.x * SHEAR * abs(omega)) * age;
        let wound2 = wound * wound;
        let leaning2 = lean2 * wound2;
        let finest2 = max(max(texels.y * texels.y + wound2, across * across + leaning2), vec2<f32>(around * around));
        let seen2 = max(widest * widest * finest2, wound_texels * wound_texels * max(wound2, leaning2));
        let level = max(0.5 * log2(max(seen2, vec2<f32>(least * least))), vec2<f32>(0.0));
        let turns = (at.azimuth - omega * age) / TAU;
        let rows = (ln_r - band.drift * age) / clouds.volumes[index].period;
        let layer = height.x / FILAMENT_HEIGHT;
        let young = vec3<f32>(turns.x, rows.x, layer) + cloud_shift(keys.x);
        let old = vec3<f32>(turns.y, rows.y, layer) + cloud_shift(keys.y);
        let s = strength * select(shown.shares.x, shown.shares.y, k == 1u) * alive.weights;
        sum += dot(s, vec2<f32>(filament_value(young, level.x), filament_value(old, level.y)));
        let deviation = s * sqrt(vec2<f32>(filament_variance(level.x), filament_variance(level.y)));
        lost += vec2<f32>(filament_log_mean(clumping * deviation.x), filament_log_mean(deviation.x))
            + vec2<f32>(filament_log_mean(clumping * deviation.y), filament_log_mean(deviation.y));
    }
    return exp(vec2<f32>(clumping * sum - lost.x, clouds.volumes[index].heating * (sum - lost.y)));
}

// The place of a generation in the block, in periods, from the bits of it.
fn cloud_shift(key: u32) -> vec3<f32> {
    return vec3<f32>(vec3<u32>(key & 0xffffu, key >> 16u, mix_bits(key) & 0xffffu)) / 65536.0;
}

fn level_variances(level: u32) -> vec2<f32> {
    return clouds.variances[level].xy;
}

// A coordinate across the shape that matter keeps while it moves, and its change with cos th.
fn cloud_height(index: u32, r: f32, c: f32) -> vec2<f32> {
    let per_thickness = clouds.volumes[index].per_thickness;
    if clouds.volumes[index].is_jet == 0u {
        return vec2<f32>(c * per_thickness, per_thickness);
    }
    let wall = jet_wall(r, clouds.volumes[index].opening, clouds.volumes[index].radius);
    let side = select(OPPOSITE, -OPPOSITE, c < 0.0);
    return vec2<f32>((abs(c) - wall) * per_thickness + side, per_thickness);
}

// Texels of the finest level per rad of azimuth, per e-fold of the radius and per thickness.
fn cloud_texels(index: u32) -> vec3<f32> {
    return vec3<f32>(FILAMENT_COLUMNS / TAU, FILAMENT_ROWS / clouds.volumes[index].period,
        FILAMENT_LAYERS / FILAMENT_HEIGHT);
}

// The most texels of the finest level that a stretch of a ray passes, along which 1/r goes from u.x to u.y, cos th from
// c.x to c.y, and which sweeps the angle `swept`. 0 without structure.
fn cloud_passed(index: u32, u: vec2<f32>, c: vec2<f32>, swept: f32) -> f32 {
    if clouds.volumes[index].strength <= 0.0 {
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
    let finest = max(sqrt(texels.y * texels.y + sheared * sheared), texels.z * clouds.volumes[index].per_thickness);
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
