// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: the nodes of the tables of lens/kerr.wgsl, one thread each: traces a ray to infinity and a little beyond, so
// that crossings continue smoothly past it.

#import constants
#import camera/observer
#import geodesic/geodesic
#import geodesic/integrator
#import geodesic/trace
#import lens/kerr
#import shared/not_inlined
#import shared/frame

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lens: KerrLens;
// Second row: of each column sin chi, cos chi, tan(R / 2).
@group(0) @binding(2) var curve: texture_2d<f32>;
// Sky direction, chart; 0 if captured.
@group(0) @binding(3) var sky_out: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var crossings_out: texture_storage_2d_array<rgba32float, write>;

// In sigma. f64 takes 0.25 and finds each crossing by Newton's method with the integrator; here the step's dense output
// finds it, whose error goes with the sixth power of the step. Measured as in lens/kerr_flags.wgsl: with 0.25, radii
// are wrong by 1.3e-7 instead of 8e-8 in the median, and directions by 3.5e-6 instead of 1.5e-6 at worst.
const KERR_STEP: f32 = 0.2;
// The most steps of a ray of the table: 2^-10 from the curve a ray ends within sigma 20.
const KERR_STEPS: u32 = 400u;

var<private> node: vec2<u32>;
var<private> found: u32;
// The layer being filled.
var<private> four: vec4<f32>;

@compute @workgroup_size(8, 16)
fn trace_nodes(@builtin(global_invocation_id) id: vec3<u32>) {
    unknown_zero = id.z;
    if id.x >= KERR_COLUMNS || id.y >= lens.outer_rows + lens.inner_rows {
        return;
    }
    node = id.xy;
    found = 0u;
    four = vec4<f32>(0.0);
    let column = textureLoad(curve, vec2<u32>(id.x, 1u), 0);
    let begin = begin_local(normalize(kerr_node_direction(column, id.y, false)));
    let c = begin.c;
    var state = begin.state;
    var side = first_side(state);
    var escaped = false;
    var sky = vec3<f32>(0.0);
    var beyond = 0.0;
    for (var i = 0u; i < KERR_STEPS; i += 1u) {
        // Beyond capture_u only u and N go on, which pass the horizon evenly.
        let inside = state.u >= lens.capture_u;
        let h = min(KERR_STEP / c.scale, select(step_limit(c, state, KERR_STEP), 1e30, inside));
        var next = nystrom_step(c, state, h);
        if inside {
            next.drag = state.drag;
            next.delay = state.delay;
        }
        if side * next.n.z < 0.0 {
            side = next.n.z;
            if found < lens.orders {
                var there = crossing_state(c, state, next, h).at;
                if inside {
                    there.drag = state.drag;
                    there.delay = state.delay;
                }
                store_crossing(c, begin.state, there);
            }
        }
        if next.u <= 0.0 {
            if !escaped {
                let end = escape(c, RayTrace(FATE_ESCAPED, 0u, state, next, h, 0.0, 0u));
                sky = chart_direction(end.n, end.drag);
                escaped = true;
            }
            beyond += h * c.scale;
        }
        // Inside, the ray is captured however it goes on.
        let captured = next.u >= KERR_INWARD * lens.capture_u || (inside && next.du < 0.0);
        if captured || beyond > KERR_BEYOND || ((escaped || inside) && found >= lens.orders) {
            break;
        }
        state = next;
    }
    if id.y < lens.outer_rows {
        textureStore(sky_out, id.xy, vec4<f32>(sky, 0.0));
    }
    let none = select(KERR_NO_CROSSING, -KERR_NO_CROSSING, escaped);
    while found < lens.orders {
        store_next(vec4<f32>(none, 0.0, 0.0, 0.0));
    }
    if !PATTERN && found % 4u != 0u {
        textureStore(crossings_out, node, found / 4u, four);
    }
}

// Nodes keep their crossings by themselves.
fn on_crossing(c: Constants, crossing: PlaneCrossing) {
}

fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {
}

fn store_crossing(c: Constants, observer: State, there: State) {
    var at = vec4<f32>(there.u, 0.0, 0.0, 0.0);
    if PATTERN {
        let direction = chart_direction(there.n, there.drag);
        at = vec4<f32>(there.u, direction.xy, regular_delay(c, observer, there));
    }
    store_next(at);
}

// Stores the crossing of the next order.
fn store_next(at: vec4<f32>) {
    if PATTERN {
        textureStore(crossings_out, node, found, at);
    } else {
        four[found % 4u] = at.x;
        if found % 4u == 3u {
            textureStore(crossings_out, node, found / 4u, four);
            four = vec4<f32>(0.0);
        }
    }
    found += 1u;
}

// The delay less the observer's r and what it diverges like at infinity, 1 / u - 2 ln(|u| / u_observer); (E + u') / u
// and (E - u') / u without cancellation, as u'^2 = E^2 + u^2 (...).
fn regular_delay(c: Constants, observer: State, there: State) -> f32 {
    if !DELAY {
        return 0.0;
    }
    let below = beyond_energy(c, there.u);
    let ratio = select((c.energy + there.du) / there.u, -below / (c.energy - there.du), there.du < 0.0);
    let begin = select((observer.du - c.energy) / observer.u,
        beyond_energy(c, observer.u) / (c.energy + observer.du), observer.du > 0.0);
    let logarithm = log(max(abs(there.u / c.u_observer), 1e-30));
    return (2.0 * ratio * there.u * logarithm - ratio + begin) / c.energy + there.delay - observer.delay;
}

// (u'^2 - E^2) / u.
fn beyond_energy(c: Constants, u: f32) -> f32 {
    return u * (c.a2e2 - c.k + u * (2.0 * c.b - u * c.a2q));
}
