// SPDX-License-Identifier: MIT OR Apache-2.0
// The filaments of matter with depth. Mirrors src/emit/filaments.rs, where the reasons are. A kernel declares
// `filament_texel`, which reads the block of `Filaments::levels`, a texture_3d<f32> of r16float: g at a place in
// periods, between texels and between whole levels, repeating along all sides. With a sampler that is linear between
// levels, too, it is one line:
//
//     return textureSampleLevel(filaments, repeating, place, level).x;

#import constants
#requires fn filament_texel(place: vec3<f32>, level: f32) -> f32

// A level of the pyramid, and the share of it that is left.
fn faded_level(level: f32) -> vec2<f32> {
    return vec2<f32>(clamp(level, 0.0, f32(FILAMENT_LAST)), clamp(1.0 + f32(FILAMENT_LAST) - level, 0.0, 1.0));
}

// g at a place, in periods (azimuth, ln r, height), of a level, which need not be a whole number.
fn filament_value(place: vec3<f32>, level: f32) -> f32 {
    let faded = faded_level(level);
    return filament_texel(place, faded.x) * faded.y;
}

// The variance of the values of a level.
fn filament_variance(level: f32) -> f32 {
    let faded = faded_level(level);
    let whole = floor(faded.x);
    let share = faded.x - whole;
    let fine = level_variance(u32(whole));
    let coarse = level_variance(min(u32(whole) + 1u, FILAMENT_LAST));
    return faded.y * faded.y * ((1.0 - share) * (1.0 - share) * fine + share * (2.0 - share) * coarse);
}

fn level_variance(level: u32) -> f32 {
    let fine = FILAMENT_FINE;
    let coarse = FILAMENT_COARSE;
    return select(fine[level & 3u], coarse[level & 3u], level >= 4u);
}

// ln of the mean of e^(k g) over a level whose values have the `variance`.
fn filament_log_mean(k: f32, variance: f32) -> f32 {
    let x2 = k * k * variance;
    let x = sqrt(x2);
    return x2 * (0.5 + x * (FILAMENT_SKEW + x * FILAMENT_KURTOSIS));
}
