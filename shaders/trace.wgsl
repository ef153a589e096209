// One light ray from the eye to its fate. Mirrors src/physics/trace.rs; knows no observer, no pixel and no buffer.
//
// The inner loop only steps; what happens in a step is looked into outside it: GPUs (and lavapipe, which runs both sides of an
// `if`) would pay for root finding in every step. A kernel that uses this file defines
//
//     fn on_crossing(c: Constants, crossing: PlaneCrossing)
//
// which keeps a crossing of the equatorial plane.

const FATE_CAPTURED: u32 = 0u;
const FATE_ESCAPED: u32 = 1u;
const FATE_UNRESOLVED: u32 = 2u;
const FATE_HIDDEN: u32 = 3u;

struct Settings {
    // Step in sigma.
    step: f32,
    tolerance: f32,
    max_steps: u32,
    max_crossings: u32,
    capture_u: f32,
    // A crossing with u in this range ends the ray: what lies behind is hidden. Empty: (1, 0).
    opaque_u: vec2<f32>,
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
}

fn first_side(start: State) -> f32 {
    return select(start.dn.z, start.n.z, start.n.z != 0.0);
}

fn trace(c: Constants, start: State, settings: Settings) -> RayTrace {
    var result: RayTrace;
    result.fate = FATE_UNRESOLVED;
    let u_plus = 1.0 / c.r_plus;
    let h_most = select(settings.step, 0.5, METHOD == METHOD_DORMAND_PRINCE) / c.scale;
    var h_wish = settings.step / c.scale;
    var side = first_side(start);
    var state = start;
    var order = 0u;
    loop {
        var h = 0.0;
        var next = state;
        var crossed = false;
        var escaped = false;
        var captured = false;
        while result.steps < settings.max_steps {
            result.steps += 1u;
            h = min(h_wish, h_most);
            if STEP_LIMIT {
                h = min(h, step_limit(c, state, settings.step));
            }
            let step = step_ray(c, state, h);
            if METHOD == METHOD_DORMAND_PRINCE {
                let ratio = settings.tolerance / max(step.error, 1e-30);
                h_wish = h * clamp(0.9 * pow(ratio, 0.2), 0.2, 5.0);
                // Steps of sigma 1e-3 are at rounding's mercy: take them.
                if !(step.error <= settings.tolerance) && h * c.scale > 1e-3 {
                    continue;
                }
            }
            next = step.state;
            crossed = side * next.n.z < 0.0;
            escaped = next.u <= 0.0;
            captured = next.du > 0.0 && (next.u >= settings.capture_u || u_plus - next.u < 1e-6 * u_plus);
            if crossed || escaped || captured {
                break;
            }
            result.tau += h;
            state = next;
        }
        if crossed {
            side = next.n.z;
            if order < settings.max_crossings {
                let crossing = find_crossing(c, start, state, next, h, order);
                if crossing.u > 0.0 && crossing.u <= 1.0 / (c.r_plus * (1.0 + 1e-5)) {
                    on_crossing(c, crossing);
                    if crossing.u >= settings.opaque_u.x && crossing.u <= settings.opaque_u.y {
                        result.fate = FATE_HIDDEN;
                        break;
                    }
                }
            }
            order += 1u;
        }
        if escaped {
            result.fate = FATE_ESCAPED;
            let there = escape(c, state, next, h);
            result.n = there.n;
            result.drag = there.drag;
            result.tau += there.delay;
            break;
        }
        if captured {
            result.fate = FATE_CAPTURED;
            if settings.capture_u >= u_plus {
                result.tau += time_to_horizon(c, state, h);
            }
            break;
        }
        // Steps ran out.
        if !crossed {
            break;
        }
        result.tau += h;
        state = next;
    }
    return result;
}

// The state at infinity inside the step of `h` from `start` to `to`; its `delay` holds the partial step instead.
fn escape(c: Constants, start: State, to: State, h: f32) -> State {
    let partial = h * quintic_root(quintic_of_u(c, start, to, h));
    var there = step_ray(c, start, partial).state;
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

fn find_crossing(c: Constants, eye: State, start: State, to: State, h: f32, order: u32) -> PlaneCrossing {
    let partial = h * quintic_root(quintic_of_n_z(c, start, to, h));
    let there = step_ray(c, start, partial).state;
    // What rounding left of N_z, to first order.
    let rest = clamp(-there.n.z / there.dn.z, -0.1 * h, 0.1 * h);
    var crossing: PlaneCrossing;
    crossing.u = there.u + there.du * rest;
    crossing.n = there.n + there.dn * rest;
    crossing.drag = there.drag + drag_rate(c, there.u) * rest;
    crossing.order = order;
    if DELAY {
        crossing.delay = delay_between(c, eye, there);
    }
    return crossing;
}
