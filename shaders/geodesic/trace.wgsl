// SPDX-License-Identifier: MIT OR Apache-2.0
// One light ray from its start to its fate. Mirrors src/physics/trace.rs; knows no observer, no pixel and no buffer.
//
// The inner loop only steps; whatever happens in a step is looked into outside it: GPUs (and lavapipe, which runs both
// sides of an `if`) would pay for root finding in every step. A kernel's on_crossing keeps a crossing of the equatorial
// plane.

#import constants
#import geodesic/geodesic
#import geodesic/integrator
#requires fn on_crossing(c: Constants, crossing: PlaneCrossing)
#requires fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32)

// Whether on_part is told of every part of the ray in which it crosses no plane: a step of the length `h` in tau from
// `from_state` to `to_state`, or what lies of it on one side of a crossing, from `begin` to `end` in tau since its
// begin.
override PARTS: bool = false;

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
    // Tau from the begin of the step in which it lies.
    tau: f32,
    // u' there.
    du: f32,
}

struct RayTrace {
    fate: u32,
    steps: u32,
    // The last step, in which the ray ended: its begin, its end, its length, and tau at its begin.
    from_state: State,
    to_state: State,
    h: f32,
    tau: f32,
    // The orders of crossings within the horizon, a bit each; on_crossing is told of none.
    inside: u32,
}

fn first_side(start: State) -> f32 {
    return select(start.dn.z, start.n.z, start.n.z != 0.0);
}

fn trace(c: Constants, start: State, settings: Settings) -> RayTrace {
    let u_plus = 1.0 / c.r_plus;
    let h_most = select(settings.step, 0.5, METHOD == METHOD_DORMAND_PRINCE) / c.scale;
    var h_wish = settings.step / c.scale;
    var side = first_side(start);
    var order = 0u;
    var inner_orders = 0u;
    var fate = FATE_UNRESOLVED;
    var steps = 0u;
    var tau = 0.0;
    var h = 0.0;
    var state = start;
    var next = start;
    loop {
        var crossed = false;
        var stepped = false;
        while steps < settings.max_steps {
            steps += 1u;
            stepped = false;
            h = min(h_wish, h_most);
            if STEP_LIMIT {
                // Inside, the limit is all.
                let limit = step_limit(c, state, settings.step);
                let inside = state.u >= u_plus;
                var within = limit;
                if SPINNING && RAIN {
                    within = min(limit, settings.step / turn_rate(c));
                }
                h = select(min(h, limit), select(within, min(h_wish, limit), METHOD == METHOD_DORMAND_PRINCE), inside);
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
            next = held_inside(c, step.state);
            crossed = side * next.n.z < 0.0;
            let captured = next.du > 0.0 && (next.u >= settings.capture_u || u_plus - next.u < 1e-6 * u_plus);
            fate = select(select(FATE_UNRESOLVED, FATE_CAPTURED, captured), FATE_ESCAPED, next.u <= 0.0);
            stepped = true;
            if PARTS || crossed || fate != FATE_UNRESOLVED {
                break;
            }
            tau += h;
            state = next;
        }
        if PARTS && !stepped {
            // Out of steps.
            break;
        }
        var crossing: PlaneCrossing;
        var meets = false;
        if crossed {
            side = next.n.z;
            if order < settings.max_crossings {
                crossing = find_crossing(c, start, state, next, h, order);
                let inner = crossing.u > 1.0 / (c.r_plus * (1.0 + 1e-5));
                meets = crossing.u > 0.0 && !inner;
                inner_orders |= select(0u, 1u << order, inner);
            }
            order += 1u;
        }
        if PARTS {
            // One call for both sides of a crossing and for steps without one: what it does is long, and three copies
            // of it took 8 % more time (H200).
            var begin = 0.0;
            for (var part = select(1u, 0u, meets); part < 2u; part += 1u) {
                let end = select(h, crossing.tau, part == 0u);
                on_part(c, start, state, next, h, begin, end);
                begin = end;
                if part == 0u {
                    on_crossing(c, crossing);
                    if crossing.u >= settings.opaque_u.x && crossing.u <= settings.opaque_u.y {
                        fate = FATE_HIDDEN;
                        break;
                    }
                }
            }
        } else if meets {
            on_crossing(c, crossing);
            if crossing.u >= settings.opaque_u.x && crossing.u <= settings.opaque_u.y {
                fate = FATE_HIDDEN;
            }
        }
        // Ended, or out of steps.
        if fate != FATE_UNRESOLVED || (!PARTS && !crossed) {
            break;
        }
        tau += h;
        state = next;
    }
    return RayTrace(fate, steps, state, next, h, tau, inner_orders);
}

// The drag over what is left of a step, to first order.
fn drag_over(c: Constants, s: State, rest: f32) -> f32 {
    if SPINNING && RAIN {
        return kerr_drag_rate(c, s.u, s.du) * rest;
    }
    return drag_rate(c, s.u) * rest;
}

// The state at infinity of an escaped ray; its `delay` holds tau.
fn escape(c: Constants, traced: RayTrace) -> State {
    let partial = traced.h * quintic_root(quintic_of_u(c, traced.from_state, traced.to_state, traced.h));
    var there = step_ray(c, traced.from_state, partial).state;
    let rest = -there.u / there.du;
    there.n += there.dn * rest;
    there.drag += drag_over(c, there, rest);
    there.delay = traced.tau + partial + rest;
    return there;
}

// Tau of a captured spin-0 ray at the horizon, through which u is regular.
fn tau_at_horizon(c: Constants, traced: RayTrace) -> f32 {
    let u_plus = 1.0 / c.r_plus;
    var t = traced.h;
    for (var i = 0; i < 4; i++) {
        let there = step_ray(c, traced.from_state, t).state;
        t += clamp((u_plus - there.u) / there.du, -traced.h, traced.h);
    }
    return traced.tau + t;
}

struct CrossingState {
    at: State,
    // Tau from the step's begin.
    tau: f32,
}

// The state where N_z is 0 within the step from `start` to `to`.
fn crossing_state(c: Constants, start: State, to: State, h: f32) -> CrossingState {
    let partial = h * quintic_root(quintic_of_n_z(c, start, to, h));
    var there = step_ray(c, start, partial).state;
    // The rest of N_z that rounding left, to first order.
    let rest = clamp(-there.n.z / there.dn.z, -0.1 * h, 0.1 * h);
    there.drag += drag_over(c, there, rest);
    there.u += there.du * rest;
    there.n += there.dn * rest;
    return CrossingState(there, partial + rest);
}

fn find_crossing(c: Constants, observer: State, start: State, to: State, h: f32, order: u32) -> PlaneCrossing {
    let found = crossing_state(c, start, to, h);
    let there = found.at;
    var crossing = PlaneCrossing(there.u, there.n, there.drag, 0.0, order, found.tau, there.du);
    if DELAY {
        crossing.delay = retardation(c, observer.u, observer.du, there.u, there.du, there.delay - observer.delay);
    }
    return crossing;
}
