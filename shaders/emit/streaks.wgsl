// SPDX-License-Identifier: MIT OR Apache-2.0
// The streaks of the disk's turbulence in a patch of the disk. Mirrors src/emit/streaks.rs, where the reasons are. They
// are filtered by the hardware, whose weights have 8 bits: that changes light by less than a step of 255.

#import constants

// g and e^g, and their pyramid; repeats along both sides.
@group(0) @binding(7) var streaks: texture_2d<f32>;
@group(0) @binding(8) var repeating: sampler;

// ln of the mean of e^(s g) over the patch about a place, over that of the whole picture. `place` in periods (azimuth,
// ln r); dx, dy: the patch's sides in texels.
fn streak_exponent(s: f32, place: vec2<f32>, dx: vec2<f32>, dy: vec2<f32>) -> f32 {
    let stretch2 = dot(dx, dx) + dot(dy, dy);
    let cross = dx.x * dx.y + dy.x * dy.y;
    let half_difference = 0.5 * (dx.x * dx.x + dy.x * dy.x - dx.y * dx.y - dy.y * dy.y);
    let half_split = sqrt(half_difference * half_difference + cross * cross);
    let finest = 1.0 / STREAK_TEXEL;
    let major = max(sqrt(0.5 * stretch2 + half_split), finest);
    let minor = max(max(abs(dx.x * dy.y - dx.y * dy.x) / major, major * (1.0 / STREAK_TAPS)), finest);
    let along = select(vec2<f32>(cross, half_split - half_difference),
        vec2<f32>(half_split + half_difference, cross), half_difference >= 0.0);
    // False for NaN.
    let known = stretch2 < STREAK_WHOLE;
    let level = select(f32(STREAK_LAST), clamp(round(log2(STREAK_TEXEL * minor)), 0.0, f32(STREAK_LAST)), known);
    let texel = exp2(level);
    let count = select(1.0, clamp(ceil(major / minor), 1.0, STREAK_TAPS), known);
    let apart = sqrt(max(major * major - 3.0 * texel * texel, 0.0) / max(count * count - 1.0, 1.0));
    // An unknown patch has no direction: `along` is no number.
    let step = select(vec2<f32>(0.0), along * (apart / max(length(along), 1e-30)), count > 1.0)
        / vec2<f32>(f32(STREAK_COLUMNS), f32(STREAK_ROWS));
    var sum = vec2<f32>(0.0);
    for (var i = 0u; i < u32(count); i += 1u) {
        let k = f32(i) - 0.5 * (count - 1.0);
        sum += textureSampleLevel(streaks, repeating, place + k * step, level).xy;
    }
    let seen = sum / count;
    let c = STREAK_CUMULANTS;
    let lost = (log(max(seen.y, 1e-3)) - seen.x) / (c.x + c.y + c.z);
    return s * seen.x + s * s * (c.x + s * (c.y + s * c.z)) * (lost - 1.0);
}
