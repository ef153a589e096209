// SPDX-License-Identifier: MIT OR Apache-2.0
// Limits radiance to the range of a pixel, and encodes it by the sRGB curve. Mirrors src/film/mod.rs, where the
// formulas and reasons are.

// Tells NaN by its bits: a comparison of floats may be compiled as if there were none.
fn is_nan(v: vec3<f32>) -> vec3<bool> {
    return (bitcast<vec3<u32>>(v) & vec3<u32>(0x7fffffffu)) > vec3<u32>(0x7f800000u);
}

fn limited(v: vec3<f32>, most: f32) -> vec3<f32> {
    return select(clamp(v, vec3<f32>(0.0), vec3<f32>(most)), vec3<f32>(0.0), is_nan(v));
}

fn srgb_encode(linear: vec3<f32>) -> vec3<f32> {
    let t = 1.0 - sqrt(sqrt(linear));
    var p = t * -0.05286597 + 0.0934509;
    p = p * t - 0.08328923;
    p = p * t + 0.021440784;
    p = p * t - 0.028352347;
    p = p * t - 0.064457804;
    p = p * t - 0.5861359;
    p = p * t + 1.7583335;
    return select(1.0 - t * p, 12.92 * linear, linear <= vec3<f32>(0.0031308));
}
