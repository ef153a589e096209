// SPDX-License-Identifier: MIT OR Apache-2.0
// A glowing haze about the hole. Mirrors src/emit/haze.rs, where the formulas are.

#import emit/shift
#import geodesic/geodesic
#import shared/frame

// Emission and, in w, absorption per unit of affine length at a place; `ratio`: nu(camera) / nu(local frame).
fn haze_matter(c: Constants, there: State, ratio: f32) -> vec4<f32> {
    let cosine = there.n.z * inverseSqrt(dot(there.n, there.n));
    let nu = zamo_frequency(there.u, cosine, c.energy, c.angular_momentum) / c.nu_local;
    let distance = 1.0 / max(there.u * frame.haze.x, 1e-9);
    let density = exp(-0.5 * min(distance * distance, 200.0));
    let g = ratio / nu;
    return vec4<f32>(vec3<f32>(frame.haze.y * density * g * g * g * nu), frame.haze.z * density * nu);
}
