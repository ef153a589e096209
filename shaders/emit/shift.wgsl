// SPDX-License-Identifier: MIT OR Apache-2.0
// The parts of light's frequency shift that a scene's effects (BHR_EFFECT_*) show. Mirrors src/cpu/shade.rs and
// src/physics/orbit.rs. Knows no emitter and no colour.

#import constants
#import shared/frame

// True: every effect on the colour or brightness of light is on, and g is used as it is. False: at least one is off.
override ALL_EFFECTS: bool = true;

// Ratios of seen to emitted frequency: the one that shading uses for colour, and the one for brightness (beaming).
struct Shift {
    colour: f32,
    beaming: f32,
}

// Leaves out of g what the effects switch off. g = gravity * Doppler shift; `gravity` is between the ZAMOs (without
// spin: static observers) at the emitter and at the camera. Beaming takes all of g or nothing.
fn visible_shift(g: f32, gravity: f32) -> Shift {
    var colour = g;
    if (frame.effects & EFFECT_DOPPLER_SHIFT) == 0u {
        colour = gravity;
    }
    if (frame.effects & EFFECT_GRAVITY_SHIFT) == 0u {
        colour /= gravity;
    }
    return Shift(colour, select(1.0, g, (frame.effects & EFFECT_BEAMING) != 0u));
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
