// SPDX-License-Identifier: MIT OR Apache-2.0
// The matter that a ray passes between two crossings of the plane, summed up. Mirrors src/emit/medium.rs, where the
// formulas are. Knows no kind of matter.
//
// A medium is a vector: xyz the light that it sends to the observer, w the share of the light from behind that passes.

const NO_MEDIUM: vec4<f32> = vec4<f32>(0.0, 0.0, 0.0, 1.0);

// `before` with matter added behind it: the light that it sends were it transparent, and its optical depth.
fn medium_with(before: vec4<f32>, emitted: vec3<f32>, depth: f32) -> vec4<f32> {
    let through = exp(-depth);
    // The series is for depths at which the quotient would be rounding.
    let series = 1.0 - depth * (0.5 - depth * (1.0 / 6.0 - depth / 24.0));
    let own = select(series, (1.0 - through) / max(depth, 1e-30), depth > 0.1);
    return vec4<f32>(before.xyz + before.w * own * emitted, before.w * through);
}
