// SPDX-License-Identifier: MIT OR Apache-2.0
// The ray of a node of the tables of lens/schwarzschild.wgsl, for the kernels that build them. A ray is followed in
// sigma = S tau, tau being Mino time and S Constants.scale, in which all rays are about equally long. The angle that
// it sweeps is phi = kappa sigma. The formulas are in src/physics/lens/schwarzschild.rs.

#import constants
#import camera/observer
#import geodesic/geodesic
#import lens/axis
#import lens/schwarzschild
#import shared/frame

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lens: SchwarzschildLens;

// Rays with t_hat below this are followed as deviations from the critical ray: in f32 their start would otherwise be
// lost in rounding.
const NEARLY_CRITICAL: f32 = 0.0625;

// A curve u(sigma) = u_s + v, u_s being the separatrix or 0.
struct Curve {
    // The constants of the ray.
    c: Constants,
    // sqrt(K) / S.
    kappa: f32,
    // e at the observer. The separatrix (critical ray) is u_s = -1/6 + ((1 - e) / (1 + e))^2 / 2, e = e0 exp(-phi).
    e0: f32,
    // Whether v is the deviation from the separatrix; if not, u_s = 0 and v = u.
    deviates: bool,
    // v and dv/dsigma at the observer.
    v: f32,
    dv: f32,
    // -1 for nodes past psi = pi or psi = 0: their rays are on the other side of the axis, and phi counts as negative.
    side: f32,
}

struct CurvePoint {
    sigma: f32,
    v: f32,
    dv: f32,
}

// The start of the ray at t = tan((psi - psi_c) / 2); `t_hat` is |t| / lens.critical.w.
fn curve_of(t: f32, t_hat: f32) -> Curve {
    let half_c = lens.critical.x;
    // tan(psi / 2) = a / b
    let a = half_c + t;
    let b = 1.0 - half_c * t;
    let norm = 1.0 / (a * a + b * b);
    let sine = 2.0 * a * b * norm;
    let cosine = (b - a) * (b + a) * norm;
    var curve: Curve;
    curve.side = select(1.0, -1.0, sine < 0.0);
    let begin = begin_local(vec3<f32>(-cosine, 0.0, abs(sine)));
    curve.c = begin.c;
    curve.kappa = sqrt(begin.c.k) / begin.c.scale;
    curve.deviates = t_hat < NEARLY_CRITICAL;
    if curve.deviates {
        curve.e0 = lens.separatrix;
        let beta = select(0.0, frame.lapse, frame.rain != 0u);
        // sin(d / 2) and cos(d / 2) of d = psi - psi_c; cos((psi + psi_c) / 2) = cos(psi_c + d / 2).
        let cos_half = inverseSqrt(1.0 + t * t);
        let sin_half = t * cos_half;
        let middle = lens.critical.z * cos_half - lens.critical.y * sin_half;
        curve.v = 0.0;
        // v'(0) of src/physics/lens/schwarzschild.rs, by sigma; its f is lens.slope, its u_e frame.observer_u.
        curve.dv = curve.kappa * -2.0 * lens.slope * frame.observer_u * sin_half
            * (cos_half - beta * middle) / (sine * lens.critical.y);
    } else {
        curve.v = begin.state.u;
        curve.dv = begin.state.du / begin.c.scale;
    }
    return curve;
}

// (1 - e) / (1 + e) for e = e0 exp(-phi) `e`.
fn separatrix_root(e: f32) -> f32 {
    return (1.0 - e) / (1.0 + e);
}

fn separatrix_u(curve: Curve, sigma: f32) -> f32 {
    let q = separatrix_root(curve.e0 * exp(-curve.kappa * sigma));
    return select(0.0, 0.5 * q * q - 1.0 / 6.0, curve.deviates);
}

// v'' by sigma: kappa^2 v (6 u_s - 1 + 3 v).
fn curve_acceleration(curve: Curve, e: f32, v: f32) -> f32 {
    let q = separatrix_root(e);
    let rest = select(-1.0, 3.0 * q * q - 2.0, curve.deviates);
    return curve.kappa * curve.kappa * v * (rest + 3.0 * v);
}

// The factors by which e decays from a step's begin to its inner nodes and its end.
fn step_decay(curve: Curve, h: f32) -> vec3<f32> {
    return exp(vec3<f32>(0.2, 2.0 / 3.0, 1.0) * (-curve.kappa * h));
}

// Nystrom's method, as nystrom_step; u at the inner nodes goes to `inner`.
fn curve_step(curve: Curve, s: CurvePoint, h: f32, decay: vec3<f32>, inner: ptr<function, vec3<f32>>) -> CurvePoint {
    let h2 = h * h;
    let e1 = curve.e0 * exp(-curve.kappa * s.sigma);
    let e2 = e1 * decay.x;
    let e3 = e1 * decay.y;
    let e4 = e1 * decay.z;
    let f1 = curve_acceleration(curve, e1, s.v);
    let v2 = s.v + 0.2 * h * s.dv + h2 * (0.02 * f1);
    let f2 = curve_acceleration(curve, e2, v2);
    let v3 = s.v + (2.0 / 3.0) * h * s.dv + h2 * ((7.0 * f2 - f1) / 27.0);
    let f3 = curve_acceleration(curve, e3, v3);
    let v4 = s.v + h * s.dv + h2 * (0.3 * f1 - (2.0 / 35.0) * f2 + (9.0 / 35.0) * f3);
    let f4 = curve_acceleration(curve, e4, v4);
    if DELAY {
        let q = vec3<f32>(separatrix_root(e2), separatrix_root(e3), separatrix_root(e4));
        *inner = vec3<f32>(v2, v3, v4) + select(vec3<f32>(0.0), 0.5 * q * q - 1.0 / 6.0, curve.deviates);
    }
    return CurvePoint(s.sigma + h, s.v + (h * s.dv + h2 * (B1 * f1 + B2 * f2 + B3 * f3)),
        s.dv + h * (D1 * f1 + D2 * f2 + D3 * f3 + D4 * f4));
}

fn curve_u(curve: Curve, at: CurvePoint) -> f32 {
    return separatrix_u(curve, at.sigma) + at.v;
}

// du/dsigma. u_s' = 2 q e / (1 + e)^2 by phi.
fn curve_slope(curve: Curve, at: CurvePoint) -> f32 {
    let e = curve.e0 * exp(-curve.kappa * at.sigma);
    let slope = 2.0 * (1.0 - e) * e / ((1.0 + e) * (1.0 + e) * (1.0 + e));
    return select(0.0, curve.kappa * slope, curve.deviates) + at.dv;
}

// t and t_hat of node id.x of branch id.y.
fn node_t(id: vec2<u32>) -> vec2<f32> {
    let t_hat = lens_node_t_hat(i32(id.x), LENS_OCTAVES, LENS_PER_OCTAVE);
    return vec2<f32>(select(t_hat, -t_hat, id.y == 1u) * lens.critical.w, t_hat);
}

fn nodes_of(branch: u32) -> u32 {
    return select(lens.outer_nodes, lens.inner_nodes, branch == 1u);
}
