// SPDX-License-Identifier: MIT OR Apache-2.0
// The way from a look direction to the start of its ray: aberration and the local frame. Mirrors
// src/physics/observer.rs; knows no integrator.

#import constants
#import geodesic/geodesic
#import shared/not_inlined
#import shared/frame

struct RayBegin {
    c: Constants,
    state: State,
    // nu(camera) / nu(observer of the local frame).
    frequency_ratio: f32,
    // False: no light can come from there (rain frame, Observer::start_rain of observer.rs).
    has_light: bool,
    // Q.
    carter: f32,
}

// The look direction in the local frame for `look` in the camera's own (aberration; beta = 0 leaves it), and
// nu(camera) / nu(observer of the local frame).
struct LookDirection {
    // In the camera's own frame, and in the local one.
    look: vec3<f32>,
    n: vec3<f32>,
    frequency_ratio: f32,
}

// False: the camera rests in the local frame.
override MOVING: bool = true;

fn aberrate(look: vec3<f32>) -> LookDirection {
    if !MOVING {
        return LookDirection(look, look, 1.0);
    }
    let beta = frame.beta;
    let gamma = frame.gamma;
    let along = dot(beta, look);
    // In f32 an observer that falls beside the horizon moves at 1: its ray straight ahead is as good as any.
    let ratio = 1.0 / (gamma * max(1.0 - along, 6e-8));
    let n = normalize((look + beta * (gamma * gamma / (gamma + 1.0) * along - gamma)) * ratio);
    var seen = LookDirection(look, n, ratio);
    if bitcast<f32>(not_inlined(bitcast<u32>(gamma))) > SWIFT_GAMMA {
        // With the angle w between look and the motion, and f = 1 - cos w: 1 - beta cos w = (1 - beta) + beta f, and
        // along the motion n holds (cos w - beta) / (1 - beta cos w), across it what look holds, times ratio.
        let motion = normalize(beta);
        let off = look - motion;
        let f = 0.5 * dot(off, off);
        let lag = one_less_beta(gamma);
        let q = lag + (1.0 - lag) * f;
        let swift = 1.0 / (gamma * q);
        seen = LookDirection(look, normalize(motion * ((lag - f) / q) + (off + motion * f) * swift), swift);
    }
    return seen;
}

// 1 - beta = (1 / gamma^2) / (1 + beta).
fn one_less_beta(gamma: f32) -> f32 {
    let inverse = 1.0 / (gamma * gamma);
    return inverse / (1.0 + sqrt(1.0 - inverse));
}

// Change of `seen.n` when the look direction in the camera's own frame changes by `change`; at rest with what that
// holds along it.
fn aberrate_change(seen: LookDirection, change: vec3<f32>) -> vec3<f32> {
    if !MOVING {
        return change;
    }
    let beta = frame.beta;
    let gamma = frame.gamma;
    let turn = change - seen.look * dot(seen.look, change);
    let along = dot(beta, turn);
    let ratio = seen.frequency_ratio;
    var turned = ratio * (turn + beta * (gamma * gamma / (gamma + 1.0) * along) + seen.n * (gamma * along));
    if bitcast<f32>(not_inlined(bitcast<u32>(gamma))) > SWIFT_GAMMA {
        // The derivative of what aberrate has for these, with d(cos w) = motion . turn = -off . turn.
        let motion = normalize(beta);
        let off = seen.look - motion;
        let cosine = -dot(off, turn);
        let across = off + motion * (0.5 * dot(off, off));
        let bend = (1.0 - one_less_beta(gamma)) * gamma * ratio * cosine;
        turned = ratio * (turn - motion * cosine + across * bend + motion * (ratio * cosine));
    }
    return turned;
}

// Lens::closest_approach_towards.
fn closest_approach(n: vec3<f32>) -> f32 {
    let speed = frame.eye.w;
    return max((speed - n.x) / (1.0 - speed * n.x), 0.0) / frame.observer_u;
}

fn begin_ray(look: vec3<f32>) -> RayBegin {
    let seen = aberrate(look);
    var begin = begin_local(seen.n);
    begin.frequency_ratio = seen.frequency_ratio;
    return begin;
}

// The ray along a look direction in the local frame; frequency_ratio is 1.
fn begin_local(n: vec3<f32>) -> RayBegin {
    var begin: RayBegin;
    begin.frequency_ratio = 1.0;
    if SPINNING && RAIN {
        begin_spinning_rain(&begin, n);
    } else if !SPINNING && not_inlined(frame.rain) != 0u {
        begin_rain(&begin, n);
    } else {
        begin_zamo(&begin, n);
    }
    return begin;
}

// Record::polar_momentum of a ray; `ratio`: nu(camera) / nu(local frame).
fn polar_momentum(begin: RayBegin, ratio: f32) -> f32 {
    return sqrt(max(begin.carter, 0.0)) / (begin.c.nu_local * ratio);
}

fn constants(energy: f32, angular_momentum: f32, carter: f32, k: f32, nu_local: f32) -> Constants {
    let a = frame.spin;
    let a2e2 = a * a * energy * energy;
    let b = k - 2.0 * a * angular_momentum * energy + a2e2;
    let scale = max(sqrt(max(k + a2e2, 0.0)), 3.0 * abs(energy));
    return Constants(a, energy, angular_momentum, nu_local, k, b, a2e2, a * a * carter, scale, frame.observer_u,
        frame.r_plus, frame.r_minus, select(CLOCK_COORDINATE, CLOCK_RAIN, frame.rain == RAIN_CLOCK));
}

// Scaled so that the local observer measures frequency 1: good for every E (geodesic.rs).
fn begin_zamo(begin: ptr<function, RayBegin>, n: vec3<f32>) {
    let u = frame.observer_u;
    let s = frame.observer_sine;
    let c = frame.observer_cosine;
    let a = frame.spin;
    let omega = frame.omega;
    let q = frame.q;
    let p = -n;
    let energy = frame.lapse + omega * q * s * p.z;
    let polar = frame.root_sigma * p.y / u;
    let w = q * p.z;
    let carter = polar * polar + c * c * (w * w - a * a * energy * energy);
    let k = polar * polar + w * w - a * a * c * c * energy * energy;
    (*begin).c = constants(energy, s * w, carter, k, 1.0);
    (*begin).carter = carter;
    (*begin).state = State(u, frame.root_sigma_d * p.x, frame.e_r.xyz,
        -(frame.e_theta.xyz * polar + frame.e_phi.xyz * w), 0.0, 0.0);
    (*begin).has_light = true;
}

// Spin 0: beta_rain = sqrt(2 u) is place.w.
fn begin_rain(begin: ptr<function, RayBegin>, n: vec3<f32>) {
    let u = frame.observer_u;
    let beta = frame.lapse;
    let p = -n;
    let energy = 1.0 + beta * n.x;
    let e = 1.0 / max(energy, 1e-6);
    let polar = p.y * e / u;
    let w = p.z * e / u;
    let cw = frame.observer_cosine * w;
    let k = polar * polar + w * w;
    (*begin).carter = polar * polar + cw * cw;
    (*begin).c = constants(1.0, frame.observer_sine * w, (*begin).carter, k, e);
    (*begin).state = State(u, e * (p.x - beta), frame.e_r.xyz,
        -(frame.e_theta.xyz * polar + frame.e_phi.xyz * w), 0.0, 0.0);
    (*begin).has_light = energy > 0.0;
}

// Below this E, rays of the rain frame of a spinning hole keep nu_local = 1: f32 would not hold their constants.
const SMALLEST_RAIN_ENERGY: f32 = 0.02;

// With spin: start_rain, rain_triad and doran_momentum of observer.rs.
fn begin_spinning_rain(begin: ptr<function, RayBegin>, n: vec3<f32>) {
    let u = frame.observer_u;
    let s = frame.observer_sine;
    let c = frame.observer_cosine;
    let a = frame.spin;
    let w = frame.lapse;
    let sin_turn = frame.rain_triad.x;
    let cos_turn = frame.rain_triad.y;
    let rho = frame.rain_triad.z;
    let circumference = frame.rain_triad.w;
    let q = sqrt(1.0 + a * a * u * u);
    let p = -n;
    let radial = cos_turn * p.x + sin_turn * p.z;
    let across = cos_turn * p.z - sin_turn * p.x;
    let seen = 1.0 - w / rho * radial;
    // E = 1 where that scales nothing beyond use.
    let is_unit = seen > SMALLEST_RAIN_ENERGY;
    let e = select(1.0, 1.0 / seen, is_unit);
    let energy = select(seen, 1.0, is_unit);
    let polar = e * rho * p.y / u;
    let around = e * circumference * p.z / u;
    let du = e * (q * (rho * radial - w) + a * u * s * w * across);
    let k = polar * polar + around * around - c * c * a * a * energy * energy;
    let carter = polar * polar + c * c * (around * around - a * a * energy * energy);
    (*begin).c = constants(energy, s * around, carter, k, e);
    (*begin).carter = carter;
    (*begin).state =
        State(u, du, frame.e_r.xyz, -(frame.e_theta.xyz * polar + frame.e_phi.xyz * around), frame.kerr_turn, 0.0);
    // Inside the horizon, P > 0 at r+.
    let from_outside = energy * (frame.r_plus * frame.r_plus + a * a) > a * s * around;
    (*begin).has_light = from_outside || u * frame.r_plus < 1.0;
}

// g of the disk's matter for the local frame's observer, of light that crosses the plane at 1/r = u with u' = du
// (Matter::redshift of src/physics/plunge.rs).
fn redshift_at(c: Constants, u: f32, du: f32) -> f32 {
    if u * frame.plunge_isco > 1.0 {
        return c.nu_local / plunging_frequency(c, u, du);
    }
    return redshift_of(c, u);
}

// The frequency that plunging matter measures (Plunge::frequency).
fn plunging_frequency(c: Constants, u: f32, du: f32) -> f32 {
    let u2 = u * u;
    let x = c.angular_momentum - c.a * c.energy;
    let w_matter = frame.plunge_energy - frame.plunge_spin_term * u2;
    let w_light = c.energy - c.a * x * u2;
    let excess = max(frame.plunge_isco * u - 1.0, 0.0);
    let infall = sqrt(2.0 / (3.0 * frame.plunge_isco)) * excess * sqrt(excess);
    let outwards = (w_matter * w_light + infall * du) / horizon_function(c, u);
    let inwards = (w_matter * w_matter * c.b * u2 + (1.0 + frame.plunge_x * frame.plunge_x * u2) * du * du)
        / (w_matter * w_light - infall * du);
    return select(inwards, outwards, du >= 0.0) - frame.plunge_x * x * u2;
}

// g of the disk's matter on its circular orbit (physics::orbit::redshift).
fn redshift_of(c: Constants, u: f32) -> f32 {
    return c.nu_local * orbital_redshift(c.energy, c.angular_momentum, u);
}

// g of the disk's matter on its circular orbit, of light that has E and L where the observer measures frequency 1.
fn orbital_redshift(energy: f32, angular_momentum: f32, u: f32) -> f32 {
    let v = sign(frame.signed_isco) * u * sqrt(u);
    return sqrt(max(1.0 - 3.0 * u + 2.0 * frame.spin * v, 0.0))
        / (energy * (1.0 + frame.spin * v) - v * angular_momentum);
}

// g of light that has this E and L where the local observer measures frequency 1, from matter at 1/r = u near its
// crossing of the plane, of which 1/r and g are `known` (Matter::redshift_beside). `ratio`: nu(camera) / nu(local
// frame).
fn redshift_beside(energy: f32, angular_momentum: f32, ratio: f32, u: f32, known: vec2<f32>) -> f32 {
    let plunges = max(u, known.x) * frame.plunge_isco > 1.0;
    return select(ratio * orbital_redshift(energy, angular_momentum, u), known.y, plunges);
}
