// The disk's light at one crossing. Mirrors src/cpu/shade.rs. The table of the temperature profile comes from
// src/physics/disk_flux.rs and lies at PROFILE_OFFSET; an entry is the value and the step to the next one.

#import constants
#import shared/blackbody
#import shared/frame
#requires fn light_table(i: u32) -> vec4<f32>

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

// nu(static observer or ZAMO at the eye), for E and L scaled to nu_local = 1; in the rain frame inside the horizon,
// its own.
fn nu_static_eye(energy: f32) -> f32 {
    let static_lapse = 1.0 - 2.0 * frame.place.x;
    if frame.rain == 0u || static_lapse <= 0.0 {
        return 1.0;
    }
    return energy / sqrt(static_lapse);
}

// nu(ZAMO at a place of the plane).
fn nu_zamo_in_plane(u: f32, energy: f32, angular_momentum: f32) -> f32 {
    let a2u2 = frame.hole.x * frame.hole.x * u * u;
    let d = (1.0 - frame.hole.y * u) * (1.0 - frame.hole.z * u);
    let big_a = (1.0 + a2u2) * (1.0 + a2u2) - d * a2u2;
    let omega = 2.0 * frame.hole.x * u * u * u / big_a;
    return (energy - omega * angular_momentum) * sqrt(big_a / d);
}

// T(r) / T_max (TemperatureProfile::at).
fn temperature_profile(u: f32) -> f32 {
    let root = sqrt(min(abs(frame.hole.w) * u, 1.0));
    let x = sqrt(1.0 - root) * f32(PROFILE_SIZE - 1u);
    let i = min(u32(x), PROFILE_SIZE - 2u);
    let entry = light_table(PROFILE_OFFSET + i);
    // The first entry, of the ISCO, is 0.
    return (entry.x + entry.y * (x - f32(i))) * root * sqrt(root);
}

// Linear radiance of the opaque disk at 1/r = u, seen with g.
fn disk_light(u: f32, shift: Shift) -> vec3<f32> {
    let temperature = frame.disk.x * temperature_profile(u);
    return shifted_blackbody(temperature, frame.disk.y, shift.colour, shift.beaming) * frame.disk.w;
}
