// SPDX-License-Identifier: MIT OR Apache-2.0
// The filaments of matter with depth. Mirrors src/emit/filaments.rs, where the reasons are. A kernel declares
// `filament_texel`, which reads the block of `Filaments::levels`, a texture_3d<f32> of r16float: g at a place in
// periods, between texels and between whole levels, repeating along all sides. With a sampler that is linear between
// levels, too, it is one line:
//
//     return textureSampleLevel(filaments, repeating, place, level).x;

#import constants
#requires fn filament_texel(place: vec3<f32>, level: f32) -> f32
#requires fn level_variances(level: u32) -> vec2<f32>

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
    let beside = 1.0 - (faded.x - whole);
    let pair = level_variances(u32(whole));
    return faded.y * faded.y * (pair.y + beside * beside * (pair.x - pair.y));
}

// ln of the mean of e^g, where g has the standard deviation x.
fn filament_log_mean(x: f32) -> f32 {
    return x * x * (0.5 + x * (FILAMENT_SKEW + x * FILAMENT_KURTOSIS));
}
