// One light ray from the eye to its fate. Mirrors src/physics/trace.rs; knows no observer, no pixel and no buffer.
//
// The loop only steps and saves the states before each event; roots are found after it: GPUs (and lavapipe, which runs both
// sides of an `if`) would pay for them in every step.

const FATE_CAPTURED: u32 = 0u;
const FATE_ESCAPED: u32 = 1u;
const FATE_UNRESOLVED: u32 = 2u;

struct Settings {
    // Step in sigma.
    step: f32,
    tolerance: f32,
    max_steps: u32,
    // At most MAX_CROSSINGS, which the host writes into the source: the size of the arrays below.
    max_crossings: u32,
    capture_u: f32,
}

struct PlaneCrossing {
    u: f32,
    n: vec3<f32>,
    drag: f32,
    delay: f32,
    order: u32,
}

struct RayTrace {
    fate: u32,
    steps: u32,
    // N and drag at infinity (escaped).
    n: vec3<f32>,
    drag: f32,
    // Tau to the end: infinity, or the horizon if the ray was followed that far.
    tau: f32,
    crossing_count: u32,
    crossings: array<PlaneCrossing, MAX_CROSSINGS>,
}

// What the loop keeps of a step in which something happened.
struct Event {
    from_state: State,
    h: f32,
    order: u32,
}

fn first_side(start: State) -> f32 {
    return select(start.dn.z, start.n.z, start.n.z != 0.0);
}

fn trace(c: Constants, start: State, settings: Settings) -> RayTrace {
    var result: RayTrace;
    result.fate = FATE_UNRESOLVED;
    var events: array<Event, MAX_CROSSINGS>;
    var event_count = 0u;
    var order = 0u;
    var side = first_side(start);
    var state = start;
    var last_h = 0.0;
    var tau = 0.0;
    let u_plus = 1.0 / c.r_plus;
    var h_wish = settings.step / c.scale;
    let h_most = select(h_wish, 0.5 / c.scale, METHOD == METHOD_DORMAND_PRINCE);
    var steps = 0u;
    while steps < settings.max_steps {
        steps += 1u;
        var h = min(h_wish, h_most);
        if STEP_LIMIT {
            h = min(h, step_limit(c, state, settings.step));
        }
        let next = step_ray(c, state, h);
        if METHOD == METHOD_DORMAND_PRINCE {
            let ratio = settings.tolerance / max(next.error, 1e-30);
            h_wish = h * clamp(0.9 * pow(ratio, 0.2), 0.2, 5.0);
            // Steps of sigma 1e-3 are at rounding's mercy: take them.
            if !(next.error <= settings.tolerance) && h * c.scale > 1e-3 {
                continue;
            }
        }
        if side * next.state.n.z < 0.0 {
            side = next.state.n.z;
            if event_count < settings.max_crossings {
                events[event_count] = Event(state, h, order);
                event_count += 1u;
            }
            order += 1u;
        }
        last_h = h;
        if next.state.u <= 0.0 {
            result.fate = FATE_ESCAPED;
            break;
        }
        if next.state.du > 0.0 && (next.state.u >= settings.capture_u || u_plus - next.state.u < 1e-6 * u_plus) {
            result.fate = FATE_CAPTURED;
            break;
        }
        tau += h;
        state = next.state;
    }
    result.steps = steps;
    if result.fate == FATE_ESCAPED {
        let there = escape(c, state, last_h);
        result.n = there.n;
        result.drag = there.drag;
        result.tau = tau + there.delay;
    } else if result.fate == FATE_CAPTURED && settings.capture_u >= u_plus {
        result.tau = tau + time_to_horizon(c, state, last_h);
    }
    let outermost = 1.0 / (c.r_plus * (1.0 + 1e-5));
    for (var i = 0u; i < event_count; i++) {
        let crossing = find_crossing(c, start, events[i]);
        if crossing.u > 0.0 && crossing.u <= outermost {
            result.crossings[result.crossing_count] = crossing;
            result.crossing_count += 1u;
        }
    }
    return result;
}

// The state at infinity inside the step of `h` from `state`; its `delay` holds the partial step instead.
fn escape(c: Constants, state: State, h: f32) -> State {
    let to = step_ray(c, state, h).state;
    let partial = h * quintic_root(quintic_of_u(c, state, to, h));
    var there = step_ray(c, state, partial).state;
    let rest = -there.u / there.du;
    there.n += there.dn * rest;
    there.drag += drag_rate(c, 0.0) * rest;
    there.delay = partial + rest;
    return there;
}

// Tau from `state` to the horizon for a spin-0 ray whose last step was `h`: u is regular there.
fn time_to_horizon(c: Constants, state: State, h: f32) -> f32 {
    if SPINNING {
        return 0.0;
    }
    let u_plus = 1.0 / c.r_plus;
    var t = h;
    for (var i = 0; i < 4; i++) {
        let there = step_ray(c, state, t).state;
        t += clamp((u_plus - there.u) / there.du, -h, h);
    }
    return t;
}

fn find_crossing(c: Constants, eye: State, event: Event) -> PlaneCrossing {
    let start = event.from_state;
    let to = step_ray(c, start, event.h).state;
    let partial = event.h * quintic_root(quintic_of_n_z(c, start, to, event.h));
    let there = step_ray(c, start, partial).state;
    // What rounding left of N_z, to first order.
    let rest = clamp(-there.n.z / there.dn.z, -0.1 * event.h, 0.1 * event.h);
    var crossing: PlaneCrossing;
    crossing.u = there.u + there.du * rest;
    crossing.n = there.n + there.dn * rest;
    crossing.drag = there.drag + drag_rate(c, there.u) * rest;
    crossing.order = event.order;
    if DELAY {
        crossing.delay = delay_between(c, eye, there);
    }
    return crossing;
}
