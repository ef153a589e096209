// SPDX-License-Identifier: MIT OR Apache-2.0
// The streaks of the disk's turbulence in a patch of the disk. Mirrors src/emit/streaks.rs, where the reasons are. They
// are filtered by the hardware, whose weights have 8 bits: that changes light by less than a step of 255.

#import constants

// g and e^g, and their pyramid; repeats along both sides.
@group(0) @binding(7) var streaks: texture_2d<f32>;
@group(0) @binding(8) var repeating: sampler;

// ln of the mean of e^(s g) over each of a pixel's three parts, over that of the whole picture. The middle one lies
// about `place`, in periods (azimuth, ln r), the others the share `apart` of the side `cut` before and behind it; with
// 0 each is the whole pixel. cut, other: the pixel's sides in texels.
fn streak_exponents(s: vec3<f32>, place: vec2<f32>, apart: f32, cut: vec2<f32>, other: vec2<f32>) -> vec3<f32> {
    let dx = (1.0 - 2.0 * apart) * cut;
    let stretch2 = dot(dx, dx) + dot(other, other);
    let cross = dx.x * dx.y + other.x * other.y;
    let half_difference = 0.5 * (dx.x * dx.x + other.x * other.x - dx.y * dx.y - other.y * other.y);
    let half_split = sqrt(half_difference * half_difference + cross * cross);
    let finest = 1.0 / STREAK_TEXEL;
    let major = max(sqrt(0.5 * stretch2 + half_split), finest);
    let minor = max(max(abs(dx.x * other.y - dx.y * other.x) / major, major * (1.0 / STREAK_TAPS)), finest);
    let along = select(vec2<f32>(cross, half_split - half_difference),
        vec2<f32>(half_split + half_difference, cross), half_difference >= 0.0);
    // False for NaN.
    let known = stretch2 < STREAK_WHOLE;
    let level = select(f32(STREAK_LAST), clamp(round(log2(STREAK_TEXEL * minor)), 0.0, f32(STREAK_LAST)), known);
    let texel = exp2(level);
    let count = select(1.0, clamp(ceil(major / minor), 1.0, STREAK_TAPS), known);
    let spacing = sqrt(max(major * major - 3.0 * texel * texel, 0.0) / max(count * count - 1.0, 1.0));
    let texels = vec2<f32>(f32(STREAK_COLUMNS), f32(STREAK_ROWS));
    // An unknown patch has no direction: `along` is no number.
    let step = select(vec2<f32>(0.0), along * (spacing / max(length(along), 1e-30)), count > 1.0) / texels;
    let parted = apart > 0.0;
    let beside = apart * cut / texels;
    var middle = vec2<f32>(0.0);
    var before = vec2<f32>(0.0);
    var behind = vec2<f32>(0.0);
    for (var i = 0u; i < u32(count); i += 1u) {
        let tap = place + (f32(i) - 0.5 * (count - 1.0)) * step;
        middle += textureSampleLevel(streaks, repeating, tap, level).xy;
        if parted {
            before += textureSampleLevel(streaks, repeating, tap - beside, level).xy;
            behind += textureSampleLevel(streaks, repeating, tap + beside, level).xy;
        }
    }
    let mean = select(vec3<f32>(middle.x), vec3<f32>(before.x, middle.x, behind.x), parted) / count;
    let light = select(vec3<f32>(middle.y), vec3<f32>(before.y, middle.y, behind.y), parted) / count;
    let c = STREAK_CUMULANTS;
    let lost = (log(max(light, vec3<f32>(1e-3))) - mean) / (c.x + c.y + c.z);
    return s * mean + s * s * (c.x + s * (c.y + s * c.z)) * (lost - 1.0);
}
