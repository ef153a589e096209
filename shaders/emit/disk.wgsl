// The disk's light at a crossing. Mirrors src/emit/thin_disk.rs. The table of the temperature profile comes from
// src/physics/disk_flux.rs and lies at PROFILE_OFFSET; an entry is the value and the step to the next one.

#import constants
#import emit/shift
#import emit/turbulence
#import records/record
#import shared/blackbody
#import shared/frame
#requires fn light_table(i: u32) -> vec4<f32>

// How much of a crossing at u the disk covers: all or nothing.
fn disk_covers(u: f32) -> f32 {
    return select(0.0, 1.0, u >= frame.disk_u.x && u <= frame.disk_u.y);
}

// The light that a crossing on the disk adds to a ray of which the share `open` comes this far; w: the share of the
// light behind that it hides.
fn disk_at_crossing(crossing: Crossing, shift: Shift, open: f32) -> vec4<f32> {
    var structure = 1.0;
    if FOOTPRINTS {
        structure = turbulent_brightness(crossing.place, crossing.dx, crossing.dy);
    }
    let opacity = frame.disk.z * crossing.share;
    return vec4<f32>(open * opacity * structure * disk_light(crossing.u, shift), opacity);
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

// Linear radiance of the opaque, smooth disk at 1/r = u.
fn disk_light(u: f32, shift: Shift) -> vec3<f32> {
    let temperature = frame.disk.x * temperature_profile(u);
    return shifted_blackbody(temperature, frame.disk.y, shift.colour, shift.beaming) * frame.disk.w;
}
