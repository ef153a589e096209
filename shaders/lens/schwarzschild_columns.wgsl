// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: fills u, and the delay's integral, along the ray of each node; one thread a node. The curves are in
// lens/schwarzschild_curve.wgsl.

#import constants
#import geodesic/geodesic
#import lens/schwarzschild
#import lens/schwarzschild_curve
#import shared/not_inlined

// The ends that lens/schwarzschild_ends.wgsl found.
@group(0) @binding(2) var ends: texture_2d<f32>;
// The angle phi at the end of the rays of the nodes -1, 0, 1, 2.
@group(0) @binding(3) var swept_out: texture_storage_2d<rgba32float, write>;
// u and du/dy at the begin of interval j of y, then at its end. x: node, y: j, layer: branch.
@group(0) @binding(4) var u_out: texture_storage_2d_array<rgba32float, write>;
// The delay's integral and its derivative by y, at the same nodes and intervals.
@group(0) @binding(5) var delay_out: texture_storage_2d_array<rgba32float, write>;

@compute @workgroup_size(32)
fn fill_columns(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    let nodes = nodes_of(id.y);
    if id.x >= nodes {
        return;
    }
    let before = textureLoad(ends, vec2<u32>(max(id.x, 1u) - 1u, id.y), 0).x;
    let here = textureLoad(ends, id.xy, 0);
    let after = textureLoad(ends, vec2<u32>(min(id.x + 1u, nodes - 1u), id.y), 0).x;
    let last = textureLoad(ends, vec2<u32>(min(id.x + 2u, nodes - 1u), id.y), 0).x;
    textureStore(swept_out, id.xy, vec4<f32>(before, here.x, after, last));

    let t = node_t(id.xy);
    let curve = curve_of(t.x, t.y);
    // A step makes two intervals: its middle is interpolated.
    let h = 2.0 * here.y / f32(LENS_INTERVALS);
    let decay = step_decay(curve, h);
    let tau = h / curve.c.scale;
    var inner: vec3<f32>;
    var at = CurvePoint(0.0, curve.v, curve.dv);
    var u = column_point(curve, at);
    var delay = vec2<f32>(0.0, delay_slope(curve, u.x));
    for (var j = 0u; j < LENS_INTERVALS; j += 2u) {
        at = curve_step(curve, at, h, decay, &inner);
        let end = column_point(curve, at);
        let middle = column_middle(u, end, h);
        let by_y = vec2<f32>(1.0, here.y);
        textureStore(u_out, vec2<u32>(id.x, j), id.y, vec4<f32>(u.xy * by_y, middle * by_y));
        textureStore(u_out, vec2<u32>(id.x, j + 1u), id.y, vec4<f32>(middle * by_y, end.xy * by_y));
        if DELAY {
            let sum = D1 * delay_rate(curve.c, u.x, 0.0) + D2 * delay_rate(curve.c, inner.x, 0.0)
                + D3 * delay_rate(curve.c, inner.y, 0.0) + D4 * delay_rate(curve.c, inner.z, 0.0);
            let next = vec2<f32>(delay.x + tau * sum, delay_slope(curve, end.x));
            let middle_delay = 0.5 * (delay.x + next.x) + 0.125 * h * (delay.y - next.y);
            let between = vec2<f32>(middle_delay, delay_slope(curve, middle.x)) * by_y;
            textureStore(delay_out, vec2<u32>(id.x, j), id.y, vec4<f32>(delay * by_y, between));
            textureStore(delay_out, vec2<u32>(id.x, j + 1u), id.y, vec4<f32>(between, next * by_y));
            delay = next;
        }
        u = end;
    }
}

// u, du/dsigma and its slope.
fn column_point(curve: Curve, at: CurvePoint) -> vec3<f32> {
    let u = curve_u(curve, at);
    return vec3<f32>(u, curve_slope(curve, at), curve.kappa * curve.kappa * u * (3.0 * u - 1.0));
}

// Value and slope at the middle of a step of h, by the quintic through both ends.
fn column_middle(a: vec3<f32>, b: vec3<f32>, h: f32) -> vec2<f32> {
    return vec2<f32>(0.5 * (a.x + b.x) + h * (5.0 / 32.0 * (a.y - b.y) + h / 64.0 * (a.z + b.z)),
        15.0 / 8.0 * (b.x - a.x) / h - 7.0 / 16.0 * (a.y + b.y) - h / 32.0 * (a.z - b.z));
}

// The slope of the delay's integral by sigma.
fn delay_slope(curve: Curve, u: f32) -> f32 {
    return delay_rate(curve.c, u, 0.0) / curve.c.scale;
}
