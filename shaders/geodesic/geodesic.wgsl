// SPDX-License-Identifier: MIT OR Apache-2.0
// Light rays traced backward, in Mino time: the equations of motion. Mirrors src/physics/geodesic.rs,
// where the formulas and their sources stand. Knows no integrator and no observer.

#import constants
#import shared/math

// Choices that a pipeline is made for; the host compiles one for each combination that it needs.
override SPINNING: bool = true;
override DELAY: bool = true;
// With SPINNING: rays are traced in Doran's chart, in which observers in the rain frame of a spinning hole see.
override RAIN: bool = false;

struct Constants {
    a: f32,
    energy: f32,
    angular_momentum: f32,
    nu_local: f32,
    // K, B, a^2 E^2, a^2 Q and S as in the Rust.
    k: f32,
    b: f32,
    a2e2: f32,
    a2q: f32,
    scale: f32,
    u_observer: f32,
    r_plus: f32,
    r_minus: f32,
    // CLOCK_*.
    clock: u32,
}

struct State {
    u: f32,
    du: f32,
    n: vec3<f32>,
    dn: vec3<f32>,
    drag: f32,
    delay: f32,
}

// u'' and N''.
fn u_acceleration(c: Constants, u: f32) -> f32 {
    return u * (c.a2e2 - c.k + u * (3.0 * c.b - u * (2.0 * c.a2q)));
}

fn n_acceleration(c: Constants, n: vec3<f32>) -> vec3<f32> {
    if !SPINNING {
        return n * -c.k;
    }
    let f = n * -(c.k + 2.0 * c.a2e2 * n.z * n.z);
    return vec3<f32>(f.xy, f.z + c.a2e2 * n.z);
}

// Nearer to the horizon than this, relative, f32 cannot place anything.
const HORIZON_ROOM: f32 = 2e-7;

// D from its roots: no cancellation near the horizon. Never 0; what drag and delay are inside, no one asks.
fn horizon_function(c: Constants, u: f32) -> f32 {
    return max(1.0 - c.r_plus * u, HORIZON_ROOM) * (1.0 - c.r_minus * u);
}

// D of both signs, and never 0.
fn signed_horizon_function(c: Constants, u: f32) -> f32 {
    let room = 1.0 - c.r_plus * u;
    let kept = select(max(room, HORIZON_ROOM), min(room, -HORIZON_ROOM), room < 0.0);
    return kept * max(1.0 - c.r_minus * u, HORIZON_ROOM);
}

// W.
fn radial_energy(c: Constants, u: f32) -> f32 {
    return c.energy + c.a * (c.a * c.energy - c.angular_momentum) * (u * u);
}

// x.
fn advanced_rate(c: Constants, u: f32, du: f32) -> f32 {
    let w = radial_energy(c, u);
    let falls = w >= 0.0 && du <= 0.0;
    return select(w + du, c.b * u * u, falls) / select(signed_horizon_function(c, u), w - du, falls);
}

// How fast N turns, at most.
fn turn_rate(c: Constants) -> f32 {
    return sqrt(abs(c.k) + 2.0 * abs(c.a2e2));
}

// drag' to Kerr's azimuth.
fn kerr_drag_rate(c: Constants, u: f32, du: f32) -> f32 {
    return -c.a * (advanced_rate(c, u, du) - c.energy);
}

fn drag_rate(c: Constants, u: f32) -> f32 {
    if !SPINNING {
        return 0.0;
    }
    return -c.a * u * (2.0 * c.energy - c.a * c.angular_momentum * u) / horizon_function(c, u);
}

fn delay_by_parts(c: Constants) -> bool {
    // Above this E the integration by parts divides by nothing small; far crossings need it (geodesic.rs).
    return c.energy > 0.05;
}

// d/dtau of State.delay. With RAIN, rain_delay_rate is instead.
fn delay_rate(c: Constants, u: f32, n_z: f32) -> f32 {
    if !DELAY {
        return 0.0;
    }
    if SPINNING {
        return coordinate_delay_rate(c, u, n_z);
    }
    return select(coordinate_delay_rate(c, u, n_z), plain_rain_delay_rate(c, u), c.clock == CLOCK_RAIN);
}

// With E > 0 the parts of E^2/u^2 and E^2/u are as for E = 1, over E.
fn coordinate_delay_rate(c: Constants, u: f32, n_z: f32) -> f32 {
    let frame = c.a * c.a * c.energy * n_z * n_z;
    let horizon = (4.0 * c.energy - 2.0 * c.a * c.angular_momentum * u) / horizon_function(c, u);
    if !delay_by_parts(c) {
        let r = 1.0 / u;
        return c.energy * r * (r + 2.0) + frame + horizon;
    }
    let l = log(max(u / c.u_observer, 1e-30));
    let by_parts = (c.k - c.a2e2) * u * (1.0 + l) - c.b * u * u * (2.0 + 3.0 * l) + c.a2q * u * u * u * (1.0 + 2.0 * l);
    return (c.b * u - c.a2q * u * u + 2.0 * by_parts) / c.energy + frame + horizon;
}

// E = 1. The nodes of a step have no u'; but rays that escape from the photon sphere or deeper, the only ones asked
// for, all move outwards: u' = -sqrt(1 - K u^2 D).
fn plain_rain_delay_rate(c: Constants, u: f32) -> f32 {
    let l = log(max(u, 1e-30));
    let du = -sqrt(max(1.0 - c.k * u * u * (1.0 - 2.0 * u), 0.0));
    return c.k * u * (3.0 + 2.0 * l - 2.0 * u * (2.0 + 3.0 * l) + 4.0 * u / (1.0 - du));
}

// d/dtau of rain time about a spinning hole: Constants::rain_delay_rate of geodesic.rs.
fn rain_delay_rate(c: Constants, u: f32, du: f32, n_z: f32) -> f32 {
    let a2 = c.a * c.a;
    let w = sqrt(2.0 * max(u, 0.0));
    let q = sqrt(1.0 + a2 * u * u);
    let total = radial_energy(c, u);
    if c.energy != 1.0 {
        let around = c.a * (c.angular_momentum - c.a * c.energy * (1.0 - n_z) * (1.0 + n_z));
        return (total + 2.0 * u * advanced_rate(c, u, du) + w / (q + w) * du) / (u * u) + around;
    }
    let l = log(max(abs(u), 1e-30));
    let k = c.k - a2;
    let by_parts = k * u * (1.0 + l) - c.b * u * u * (2.0 + 3.0 * l) + c.a2q * u * u * u * (1.0 + 2.0 * l);
    let falling = c.b * u / (total - du) - u * (k - 2.0 * c.b * u + c.a2q * u * u) / (1.0 - du);
    let other = (2.0 - c.a * c.angular_momentum * u + du * (2.0 - a2 * u)) / signed_horizon_function(c, u);
    let y = select(other, falling, total >= 0.0 && du <= 0.0);
    let beside = -w * a2 * du / ((1.0 + q) * (q + w) * (1.0 + w));
    return c.b * u - c.a2q * u * u + 2.0 * by_parts + a2 * n_z * n_z + 2.0 * y + beside;
}

fn delay_boundary(c: Constants, u: f32, du: f32) -> f32 {
    if SPINNING && !RAIN {
        return coordinate_delay_boundary(c, u, du);
    }
    if SPINNING && RAIN && c.energy != 1.0 {
        return 0.0;
    }
    let rain = 2.0 * du * log(u) - du / u - 2.0 * sqrt(2.0 / u) + 4.0 * log(1.0 + sqrt(2.0 * u));
    return select(coordinate_delay_boundary(c, u, du), rain, SPINNING || c.clock == CLOCK_RAIN);
}

fn coordinate_delay_boundary(c: Constants, u: f32, du: f32) -> f32 {
    if !delay_by_parts(c) {
        return 0.0;
    }
    return (2.0 * du * log(u / c.u_observer) - du / u) / c.energy;
}

// The clock's time less t at u, outside the horizon: H of rain_offset. With RAIN camera/chart.wgsl has it.
fn clock_offset(c: Constants, u: f32) -> f32 {
    if SPINNING {
        return 0.0;
    }
    let w = sqrt(2.0 * u);
    let root = 1.0 + w;
    return select(0.0, 4.0 / w + 2.0 * log((1.0 - 2.0 * u) / (root * root)), c.clock == CLOCK_RAIN);
}

// The clock's time at the observer less the t at which light left `there`, with the integral part of the delay between
// them.
fn retardation(c: Constants, observer_u: f32, observer_du: f32, u: f32, du: f32, integral: f32) -> f32 {
    return delay_boundary(c, u, du) - delay_boundary(c, observer_u, observer_du) + integral + clock_offset(c, u);
}

// The chart direction of N, normalised, turned by the drag.
fn chart_direction(n_raw: vec3<f32>, drag: f32) -> vec3<f32> {
    let n = normalize(n_raw);
    if !SPINNING {
        return n;
    }
    let turn = sincos(drag);
    return vec3<f32>(n.x * turn.y - n.y * turn.x, n.x * turn.x + n.y * turn.y, n.z);
}
