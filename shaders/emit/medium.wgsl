// SPDX-License-Identifier: MIT OR Apache-2.0
// The matter that a ray passes between two crossings of the plane, summed up. Mirrors src/emit/medium.rs, where the
// formulas are. Knows no kind of matter.
//
// A medium is a vector: xyz the light that it sends to the observer, w the share of the light from behind that passes.
// In views of matter x is I_nu and y the optical depth instead.

#import constants

const NO_MEDIUM: vec4<f32> = vec4<f32>(0.0, 0.0, 0.0, 1.0);

// The medium since the last crossing that was kept.
var<private> medium: vec4<f32>;

// (1 - e^-t) / t.
fn own_share(t: f32) -> f32 {
    // The series is for depths at which the quotient would be rounding.
    let series = 1.0 - t * (0.5 - t * (1.0 / 6.0 - t / 24.0));
    return select(series, (1.0 - exp(-t)) / max(t, 1e-30), t > 0.1);
}

fn thin_gains(depths: vec3<f32>) -> vec3<f32> {
    let before = vec3<f32>(dot(GAUSS_BEFORE_0, depths), dot(GAUSS_BEFORE_1, depths), dot(GAUSS_BEFORE_2, depths));
    return GAUSS_WEIGHTS * exp(-max(before, vec3<f32>(0.0)));
}

fn layer_gains(depths: vec3<f32>) -> vec3<f32> {
    let t = GAUSS_WEIGHTS * depths;
    let through = vec3<f32>(1.0, exp(-t.x), exp(-t.x - t.y));
    return GAUSS_WEIGHTS * through * vec3<f32>(own_share(t.x), own_share(t.y), own_share(t.z));
}

// The share of each node's light that leaves a stretch with matter of these depths, were it everywhere as at the node.
fn node_gains(depths: vec3<f32>) -> vec3<f32> {
    return select(layer_gains(depths), thin_gains(depths), dot(GAUSS_WEIGHTS, depths) < THICK);
}
