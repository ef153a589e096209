// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: finds where the ray of each node ends; one thread a node. The curves are in lens/schwarzschild_curve.wgsl.

#import constants
#import lens/schwarzschild
#import lens/schwarzschild_curve
#import shared/not_inlined

// x: phi, y: sigma. A row for each branch.
@group(0) @binding(2) var ends_out: texture_storage_2d<rgba32float, write>;

// Steps in sigma (as `Resolution::SINGLE` has them), at 1/r of 1/2 and less, and how many at most: the nearest to
// critical end at 20.
const END_STEP: f32 = 0.2;
const END_STEPS: u32 = 400u;

@compute @workgroup_size(32)
fn find_ends(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    if id.x >= nodes_of(id.y) {
        return;
    }
    let t = node_t(id.xy);
    let curve = curve_of(t.x, t.y);
    let target_u = select(0.0, LENS_INNER_END, id.y == 1u);
    let sense = select(-1.0, 1.0, id.y == 1u);
    let step = END_STEP * min(1.0, 0.5 / frame.observer_u);
    let decay = step_decay(curve, step);
    var unused: vec3<f32>;
    var at = CurvePoint(0.0, curve.v, curve.dv);
    for (var i = 0u; i < END_STEPS; i += 1u) {
        let next = curve_step(curve, at, step, decay, &unused);
        if sense * (curve_u(curve, next) - target_u) >= 0.0 {
            break;
        }
        at = next;
    }
    // Newton's method, with the integrator.
    let base = at;
    var h = clamp((target_u - curve_u(curve, base)) / curve_slope(curve, base), 0.0, step);
    for (var i = 0u; i < 4u; i += 1u) {
        at = curve_step(curve, base, h, step_decay(curve, h), &unused);
        h = clamp(h + (target_u - curve_u(curve, at)) / curve_slope(curve, at), 0.0, 1.5 * step);
    }
    let sigma = base.sigma + h;
    textureStore(ends_out, id.xy, vec4<f32>(curve.side * curve.kappa * sigma, sigma, 0.0, 0.0));
}
