// How effects let the frequency shifts of light show. Mirrors src/cpu/shade.rs. Knows no light.

#import constants
#import shared/frame

// False: an effect that colours light or changes its brightness is switched off.
override ALL_EFFECTS: bool = true;

// How the effects let frequency shifts show: the shift that colours, and the one that beams.
struct Shift {
    colour: f32,
    beaming: f32,
}

// g = g_gravity g_doppler, split at the local static observers (ZAMOs); `gravity` is the former.
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
fn nu_static_observer(energy: f32) -> f32 {
    let static_lapse = 1.0 - 2.0 * frame.place.x;
    if frame.rain == 0u || static_lapse <= 0.0 {
        return 1.0;
    }
    return energy / sqrt(static_lapse);
}

// nu measured by the ZAMO at (u, cos theta) (physics/orbit.rs).
fn zamo_frequency(u: f32, cosine: f32, energy: f32, angular_momentum: f32) -> f32 {
    let a2u2 = frame.hole.x * frame.hole.x * u * u;
    let d = (1.0 - frame.hole.y * u) * (1.0 - frame.hole.z * u);
    let big_a = (1.0 + a2u2) * (1.0 + a2u2) - d * a2u2 * (1.0 - cosine * cosine);
    let omega = 2.0 * frame.hole.x * u * u * u / big_a;
    return (energy - omega * angular_momentum) * sqrt(big_a / (d * (1.0 + a2u2 * cosine * cosine)));
}
