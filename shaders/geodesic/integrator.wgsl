// SPDX-License-Identifier: MIT OR Apache-2.0
// Steps of a light ray in Mino time, their dense output, and the step limit beside the horizon. Mirrors
// src/physics/integrator.rs. Knows the equations only through geodesic/geodesic.wgsl.

#import constants
#import geodesic/geodesic
#import shared/math

override METHOD: u32 = 0u;
// Drag and delay diverge at the horizon, and inside it u is large: only then steps need a limit.
override STEP_LIMIT: bool = true;

struct Step {
    state: State,
    // The error by the embedded method; 0 for the other methods.
    error: f32,
}

fn step_ray(c: Constants, s: State, h: f32) -> Step {
    if METHOD == METHOD_RK4 {
        return Step(rk4_step(c, s, h), 0.0);
    }
    if METHOD == METHOD_DORMAND_PRINCE {
        return dormand_prince_step(c, s, h);
    }
    return Step(nystrom_step(c, s, h), 0.0);
}

// Order 5 (src/physics/integrator.rs); without spin N turns evenly, which is exact.
fn nystrom_step(c: Constants, s: State, h: f32) -> State {
    let h2 = h * h;
    let f1 = u_acceleration(c, s.u);
    let u2 = s.u + 0.2 * h * s.du + h2 * (0.02 * f1);
    let f2 = u_acceleration(c, u2);
    let u3 = s.u + (2.0 / 3.0) * h * s.du + h2 * ((7.0 * f2 - f1) / 27.0);
    let f3 = u_acceleration(c, u3);
    let u4 = s.u + h * s.du + h2 * (0.3 * f1 - (2.0 / 35.0) * f2 + (9.0 / 35.0) * f3);
    let f4 = u_acceleration(c, u4);
    var end = s;
    end.u = s.u + (h * s.du + h2 * (B1 * f1 + B2 * f2 + B3 * f3));
    end.du = s.du + h * (D1 * f1 + D2 * f2 + D3 * f3 + D4 * f4);
    if SPINNING && RAIN {
        nystrom_step_of_n(c, s, h, &end);
        rain_step(c, s, h, &end);
    } else if SPINNING {
        end.drag += h * (D1 * drag_rate(c, s.u) + D2 * drag_rate(c, u2)
            + D3 * drag_rate(c, u3) + D4 * drag_rate(c, u4));
        let n_z = nystrom_step_of_n(c, s, h, &end);
        if DELAY {
            end.delay += h * (D1 * delay_rate(c, s.u, s.n.z) + D2 * delay_rate(c, u2, n_z.x)
                + D3 * delay_rate(c, u3, n_z.y) + D4 * delay_rate(c, u4, n_z.z));
        }
    } else {
        turn_n(c, s, h, &end);
        if DELAY {
            end.delay += h * (D1 * delay_rate(c, s.u, 0.0) + D2 * delay_rate(c, u2, 0.0) + D3 * delay_rate(c, u3, 0.0)
                + D4 * delay_rate(c, u4, 0.0));
        }
    }
    return end;
}

// N and N' of the step; N_z at the nodes.
fn nystrom_step_of_n(c: Constants, s: State, h: f32, end: ptr<function, State>) -> vec3<f32> {
    let h2 = h * h;
    let f1 = n_acceleration(c, s.n);
    let n2 = s.n + s.dn * (0.2 * h) + f1 * (0.02 * h2);
    let f2 = n_acceleration(c, n2);
    let n3 = s.n + s.dn * (2.0 / 3.0 * h) + (f2 * 7.0 - f1) * (h2 / 27.0);
    let f3 = n_acceleration(c, n3);
    let n4 = s.n + s.dn * h + (f1 * 0.3 - f2 * (2.0 / 35.0) + f3 * (9.0 / 35.0)) * h2;
    let f4 = n_acceleration(c, n4);
    (*end).n = s.n + (s.dn * h + (f1 * B1 + f2 * B2 + f3 * B3) * h2);
    (*end).dn = s.dn + (f1 * D1 + f2 * D2 + f3 * D3 + f4 * D4) * h;
    return vec3<f32>(n2.z, n3.z, n4.z);
}

// a = 0: N'' = -K N turns N by sqrt(K) h in the ray's plane.
fn turn_n(c: Constants, s: State, h: f32, end: ptr<function, State>) {
    let kappa = sqrt(max(c.k, 1e-30));
    let turn = sincos(kappa * h);
    (*end).n = s.n * turn.y + s.dn * (turn.x / kappa);
    (*end).dn = s.dn * turn.y - s.n * (turn.x * kappa);
}

// Drag, to Kerr's azimuth, and rain time's delay over one step, by Gauss-Legendre on the dense output: their rates need
// u'.
fn rain_step(c: Constants, s: State, h: f32, end: ptr<function, State>) {
    let u = quintic_of_u(c, s, *end, h);
    let n_z = quintic_of_n_z(c, s, *end, h);
    // Slopes are by the step.
    let by_tau = select(1.0 / h, 0.0, h == 0.0);
    var drag = 0.0;
    var delay = 0.0;
    for (var i = 0; i < 3; i++) {
        let x = GAUSS_NODES[i];
        let there = quintic_at(u, x);
        let slope = quintic_slope(u, x) * by_tau;
        drag += GAUSS_WEIGHTS[i] * kerr_drag_rate(c, there, slope);
        if DELAY {
            delay += GAUSS_WEIGHTS[i] * rain_delay_rate(c, there, slope, quintic_at(n_z, x));
        }
    }
    (*end).drag += h * drag;
    (*end).delay += h * delay;
}

fn derivative(c: Constants, s: State) -> State {
    var drag = 0.0;
    var delay = 0.0;
    if SPINNING && RAIN {
        drag = kerr_drag_rate(c, s.u, s.du);
        if DELAY {
            delay = rain_delay_rate(c, s.u, s.du, s.n.z);
        }
    } else {
        drag = drag_rate(c, s.u);
        delay = delay_rate(c, s.u, s.n.z);
    }
    return State(s.du, u_acceleration(c, s.u), s.dn, n_acceleration(c, s.n), drag, delay);
}

// s + h d.
fn advance(s: State, h: f32, d: State) -> State {
    return State(s.u + h * d.u, s.du + h * d.du, s.n + d.n * h, s.dn + d.dn * h, s.drag + h * d.drag,
        s.delay + h * d.delay);
}

// a x + b y.
fn blend(a: f32, x: State, b: f32, y: State) -> State {
    return State(a * x.u + b * y.u, a * x.du + b * y.du, x.n * a + y.n * b, x.dn * a + y.dn * b,
        a * x.drag + b * y.drag, a * x.delay + b * y.delay);
}

fn rk4_step(c: Constants, s: State, h: f32) -> State {
    let k1 = derivative(c, s);
    let k2 = derivative(c, advance(s, 0.5 * h, k1));
    let k3 = derivative(c, advance(s, 0.5 * h, k2));
    let k4 = derivative(c, advance(s, h, k3));
    let sum = blend(1.0, blend(1.0 / 6.0, k1, 1.0 / 3.0, k2), 1.0, blend(1.0 / 3.0, k3, 1.0 / 6.0, k4));
    return advance(s, h, sum);
}

// Dormand & Prince 1980, RK5(4)7M.
fn dormand_prince_step(c: Constants, s: State, h: f32) -> Step {
    let k1 = derivative(c, s);
    let k2 = derivative(c, advance(s, 0.2 * h, k1));
    let k3 = derivative(c, advance(s, h, blend(3.0 / 40.0, k1, 9.0 / 40.0, k2)));
    let w4 = blend(1.0, blend(44.0 / 45.0, k1, -56.0 / 15.0, k2), 32.0 / 9.0, k3);
    let k4 = derivative(c, advance(s, h, w4));
    let w5 = blend(1.0, blend(19372.0 / 6561.0, k1, -25360.0 / 2187.0, k2), 1.0,
        blend(64448.0 / 6561.0, k3, -212.0 / 729.0, k4));
    let k5 = derivative(c, advance(s, h, w5));
    let w6 = blend(1.0, blend(1.0, blend(9017.0 / 3168.0, k1, -355.0 / 33.0, k2), 1.0,
        blend(46732.0 / 5247.0, k3, 49.0 / 176.0, k4)), -5103.0 / 18656.0, k5);
    let k6 = derivative(c, advance(s, h, w6));
    let w7 = blend(1.0, blend(1.0, blend(35.0 / 384.0, k1, 500.0 / 1113.0, k3), 1.0,
        blend(125.0 / 192.0, k4, -2187.0 / 6784.0, k5)), 11.0 / 84.0, k6);
    let end = advance(s, h, w7);
    let k7 = derivative(c, end);
    let e = blend(1.0, blend(1.0, blend(71.0 / 57600.0, k1, -71.0 / 16695.0, k3), 1.0,
        blend(71.0 / 1920.0, k4, -17253.0 / 339200.0, k5)), 1.0, blend(22.0 / 525.0, k6, -1.0 / 40.0, k7));
    return Step(end, h * error_norm(c, end, e));
}

fn error_norm(c: Constants, s: State, error: State) -> f32 {
    let u_scale = abs(s.u) + 1e-3;
    let n = abs(error.n);
    let dn = abs(error.dn);
    let u_part = max(abs(error.u), abs(error.du) / c.scale) / u_scale;
    let n_part = max(max(n.x, max(n.y, n.z)), max(dn.x, max(dn.y, dn.z)) / c.scale);
    return max(max(u_part, n_part), abs(error.drag));
}

// Largest step in tau here; `h` is the step in sigma.
fn step_limit(c: Constants, s: State, h: f32) -> f32 {
    let u_plus = 1.0 / c.r_plus;
    let curvature = abs(u_acceleration(c, s.u));
    if SPINNING && RAIN {
        return rain_step_limit(c, s, h);
    }
    let leaves = !SPINNING && c.clock == CLOCK_RAIN && s.du < 0.0;
    // With spin nothing is traced inside.
    if !SPINNING && s.u >= select(u_plus * (1.0 + HORIZON_ROOM), u_plus, leaves) {
        return h * s.u / (abs(s.du) + sqrt(curvature * s.u));
    }
    let room = max(u_plus - s.u, HORIZON_ROOM * u_plus);
    let limit = clamp(1.2 * h, 0.03, 0.35) * room / (abs(s.du) + sqrt(curvature * room));
    return select(1e30, limit, s.u > 0.3 * u_plus && !leaves);
}

// The shortest step in sigma in Doran's chart.
const SHORTEST_ADVANCE: f32 = 2e-3;
// So near to the horizon, relative, u' is left as it is: D is lost in rounding there.
const HELD_FROM: f32 = 1e-5;

// step_limit in Doran's chart.
fn rain_step_limit(c: Constants, s: State, h: f32) -> f32 {
    let u_plus = 1.0 / c.r_plus;
    let curvature = u_acceleration(c, s.u);
    let relative = s.u / (abs(s.du) + sqrt(abs(curvature) * s.u));
    let total = radial_energy(c, s.u);
    let slope = 2.0 * c.a * (c.a * c.energy - c.angular_momentum) * s.u * s.du - curvature;
    let advance = 1.5 * h * (total - s.du) / max(abs(slope), 1e-30);
    let inside = s.u >= u_plus;
    let beside = select(u_plus - s.u, min(s.u - u_plus, max(1.0 - c.r_minus * s.u, 0.0) / c.r_minus), inside);
    let room = max(beside, HORIZON_ROOM * u_plus);
    let in_room = clamp(1.2 * h, 0.03, 0.35) * room / (abs(s.du) + sqrt(abs(curvature) * room));
    var limit = select(in_room, min(advance, 1.5 * h * relative), s.du < 0.0);
    if inside {
        limit = min(h * relative, select(in_room, advance, total >= 0.0));
    }
    // In steps that are shorter, rounding leaves u where it is.
    return select(1e30, max(limit, SHORTEST_ADVANCE / c.scale), s.u > 0.3 * u_plus);
}

// Inside the horizon with u' from the first integral (integrator.rs: held_inside).
fn held_inside(c: Constants, s: State) -> State {
    var held = s;
    if SPINNING && RAIN && STEP_LIMIT {
        let w = radial_energy(c, s.u);
        let d = (1.0 - c.r_plus * s.u) * (1.0 - c.r_minus * s.u);
        let du = -sqrt(max(w * w - d * c.b * s.u * s.u, 0.0));
        held.du = select(s.du, du, s.du < 0.0 && s.u * c.r_plus >= 1.0 + HELD_FROM);
    }
    if !SPINNING && STEP_LIMIT {
        let du = -sqrt(max(c.energy * c.energy + c.k * s.u * s.u * (2.0 * s.u - 1.0), 0.0));
        held.du = select(s.du, du, s.du < 0.0 && s.u * c.r_plus >= 1.0);
    }
    return held;
}

// Quintic Hermite interpolation over one step, in the fraction of the step.
struct Quintic {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn quintic(y0: f32, d0h: f32, c0hh: f32, y1: f32, d1h: f32, c1hh: f32) -> Quintic {
    let rise = y1 - y0;
    return Quintic(
        vec3<f32>(y0, d0h, 0.5 * c0hh),
        vec3<f32>(
            10.0 * rise - 6.0 * d0h - 4.0 * d1h - 1.5 * c0hh + 0.5 * c1hh,
            -15.0 * rise + 8.0 * d0h + 7.0 * d1h + 1.5 * c0hh - c1hh,
            6.0 * rise - 3.0 * (d0h + d1h) - 0.5 * (c0hh - c1hh),
        ),
    );
}

fn quintic_of_u(c: Constants, a: State, b: State, h: f32) -> Quintic {
    let hh = h * h;
    return quintic(a.u, a.du * h, u_acceleration(c, a.u) * hh, b.u, b.du * h, u_acceleration(c, b.u) * hh);
}

fn quintic_of_n_z(c: Constants, a: State, b: State, h: f32) -> Quintic {
    let hh = h * h;
    return quintic(a.n.z, a.dn.z * h, n_acceleration(c, a.n).z * hh, b.n.z, b.dn.z * h, n_acceleration(c, b.n).z * hh);
}

fn quintic_at(q: Quintic, x: f32) -> f32 {
    return q.low.x + x * (q.low.y + x * (q.low.z + x * (q.high.x + x * (q.high.y + x * q.high.z))));
}

fn quintic_slope(q: Quintic, x: f32) -> f32 {
    return q.low.y + x * (2.0 * q.low.z + x * (3.0 * q.high.x + x * (4.0 * q.high.y + x * 5.0 * q.high.z)));
}

// The fraction in [0, 1] where the value is 0, for end values of opposite sign (or 0): Newton's method in a shrinking
// bracket.
fn quintic_root(q: Quintic) -> f32 {
    let end = q.low.x + q.low.y + q.low.z + q.high.x + q.high.y + q.high.z;
    let rising = end > q.low.x;
    var low = 0.0;
    var high = 1.0;
    var x = clamp(q.low.x / (q.low.x - end), 0.0, 1.0);
    for (var i = 0; i < 4; i++) {
        let value = q.low.x + x * (q.low.y + x * (q.low.z + x * (q.high.x + x * (q.high.y + x * q.high.z))));
        let slope = q.low.y + x * (2.0 * q.low.z + x * (3.0 * q.high.x + x * (4.0 * q.high.y + x * 5.0 * q.high.z)));
        let past = (value > 0.0) == rising;
        high = select(high, x, past);
        low = select(x, low, past);
        let newton = x - value / slope;
        x = select(0.5 * (low + high), newton, newton >= low && newton <= high);
    }
    return x;
}
