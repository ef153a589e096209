// SPDX-License-Identifier: MIT OR Apache-2.0
// The motion of matter with depth, and the frequency that it measures of light. Mirrors src/physics/flow.rs, where the
// formulas and their sources are. Knows no light's colour and no density.

#import constants
#import geodesic/geodesic
#import shared/matter

// The laws of motion that a kernel's matter has, as bits of MOTION_*: others are left out when it is compiled.
override MOTIONS: u32 = 15u;

// The metric at a place outside the horizon.
struct Place {
    r: f32,
    cosine: f32,
    sin2: f32,
    sigma: f32,
    delta: f32,
    big_a: f32,
    lapse: f32,
    // sqrt(g_phph).
    around: f32,
}

fn place_at(c: Constants, u: f32, cosine: f32) -> Place {
    let a2 = c.a * c.a;
    let r = 1.0 / u;
    let sin2 = max((1.0 - cosine) * (1.0 + cosine), LEAST_SIN2);
    let sum = r * r + a2;
    let delta = horizon_function(c, u) * r * r;
    let big_a = sum * sum - delta * a2 * sin2;
    let sigma = r * r + a2 * cosine * cosine;
    return Place(r, cosine, sin2, sigma, delta, big_a, sqrt(sigma * delta / big_a), sqrt(big_a * sin2 / sigma));
}

fn place_omega(a: f32, at: Place) -> f32 {
    return 2.0 * a * at.r / at.big_a;
}

// Light as the ZAMO measures it, in the units of c.energy: its frequency, its momentum outwards, along phi and along
// theta, and the square of that across the radius.
struct ZamoLight {
    frequency: f32,
    radial: f32,
    azimuthal: f32,
    polar: f32,
    across2: f32,
}

// `turn`: (cos theta)' of the ray.
fn zamo_light(c: Constants, at: Place, du: f32, turn: f32) -> ZamoLight {
    let sine = sqrt(at.sin2);
    let part = c.a * c.energy * sine - c.angular_momentum / sine;
    let azimuthal = c.angular_momentum / at.around;
    let polar2 = max(c.b - part * part, 0.0) / at.sigma;
    let polar_most = sqrt(polar2);
    return ZamoLight(
        (c.energy - place_omega(c.a, at) * c.angular_momentum) / at.lapse,
        du * at.r * at.r * inverseSqrt(at.sigma * at.delta),
        azimuthal,
        clamp(turn * inverseSqrt(at.sigma) / sine, -polar_most, polar_most),
        polar2 + azimuthal * azimuthal,
    );
}

// -p.U, the frequency that matter with the velocity (along phi; outwards, of the four-velocity; along theta) measures.
fn measured_by(light: ZamoLight, velocity: vec3<f32>) -> f32 {
    let v2 = velocity.x * velocity.x + velocity.z * velocity.z;
    let gamma = sqrt((1.0 + velocity.y * velocity.y) / (1.0 - v2));
    let time = gamma * light.frequency;
    let along = velocity.y * light.radial;
    let square = (1.0 + gamma * gamma * v2) * light.frequency * light.frequency
        + velocity.y * velocity.y * light.across2;
    return select(time - along, square / (time + along), along > 0.0)
        - gamma * (velocity.x * light.azimuthal + velocity.z * light.polar);
}

// dph/dt of matter with the velocity (along phi; outwards) about the hole of spin `a`.
fn angular_velocity(a: f32, at: Place, velocity: vec2<f32>) -> f32 {
    return place_omega(a, at) + at.lapse * velocity.x / at.around;
}

// The change of ln r with time of matter with the velocity (along phi; outwards).
fn drift_rate(at: Place, velocity: vec2<f32>) -> f32 {
    let gamma = sqrt((1.0 + velocity.y * velocity.y) / (1.0 - velocity.x * velocity.x));
    return at.lapse * velocity.y / gamma * sqrt(at.delta / at.sigma) / at.r;
}

// The velocity of matter at a place, as the ZAMO there measures it.
fn flow_velocity(c: Constants, at: Place, matter: Matter) -> vec2<f32> {
    let sense = matter.sense;
    let spin = sense * c.a;
    var velocity = vec2<f32>(0.0);
    if (MOTIONS & (1u << MOTION_KEPLERIAN)) != 0u && matter.motion == MOTION_KEPLERIAN {
        velocity = keplerian(c, spin, at, matter.isco, matter.law.x, matter.law.y);
    }
    if (MOTIONS & (1u << MOTION_ANGULAR_MOMENTUM)) != 0u && matter.motion == MOTION_ANGULAR_MOMENTUM {
        velocity = with_angular_momentum(spin, at, matter.law.x);
    }
    if (MOTIONS & (1u << MOTION_RIGID)) != 0u && matter.motion == MOTION_RIGID {
        velocity = vec2<f32>(at.around / at.lapse * (matter.law.x - place_omega(spin, at)), 0.0);
    }
    if (MOTIONS & (1u << MOTION_OUTFLOW)) != 0u && matter.motion == MOTION_OUTFLOW {
        velocity = outflow(c, spin, at, matter.law.x, matter.law.y);
    }
    return vec2<f32>(sense * velocity.x, velocity.y);
}

fn keplerian(c: Constants, a: f32, at: Place, isco: f32, sub_keplerian: f32, infall: f32) -> vec2<f32> {
    if sub_keplerian == 1.0 && infall == 0.0 && at.r >= isco {
        let around = 1.0 / (at.r * sqrt(at.r) + a);
        return vec2<f32>((around - place_omega(a, at)) * at.around / at.lapse, 0.0);
    }
    let orbit = max(at.r, isco);
    let root = sqrt(orbit);
    let l = sub_keplerian * (orbit * orbit - 2.0 * a * root + a * a) / (orbit * root - 2.0 * root + a);
    let equator = place_at(c, 1.0 / at.r, 0.0);
    let ratio = equator.lapse / equator.around;
    let a_cosine = a * at.cosine;
    // Each quotient by itself: the products of two A would leave f32 far out.
    let drag = 2.0 * a * (at.r / at.big_a) * (at.delta * a_cosine * a_cosine / equator.big_a);
    let over = drag + ratio * ratio * l / (1.0 - place_omega(a, equator) * l);
    let excess = max(isco / at.r - 1.0, 0.0);
    let plunge = -sqrt(2.0 / (3.0 * isco)) * excess * sqrt(excess);
    let rain = -sqrt(2.0 * at.r * (at.r * at.r + a * a)) / at.sigma;
    return vec2<f32>(
        (1.0 - infall) * over * at.around / at.lapse,
        ((1.0 - infall) * plunge + infall * rain) * sqrt(at.sigma / at.delta),
    );
}

fn with_angular_momentum(a: f32, at: Place, l0: f32) -> vec2<f32> {
    let axis = at.r * sqrt(at.sin2);
    let l = l0 * axis * sqrt(axis) / (1.0 + axis);
    return vec2<f32>(at.lapse * l / (at.around * (1.0 - place_omega(a, at) * l)), 0.0);
}

fn outflow(c: Constants, a: f32, at: Place, speed: f32, base: f32) -> vec2<f32> {
    let share = (base / at.r) * (base / at.r);
    let outwards = speed * (1.0 - share) / (1.0 + share);
    let x = a / (4.0 * c.r_plus) * at.around;
    let around = sqrt((1.0 - outwards) * (1.0 + outwards)) * x / (1.0 + x * x);
    return vec2<f32>(around, outwards * inverseSqrt(1.0 - outwards * outwards - around * around));
}
