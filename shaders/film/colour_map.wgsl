// SPDX-License-Identifier: MIT OR Apache-2.0
// Colour maps for the luminance of developed light. Mirrors src/film/colour_map.rs, where the formulas and sources are.

#import constants

fn luminance(rgb: vec3<f32>) -> f32 {
    return dot(LUMINANCE, rgb);
}

// The sRGB-encoded colour of a share of white.
fn afmhot(share: f32) -> vec3<f32> {
    return clamp(2.0 * share - vec3<f32>(0.0, 0.5, 1.0), vec3<f32>(0.0), vec3<f32>(1.0));
}
