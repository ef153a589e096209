// SPDX-License-Identifier: MIT OR Apache-2.0
//! Twins of geodesic/integrator and geodesic/trace.

use super::geodesic::{
    BEHIND, RAYS, STATE, constants, plain_ray, push_constants, push_state, rain_ray, random_ray,
    random_spinning_rain_ray, spinning_rain_ray, spinning_ray, state,
};
use super::inputs::{Inputs, Outputs};
use super::{Group, ROUNDING, twin};
use crate::physics::geodesic::{Clock, Constants, State};
use crate::physics::integrator::{Method, Quintic, held_inside, nystrom_step, rk4_step, step, step_limit};
use crate::physics::lens::critical::capture_margin;
use crate::physics::rain::doran_turn;
use crate::physics::trace::{self, Fate, RayTrace, Segment, Settings, find_crossing, land, time_to_horizon};
use glam::DVec3;

/// Rays keep their first crossing of the plane, and the number of all.
const HEAD: &str = "
#import geodesic/trace
var<private> first: PlaneCrossing;
var<private> crossing_count: u32;
fn on_part(c: Constants, observer: State, from_state: State, to_state: State, h: f32, begin: f32, end: f32) {}
fn on_crossing(c: Constants, crossing: PlaneCrossing) {
    if crossing_count == 0u {
        first = crossing;
    }
    crossing_count += 1u;
}
";

/// A step's sums of terms that cancel, relative to the change of the step and to what it begins with.
const STEP: f64 = 2e-6;

/// A ray and a step in tau behind it: in sigma within the range.
fn with_step(i: &mut Inputs, ray: fn(&mut Inputs), [low, high]: [f64; 2]) {
    loop {
        i.clear();
        ray(i);
        let step = i.random.even(low, high) / i.x(9);
        i.push(step);
        let (c, s) = (constants(i), state(i, STATE));
        let end = nystrom_step(&c, &s, i.x(BEHIND), false);
        // Beyond infinity and beside the horizon no delay is asked for.
        if end.u > 0.02 * s.u && end.u * c.r_plus < 0.9 {
            return;
        }
    }
}

/// `STEP` inside the horizon, where rates may change from 1 to 30 over a step.
const RAIN_STEP: f64 = 1e-5;

/// A ray of the rain frame of a spinning hole, and a step in tau behind it.
fn with_rain_step(i: &mut Inputs, [low, high]: [f64; 2]) {
    loop {
        i.clear();
        let (c, s) = random_spinning_rain_ray(i);
        push_constants(i, &c);
        push_state(i, &s);
        let sigma = i.random.even(low, high);
        let h = (sigma / c.scale).min(step_limit(&c, &s, sigma));
        i.push(h);
        let end = nystrom_step(&c, &s, h, false);
        if end.u > 0.02 * s.u && (1.0 - end.u * c.r_plus).abs() > 0.05 && c.radial_energy(end.u) > 0.01 {
            return;
        }
    }
}

/// `to`, with what the shaders have for the drag since `from`: in Doran's chart they follow Kerr's azimuth.
fn as_shaders_have_it(c: &Constants, from: &State, to: &State) -> State {
    let turn = if c.clock == Clock::Rain { doran_turn(c.a, to.u) - doran_turn(c.a, from.u) } else { 0.0 };
    State { drag: to.drag - turn, ..*to }
}

fn put_state(o: &mut Outputs, from: &State, to: &State, h: f64) {
    o.near(to.u, from.u.abs() + (h * from.du).abs());
    o.near(to.du, from.du.abs());
    o.all(to.n.to_array(), 1.0);
    o.all(to.dn.to_array(), from.dn.length());
    o.near(to.drag, 1.0);
    // By parts, the terms of K u and u' / u cancel.
    o.near(to.delay, (from.du / from.u).abs() * 0.3 + 1.0);
}

fn stepped(i: &Inputs, o: &mut Outputs, method: Method) -> f64 {
    let (c, s, h) = (constants(i), state(i, STATE), i.x(BEHIND));
    let (end, error) = step(method, &c, &s, h, true);
    put_state(o, &s, &as_shaders_have_it(&c, &s, &end), h);
    error
}

/// Two states of a ray, one step of sigma 0.25 from one to the other, over which `value` changes its sign.
fn push_sign_change(i: &mut Inputs, ray: fn(&mut Inputs), value: fn(&State) -> f64) {
    loop {
        i.clear();
        ray(i);
        let c = constants(i);
        let mut from = state(i, STATE);
        let h = 0.25 / c.scale;
        for _ in 0..40 {
            let to = nystrom_step(&c, &from, h, false);
            if value(&from) * value(&to) < 0.0 && from.u > 1e-3 && to.u > 1e-3 && to.u * c.r_plus < 0.8 {
                i.truncate(STATE);
                push_state(i, &from);
                push_state(i, &to);
                i.push(h);
                return;
            }
            if to.u <= 0.0 || to.u * c.r_plus > 0.8 {
                break;
            }
            from = to;
        }
    }
}

const TO: usize = BEHIND;
const H: usize = BEHIND + 10;

fn quintic(i: &Inputs, o: &mut Outputs, of: fn(&Constants, &State, &State, f64) -> Quintic) {
    let q = of(&constants(i), &state(i, STATE), &state(i, TO), i.x(H));
    // The fraction of the step.
    o.near(q.root(), 1.0);
}

pub fn group() -> Group {
    let method = |number: f64| [("SPINNING", 1.0), ("DELAY", 1.0), ("METHOD", number)];
    let code = |method: Method| f64::from(crate::gpu::kernel::variant::MethodCode::from(method).0);
    let nystrom = method(code(Method::Nystrom));
    let (rk4, dormand_prince) = (method(code(Method::Rk4)), method(code(Method::DormandPrince)));
    let plain = [("SPINNING", 0.0), ("DELAY", 1.0), ("METHOD", code(Method::Nystrom))];
    let in_rain = |method: Method| [("SPINNING", 1.0), ("DELAY", 1.0), ("RAIN", 1.0), ("METHOD", code(method))];
    let (rain, rain_rk4) = (in_rain(Method::Nystrom), in_rain(Method::Rk4));
    let (integrator, ray) = ("geodesic/integrator", "geodesic/trace");
    const STEP_RAY: &str = "out_state(step_ray(ray_constants(), ray_state(13u), in1(23u)).state);";
    let twins =
        vec![
        twin(
            integrator,
            "step_ray nystrom_step nystrom_step_of_n",
            STEP_RAY,
            |i| with_step(i, spinning_ray, [0.02, 0.3]),
            |i, o| { stepped(i, o, Method::Nystrom); },
            STEP,
        )
        .with(&nystrom),
        twin(
            integrator,
            "step_ray nystrom_step turn_n",
            STEP_RAY,
            |i| with_step(i, plain_ray, [0.02, 0.3]),
            |i, o| { stepped(i, o, Method::Nystrom); },
            STEP,
        )
        .with(&plain),
        twin(
            integrator,
            "step_ray nystrom_step rain_step quintic_at quintic_slope",
            STEP_RAY,
            |i| with_rain_step(i, [0.02, 0.15]),
            |i, o| { stepped(i, o, Method::Nystrom); },
            RAIN_STEP,
        )
        .with(&rain),
        twin(
            integrator,
            "step_ray rk4_step derivative",
            STEP_RAY,
            |i| with_rain_step(i, [0.02, 0.15]),
            |i, o| {
                let (c, s, h) = (constants(i), state(i, STATE), i.x(BEHIND));
                put_state(o, &s, &as_shaders_have_it(&c, &s, &rk4_step(&c, &s, h)), h);
            },
            RAIN_STEP,
        )
        .with(&rain_rk4),
        twin(
            integrator,
            "step_limit rain_step_limit held_inside",
            "let s = ray_state(13u); out1(step_limit(ray_constants(), s, in1(23u)));
             out_state(held_inside(ray_constants(), s));",
            |i| {
                spinning_rain_ray(i);
                i.even(0.02, 0.3);
            },
            |i, o| {
                let (c, s) = (constants(i), state(i, STATE));
                // The shortest step is single precision's own.
                let limit = step_limit(&c, &s, i.x(BEHIND)).max(2e-3 / c.scale).min(1e30);
                o.near(limit, limit.min(1.0));
                put_state(o, &s, &held_inside(&c, s), 0.0);
            },
            RAIN_STEP,
        )
        .with(&rain),
        twin(
            integrator,
            "step_ray rk4_step derivative advance blend",
            STEP_RAY,
            |i| with_step(i, spinning_ray, [0.02, 0.3]),
            |i, o| {
                let (c, s, h) = (constants(i), state(i, STATE), i.x(BEHIND));
                put_state(o, &s, &rk4_step(&c, &s, h), h);
            },
            STEP,
        )
        .with(&rk4),
        twin(
            integrator,
            "step_ray dormand_prince_step error_norm derivative advance blend",
            "let s = step_ray(ray_constants(), ray_state(13u), in1(23u)); out_state(s.state); out1(s.error);",
            |i| with_step(i, spinning_ray, [0.2, 0.6]),
            |i, o| {
                let error = stepped(i, o, Method::DormandPrince);
                // An estimate, relative to 1, of what rounding leaves nothing of below this.
                o.near(error, 1.0);
            },
            STEP,
        )
        .with(&dormand_prince),
        twin(
            integrator,
            "step_limit",
            "out1(step_limit(ray_constants(), ray_state(13u), in1(23u)));",
            |i| {
                spinning_ray(i);
                i.even(0.02, 0.3);
            },
            |i, o| o.put(step_limit(&constants(i), &state(i, STATE), i.x(BEHIND)).min(1e30)),
            STEP,
        )
        .with(&nystrom),
        twin(
            integrator,
            "step_limit",
            "out1(step_limit(ray_constants(), ray_state(13u), in1(23u)));",
            |i| {
                rain_ray(i);
                i.even(0.02, 0.3);
            },
            |i, o| o.put(step_limit(&constants(i), &state(i, STATE), i.x(BEHIND)).min(1e30)),
            STEP,
        )
        .with(&plain),
        twin(
            integrator,
            "held_inside",
            "out_state(held_inside(ray_constants(), ray_state(13u)));",
            rain_ray,
            |i, o| {
                let s = state(i, STATE);
                put_state(o, &s, &held_inside(&constants(i), s), 0.0);
            },
            STEP,
        )
        .with(&plain),
        twin(
            integrator,
            "quintic_root quintic_of_n_z quintic",
            "out1(quintic_root(quintic_of_n_z(ray_constants(), ray_state(13u), ray_state(23u), in1(33u))));",
            |i| push_sign_change(i, spinning_ray, |s| s.n.z),
            |i, o| quintic(i, o, Quintic::of_n_z),
            // Four turns of Newton's method, in f32.
            2e-6,
        )
        .with(&nystrom),
        twin(
            integrator,
            "quintic_root quintic_of_u quintic",
            "out1(quintic_root(quintic_of_u(ray_constants(), ray_state(13u), ray_state(23u), in1(33u))));",
            push_end,
            |i, o| quintic(i, o, Quintic::of_u),
            2e-6,
        )
        .with(&nystrom),
        twin(
            ray,
            "crossing_state find_crossing drag_over",
            "let x = find_crossing(ray_constants(), ray_state(13u), ray_state(13u), ray_state(23u), in1(33u), 3u);
             out1(x.u); out3(chart_direction(x.n, x.drag)); out1(x.delay); out_word(x.order);",
            |i| push_sign_change(i, spinning_ray, |s| s.n.z),
            |i, o| {
                let (c, from, to, h) = (constants(i), state(i, STATE), state(i, TO), i.x(H));
                let segment = Segment { from: &from, to: &to, tau: 0.0, h };
                let (found, _) = find_crossing(&c, &from, &Settings::exact(c.a), &segment, 3).expect("a crossing");
                let (sin, cos) = found.azimuth.sin_cos();
                o.near(found.u, from.u.abs());
                o.all([cos, sin, 0.0], 1.0);
                o.near(found.delay, 2.0 * (from.du / from.u).abs() + 1.0);
                o.word(found.order);
            },
            // Where it crosses is known as well as N_z is, and each as the step is.
            1e-5,
        )
        .with(&nystrom),
        twin(
            ray,
            "escape",
            "var t: RayTrace; t.from_state = ray_state(13u); t.to_state = ray_state(23u); t.h = in1(33u); t.tau = 0.5;
             let end = escape(ray_constants(), t); out3(chart_direction(end.n, end.drag)); out1(end.delay * in1(9u));",
            push_end,
            |i, o| {
                let (c, from, to, h) = (constants(i), state(i, STATE), state(i, TO), i.x(H));
                let settings = Settings { delay: false, ..Settings::exact(c.a) };
                let guess = h * Quintic::of_u(&c, &from, &to, h).root();
                let (there, h) = land(&c, &settings, &from, guess, 1e-15, |s| (s.u, s.du));
                o.v3(there.chart_direction());
                o.near((0.5 + h) * c.scale, 1.0);
            },
            STEP,
        )
        .with(&nystrom),
        twin(
            ray,
            "tau_at_horizon",
            "var t: RayTrace; t.from_state = ray_state(13u); t.h = in1(23u);
             out1(tau_at_horizon(ray_constants(), t) * in1(9u));",
            |i| {
                // A step that ends a little before the horizon.
                loop {
                    i.clear();
                    let (c, mut s) = random_ray(i, false);
                    let h = 0.1 / c.scale;
                    for _ in 0..100 {
                        let next = nystrom_step(&c, &s, h, false);
                        if next.u * c.r_plus > 0.999 || next.du <= 0.0 {
                            break;
                        }
                        s = next;
                    }
                    let next = nystrom_step(&c, &s, 0.5 * h, false);
                    if s.u * c.r_plus > 0.7 && next.u * c.r_plus < 0.999 {
                        super::geodesic::push_constants(i, &c);
                        push_state(i, &s);
                        i.push(0.5 * h);
                        return;
                    }
                }
            },
            |i, o| {
                let (c, s, h) = (constants(i), state(i, STATE), i.x(BEHIND));
                let settings = Settings { capture_u: 1.0 / c.r_plus, ..Settings::exact(0.0) };
                let end = nystrom_step(&c, &s, h, false);
                o.near((h + time_to_horizon(&c, &settings, &end)) * c.scale, 1.0);
            },
            STEP,
        )
        .with(&plain),
        twin(
            ray,
            "trace",
            "let c = ray_constants();
             let t = trace(c, ray_state(13u), Settings(0.2, 1e-6, 500u, 16u, 1.0 / c.r_plus, vec2<f32>(1.0, 0.0)));
             out_word(t.fate); out_word(crossing_count); out_word(t.inside);
             out1(first.u); out2(select(vec2<f32>(0.0), chart_direction(first.n, first.drag).xy, crossing_count > 0u));
             out1(first.delay);
             let end = escape(c, t);
             out3(select(vec3<f32>(0.0), chart_direction(end.n, end.drag), t.fate == FATE_ESCAPED));",
            push_whole_ray,
            |i, o| {
                let (c, start) = (constants(i), state(i, STATE));
                let traced = followed(&c, &start);
                o.word(traced.fate as u32);
                o.word(traced.crossings.len() as u32);
                o.word(traced.inside.into());
                match traced.crossings.first() {
                    Some(first) => {
                        let (sin, cos) = first.azimuth.sin_cos();
                        o.near(first.u, start.u);
                        o.all([cos, sin], 1.0);
                        o.near(first.delay, 1.0 / start.u);
                    }
                    None => o.all([0.0; 4], 1.0),
                }
                o.all(traced.direction.to_array(), 1.0);
            },
            // Some 40 steps.
            2e-5,
        )
        .with(&nystrom),
        twin(
            ray,
            "first_side",
            "var s = ray_state(13u); if word(23u) == 0u { s.n.z = 0.0; } out1(first_side(s));",
            |i| {
                spinning_ray(i);
                i.pick(2);
            },
            |i, o| {
                let s = state(i, STATE);
                o.put(if i.word(BEHIND) == 0 { s.dn.z } else { s.n.z });
            },
            ROUNDING,
        )
        .with(&nystrom),
    ];
    Group { name: "integrator", head: [HEAD, RAYS].concat(), twins, images: Vec::new, tables: Vec::new }
}

fn followed(c: &Constants, start: &State) -> RayTrace {
    let settings = Settings { step: 0.2, max_steps: 500, capture_u: 1.0 / c.r_plus, ..Settings::exact(c.a) };
    trace::trace(c, start, &settings)
}

/// The start of a ray that is neither nearly critical nor crosses the plane beside the horizon or far out.
fn push_whole_ray(i: &mut Inputs) {
    loop {
        i.clear();
        spinning_ray(i);
        let (c, start) = (constants(i), state(i, STATE));
        let start = State { drag: 0.0, delay: 0.0, ..start };
        let traced = followed(&c, &start);
        let clear = traced.crossings.iter().all(|x| x.u > 2e-3 && x.u * c.r_plus < 0.7);
        let escaped = traced.fate == Fate::Escaped;
        if clear && capture_margin(&c).abs() > 0.05 && (!escaped || traced.direction.z.abs() > 0.02) {
            i.truncate(STATE);
            push_state(i, &start);
            return;
        }
    }
}

/// The last step of a ray that escapes.
fn push_end(i: &mut Inputs) {
    loop {
        i.clear();
        spinning_ray(i);
        let (c, mut from) = (constants(i), state(i, STATE));
        let h = 0.25 / c.scale;
        for _ in 0..100 {
            let to = nystrom_step(&c, &from, h, false);
            if to.u <= 0.0 && to.n != DVec3::ZERO {
                i.truncate(STATE);
                push_state(i, &from);
                push_state(i, &to);
                i.push(h);
                return;
            }
            if to.u * c.r_plus > 0.8 {
                break;
            }
            from = to;
        }
    }
}
