// SPDX-License-Identifier: MIT OR Apache-2.0
// The structure of matter with depth. Mirrors src/emit/clouds.rs, where the reasons are; the struct is `CloudUniform`
// of src/gpu/frame/uniforms/clouds.rs. Knows no light and no ray.
//
// A kernel declares `clouds`, a buffer with one `Cloud` for each volume of the scene, and `baked_factor`, which reads
// the textures that emit/bake.wgsl made: the factor on the density of a volume at a place (turns, share of the rows,
// periods of the layers), between texels and between whole levels, counted from the finest one that is there.

#import constants
#import emit/shape
#import shared/math
#requires var clouds: Clouds
#requires fn baked_factor(index: u32, place: vec3<f32>, level: f32) -> f32

struct Cloud {
    // The standard deviation of ln P, which is 0 without structure.
    strength: f32,
    // ln of the factor on the temperature over ln of that on the density, and what is added.
    heat_power: f32,
    heat_log: f32,
    // The pattern's period in ln r.
    period: f32,
    // 1 over the thickness; 1 for a jet, else 0; and a jet's opening and radius.
    per_thickness: f32,
    is_jet: u32,
    opening: f32,
    radius: f32,
    // ln r where the rows of the grid begin, and 1 over the e-folds that they reach through.
    first_ln_r: f32,
    per_reach: f32,
    // Rows of the finest level an e-fold that are told from each other.
    seen_rows: f32,
    // The finest level that is there.
    finest: f32,
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

// Where matter has its structure; `carried`: dph/dt, and the change of ln r with time.
fn cloud_place(index: u32, at: CloudPlace, carried: vec2<f32>) -> vec3<f32> {
    let ln_r = log(at.r * max(1.0 - carried.y * at.later, LEAST_CARRIED));
    return vec3<f32>(
        (at.azimuth - carried.x * at.later) / TAU,
        (ln_r - clouds.volumes[index].first_ln_r) * clouds.volumes[index].per_reach,
        cloud_height(index, at.r, at.cos).x / FILAMENT_HEIGHT,
    );
}

// The texels of the grid's finest level that are not told from each other where a pixel is `footprint` wide, M.
fn cloud_blur(index: u32, r: f32, cosine: f32, footprint: f32) -> f32 {
    let texels = cloud_texels(index);
    let sin = sqrt(max((1.0 - cosine) * (1.0 + cosine), 1e-12));
    let around = texels.x / sin;
    let across = texels.z * cloud_height(index, r, cosine).y * sin;
    let finest = max(max(clouds.volumes[index].seen_rows, across), around);
    return max(max(CLOUD_SHARP * footprint / r * finest, around / max(texels.y, across)), 1.0);
}

// The factor on the density at a place, where so many texels of the finest level are not told from each other.
fn cloud_factor(index: u32, place: vec3<f32>, blur: f32) -> f32 {
    let level = log2(blur);
    let left = clamp(f32(FILAMENT_LAST) + 1.0 - level, 0.0, 1.0);
    return 1.0 + (baked_factor(index, place, max(level - clouds.volumes[index].finest, 0.0)) - 1.0) * left;
}

// The factors on density and temperature.
fn cloud_pattern(index: u32, at: CloudPlace, carried: vec2<f32>, footprint: f32) -> vec2<f32> {
    if clouds.volumes[index].strength <= 0.0 {
        return vec2<f32>(1.0);
    }
    let blur = cloud_blur(index, at.r, at.cos, footprint);
    let density = cloud_factor(index, cloud_place(index, at, carried), blur);
    let heat = clouds.volumes[index].heat_power * log(max(density, LEAST_FACTOR)) + clouds.volumes[index].heat_log;
    return vec2<f32>(density, exp(heat));
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
