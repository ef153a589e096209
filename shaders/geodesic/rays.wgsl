// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: traces rays whose start the host computed in f64 (`Scene::start`), one a thread, for bhr_trace_rays.
// Redshifts, azimuths and units are the host's work; the kernel gives back where the ray crossed the plane and ended.

#import constants
#import geodesic/geodesic
#import geodesic/trace

struct RayStart {
    // energy, L, nu_local, u'
    light: vec4<f32>,
    // K, B, a^2 E^2, a^2 Q
    curve: vec4<f32>,
    // N, u
    n: vec4<f32>,
    // N', S
    dn: vec4<f32>,
}

// Four words of N and drag (at infinity or at a crossing), then: fate, steps, crossing count, tau; or u, delay, order,
// u'.
struct RayEnd {
    n: vec4<f32>,
    rest: vec4<u32>,
}

struct RaysUniform {
    step: f32,
    tolerance: f32,
    max_steps: u32,
    count: u32,
    a: f32,
    r_plus: f32,
    r_minus: f32,
    capture_u: f32,
}

@group(0) @binding(0) var<uniform> rays: RaysUniform;
@group(0) @binding(1) var<storage, read> ray_starts: array<RayStart>;
@group(0) @binding(2) var<storage, read_write> ray_ends: array<RayEnd>;

var<private> ray_end: u32;
var<private> crossing_count: u32;

fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    crossing_count += 1u;
    ray_ends[ray_end + crossing_count] = RayEnd(vec4<f32>(crossing.n, crossing.drag),
        vec4<u32>(bitcast<u32>(crossing.u), bitcast<u32>(crossing.delay), crossing.order,
            bitcast<u32>(crossing.du)));
}

// Hosts' rays meet no emitter.
fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {
}

@compute @workgroup_size(64)
fn trace_rays(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= rays.count {
        return;
    }
    let given = ray_starts[id.x];
    // The clock is t: no host asks for the delays of an observer inside the horizon.
    let c = Constants(rays.a, given.light.x, given.light.y, given.light.z, given.curve.x, given.curve.y, given.curve.z,
        given.curve.w, given.dn.w, given.n.w, rays.r_plus, rays.r_minus, CLOCK_COORDINATE);
    let start = State(given.n.w, given.light.w, given.n.xyz, given.dn.xyz, 0.0, 0.0);
    ray_end = id.x * (1u + RAY_CROSSINGS);
    crossing_count = 0u;
    let settings = Settings(rays.step, rays.tolerance, rays.max_steps, RAY_CROSSINGS, rays.capture_u,
        vec2<f32>(1.0, 0.0));
    let traced = trace(c, start, settings);
    var end: State;
    if traced.fate == FATE_ESCAPED {
        end = escape(c, traced);
    } else if traced.fate == FATE_CAPTURED && !SPINNING {
        end.delay = tau_at_horizon(c, traced);
    }
    ray_ends[ray_end] = RayEnd(vec4<f32>(end.n, end.drag),
        vec4<u32>(traced.fate, traced.steps, crossing_count, bitcast<u32>(end.delay)));
}
