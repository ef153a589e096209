// SPDX-License-Identifier: MIT OR Apache-2.0
// Numbers rounded to what f16 tells apart, to even: storing them in a texture of f16 changes nothing, whatever way the
// driver rounds. So sums of light keep what they are on average.

// For 0 <= v <= 65504.
fn rounded_to_f16(v: vec4<f32>) -> vec4<f32> {
    let bits = bitcast<vec4<u32>>(v);
    // Adding just under half of the last place, and its lowest bit.
    let rounded = (bits + 0xfffu + ((bits >> vec4<u32>(13u)) & vec4<u32>(1u))) & vec4<u32>(0xffffe000u);
    // Below the smallest normal number, in even steps.
    let subnormal = round(v * 16777216.0) / 16777216.0;
    return select(bitcast<vec4<f32>>(rounded), subnormal, v < vec4<f32>(6.103515625e-5));
}
