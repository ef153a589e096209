// SPDX-License-Identifier: MIT OR Apache-2.0
// The parts of light's frequency shift that a scene's effects (BHR_EFFECT_*) show. Mirrors src/emit/effects.rs
// and src/physics/orbit.rs. Knows no emitter and no colour.

#import constants
#import shared/frame

// True: every effect on the colour or brightness of light is on, and g is used as it is. False: at least one is off.
override ALL_EFFECTS: bool = true;

// Ratios of seen to emitted frequency: the one that shading uses for colour, and the one for brightness (beaming).
struct Shift {
    colour: f32,
    beaming: f32,
}

// v^strength, exact where the strength is 0 or 1.
fn to_strength(v: f32, strength: f32) -> f32 {
    return select(select(pow(v, strength), v, strength == 1.0), 1.0, strength == 0.0);
}

// Weakens what of g the effects show less. g = gravity * Doppler shift; `gravity` is between the ZAMOs (without spin:
// static observers) at the emitter and at the camera. Beaming takes all of g.
fn visible_shift(g: f32, gravity: f32) -> Shift {
    let beyond = frame.gravity_strength - frame.doppler_strength;
    let part = to_strength(gravity, abs(beyond));
    var colour = to_strength(g, frame.doppler_strength);
    if beyond < 0.0 {
        colour /= part;
    } else {
        colour *= part;
    }
    return Shift(colour, to_strength(g, frame.beaming_strength));
}

// nu(static observer or ZAMO where the camera is), for E and L scaled to nu_local = 1; in the rain frame inside the
// horizon, its own.
fn nu_static_observer(energy: f32, angular_momentum: f32) -> f32 {
    let frequency = (energy - frame.static_angular_velocity * angular_momentum) / frame.static_lapse;
    return select(1.0, frequency, frame.static_lapse > 0.0);
}

// The frequency that the ZAMO at 1/r = u and cos theta = `cosine` measures (src/physics/orbit.rs). d = Delta / r^2;
// big_a = A / r^4; omega is the ZAMO's angular velocity.
fn zamo_frequency(u: f32, cosine: f32, energy: f32, angular_momentum: f32) -> f32 {
    let a2u2 = frame.spin * frame.spin * u * u;
    let d = (1.0 - frame.r_plus * u) * (1.0 - frame.r_minus * u);
    let big_a = (1.0 + a2u2) * (1.0 + a2u2) - d * a2u2 * (1.0 - cosine * cosine);
    let omega = 2.0 * frame.spin * u * u * u / big_a;
    return (energy - omega * angular_momentum) * sqrt(big_a / (d * (1.0 + a2u2 * cosine * cosine)));
}
