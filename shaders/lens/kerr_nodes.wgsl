// SPDX-License-Identifier: MIT OR Apache-2.0
// Kernel: the nodes of the tables of lens/kerr.wgsl, one thread each: traces a ray to infinity and a little beyond, so
// that crossings continue smoothly past it.

#import constants
#import camera/chart
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
    // Captured rays leave nothing to keep but crossings.
    if id.x >= KERR_COLUMNS || id.y >= lens.outer_rows + select(lens.inner_rows, 0u, lens.orders == 0u) {
        return;
    }
    node = id.xy;
    found = 0u;
    four = vec4<f32>(0.0);
    let column = textureLoad(curve, vec2<u32>(id.x, 1u), 0);
    let begin = begin_local(normalize(kerr_node_direction(column, id.y, false)));
    let c = begin.c;
    let u_plus = 1.0 / frame.r_plus;
    var state = begin.state;
    var side = first_side(state);
    var arrival = delay_to(c, state);
    let steps = select(0u, KERR_STEPS, begin.has_light);
    // Whether the ray is far enough outside the horizon for the delay in Boyer and Lindquist's chart.
    var outside = !RAIN;
    var escaped = false;
    var sky = vec3<f32>(0.0);
    var beyond = 0.0;
    for (var i = 0u; i < steps; i += 1u) {
        if RAIN && !outside && state.u < KERR_LEAVES_DORAN * lens.capture_u {
            outside = true;
            arrival = retardation(c, begin.state.u, begin.state.du, state.u, state.du, state.delay)
                + chart_offsets(c, state.u).y;
            state.delay = 0.0;
            if delay_by_parts(c) {
                arrival -= divergent_delay(state.u, c.u_observer) + delay_from(c, state);
            }
        }
        // Beyond capture_u only u and N go on, which pass the horizon evenly.
        let inside = outside && state.u >= lens.capture_u;
        let limit = select(step_limit(c, state, KERR_STEP), 1e30, inside);
        let most = KERR_STEP / select(c.scale, turn_rate(c), RAIN && !outside && state.u >= u_plus);
        let h = min(most, limit);
        var next = held_inside(c, nystrom_step(c, state, h));
        if RAIN && outside {
            next.delay = state.delay + delay_over(c, state, next, h);
        }
        if inside {
            next.drag = state.drag;
            next.delay = state.delay;
        }
        if side * next.n.z < 0.0 {
            side = next.n.z;
            if found < lens.orders {
                let crossing = crossing_state(c, state, next, h);
                var there = crossing.at;
                if RAIN && outside {
                    there.delay = state.delay + delay_over(c, state, there, crossing.tau);
                }
                if inside {
                    there.drag = state.drag;
                    there.delay = state.delay;
                }
                if outside {
                    store_crossing(c, there, arrival, select(there.u, state.u, inside));
                } else {
                    // Without a place: cells of such crossings that a disk may have are integrated (kerr_flags.wgsl).
                    store_next(vec4<f32>(there.u, 0.0, 0.0, 0.0));
                }
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
        var captured = next.u >= KERR_INWARD * lens.capture_u || (inside && next.du < 0.0);
        if !outside {
            captured = next.du > 0.0 && next.u > (1.0 - 1e-6) * u_plus;
        }
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

// The integral part of the delay over a step in Boyer and Lindquist's chart, of a ray that is traced in Doran's: by
// Gauss-Legendre on the dense output, as rain_step.
fn delay_over(c: Constants, s: State, end: State, h: f32) -> f32 {
    if !DELAY {
        return 0.0;
    }
    let u = quintic_of_u(c, s, end, h);
    let n_z = quintic_of_n_z(c, s, end, h);
    var delay = 0.0;
    for (var i = 0; i < 3; i++) {
        let x = GAUSS_NODES[i];
        delay += GAUSS_WEIGHTS[i] * coordinate_delay_rate(c, quintic_at(u, x), quintic_at(n_z, x));
    }
    return h * delay;
}

// Nodes keep their crossings by themselves.
fn on_crossing(c: Constants, crossing: PlaneCrossing) {
}

fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {
}

// `turn_u`: 1/r where the drag was last integrated.
fn store_crossing(c: Constants, there: State, arrival: f32, turn_u: f32) {
    var at = vec4<f32>(there.u, 0.0, 0.0, 0.0);
    if PATTERN {
        let direction = chart_direction(there.n, there.drag - chart_turn(c, turn_u));
        at = vec4<f32>(there.u, direction.xy, select(0.0, crossing_delay(c, there, arrival), DELAY));
    }
    store_next(at);
}

// The delay from a crossing to the observer less divergent_delay. Rays with too little energy to integrate the delay by
// parts have no such delay past infinity: 0 stands for it.
fn crossing_delay(c: Constants, there: State, arrival: f32) -> f32 {
    if !RAIN || delay_by_parts(c) {
        return delay_from(c, there) + arrival;
    }
    if there.u <= 0.0 {
        return 0.0;
    }
    return there.delay + arrival - divergent_delay(there.u, c.u_observer);
}

// Kerr's azimuth, in which rays of rain observers are traced, less that of Boyer and Lindquist.
fn chart_turn(c: Constants, u: f32) -> f32 {
    if !RAIN {
        return 0.0;
    }
    return kerr_offset(c, u);
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

// The delay from a crossing to an observer, less the observer's r and what it diverges like at infinity, 1 / u - 2
// ln(|u| / u_observer), is delay_from the crossing + delay_to the observer; (E + u') / u and (E - u') / u without
// cancellation, as u'^2 = E^2 + u^2 (...).
fn delay_from(c: Constants, there: State) -> f32 {
    if !DELAY {
        return 0.0;
    }
    let below = beyond_energy(c, there.u);
    let ratio = select((c.energy + there.du) / there.u, -below / (c.energy - there.du), there.du < 0.0);
    let logarithm = log(max(abs(there.u / c.u_observer), 1e-30));
    return (2.0 * ratio * there.u * logarithm - ratio) / c.energy + there.delay;
}

fn delay_to(c: Constants, observer: State) -> f32 {
    if !DELAY {
        return 0.0;
    }
    let begin = select((observer.du - c.energy) / observer.u,
        beyond_energy(c, observer.u) / (c.energy + observer.du), observer.du > 0.0);
    return begin / c.energy - observer.delay;
}

// (u'^2 - E^2) / u.
fn beyond_energy(c: Constants, u: f32) -> f32 {
    return u * (c.a2e2 - c.k + u * (2.0 * c.b - u * c.a2q));
}
