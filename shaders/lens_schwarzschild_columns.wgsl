// Kernel: u, and the delay's integral, along the ray of each node; one thread a node. The curves are in lens_schwarzschild_curve.wgsl.

// What lens_schwarzschild_ends.wgsl found.
@group(0) @binding(2) var ends: texture_2d<f32>;
// phi at the end, at the nodes -1, 0, 1, 2.
@group(0) @binding(3) var swept_out: texture_storage_2d<rgba32float, write>;
// Of interval j of y: u and du/dy at its begin, then at its end. x: node, y: j, layer: branch.
@group(0) @binding(4) var u_out: texture_storage_2d_array<rgba32float, write>;
// The same of the delay's integral.
@group(0) @binding(5) var delay_out: texture_storage_2d_array<rgba32float, write>;

@compute @workgroup_size(32)
fn fill_columns(@builtin(global_invocation_id) id: vec3<u32>) {
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
    let h = here.y / f32(LENS_INTERVALS);
    let tau = h / curve.c.scale;
    var inner: vec3<f32>;
    var at = CurvePoint(0.0, curve.v, curve.dv);
    // Value and slope by y.
    var u = vec2<f32>(curve_u(curve, at), here.y * curve_slope(curve, at));
    var delay = vec2<f32>(0.0, here.y / curve.c.scale * delay_rate(curve.c, u.x, 0.0));
    for (var j = 0u; j < LENS_INTERVALS; j += 1u) {
        at = curve_step(curve, at, h, &inner);
        let next = vec2<f32>(curve_u(curve, at), here.y * curve_slope(curve, at));
        textureStore(u_out, vec2<u32>(id.x, j), id.y, vec4<f32>(u, next));
        if DELAY {
            let sum = D1 * delay_rate(curve.c, u.x, 0.0) + D2 * delay_rate(curve.c, inner.x, 0.0)
                + D3 * delay_rate(curve.c, inner.y, 0.0) + D4 * delay_rate(curve.c, inner.z, 0.0);
            let next_delay = vec2<f32>(delay.x + tau * sum, here.y / curve.c.scale * delay_rate(curve.c, next.x, 0.0));
            textureStore(delay_out, vec2<u32>(id.x, j), id.y, vec4<f32>(delay, next_delay));
            delay = next_delay;
        }
        u = next;
    }
}
