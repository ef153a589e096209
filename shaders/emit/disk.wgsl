// SPDX-License-Identifier: MIT OR Apache-2.0
// The disk's light at a crossing. Mirrors src/emit/thin_disk.rs. The table of the temperature profile comes from
// src/physics/disk_flux.rs and lies at PROFILE_OFFSET; an entry is the value and the step to the next one. Its other
// half is the table of src/physics/limb_darkening.rs.

#import constants
#import emit/shift
#import emit/turbulence
#import records/record
#import shared/blackbody
#import shared/frame
#import shared/not_inlined
#requires fn light_table(i: u32) -> vec4<f32>

// False: crossings have their places for something else.
override TURBULENT: bool = true;

// How much of a crossing at u the disk covers: all or nothing.
fn disk_covers(u: f32) -> f32 {
    return select(0.0, 1.0, u >= frame.disk_u.x && u <= frame.disk_u.y);
}

// The light that a crossing adds to a ray of which the share `open` comes this far, were the disk smooth; w: the share
// of the light behind that it hides. `mu`: |cosine| of the ray's angle to the normal, as the matter sees it.
fn disk_at_crossing(crossing: Crossing, shift: Shift, mu: f32, open: f32) -> vec4<f32> {
    let profile = disk_profile(crossing.u);
    let opacity = disk_opacity(crossing, profile);
    return vec4<f32>(open * opacity * emission_law(mu) * disk_light(profile, shift), opacity);
}

// The factor by which the disk's structure changes the light of a crossing.
fn disk_structure(crossing: Crossing) -> f32 {
    if FOOTPRINTS && TURBULENT {
        return turbulent_brightness(crossing.place, crossing.dx, crossing.dy);
    }
    return 1.0;
}

// The share of the light from behind that a crossing hides where the disk's temperature is `profile`.
fn disk_opacity(crossing: Crossing, profile: f32) -> f32 {
    return frame.disk_opacity * crossing.share * left_by_edges(crossing.u, profile);
}

// The light at the angle of cosine `mu`, over that of an isotropic surface of the same flux (thin_disk.rs).
fn emission_law(mu: f32) -> f32 {
    if not_inlined(frame.limb_darkened) == 0u {
        return 1.0;
    }
    let x = clamp(mu, 0.0, 1.0) * f32(PROFILE_SIZE - 1u);
    let i = min(u32(x), PROFILE_SIZE - 2u);
    let entry = light_table(PROFILE_OFFSET + i);
    return entry.z + entry.w * (x - f32(i));
}

// The share of the disk's opacity that its edges leave at 1/r = u (SoftEdges::left).
fn left_by_edges(u: f32, profile: f32) -> f32 {
    let outer = frame.soft_outer;
    let inner = frame.soft_inner;
    let fade = select(1.0, clamp((outer.x - 1.0 / u) * outer.y, 0.0, 1.0), outer.y > 0.0);
    let squared = profile * profile;
    let flux = select(1.0, min(squared * squared * inner.y, 1.0), inner.y > 0.0 && u > inner.x);
    return fade * fade * (3.0 - 2.0 * fade) * flux;
}

// The disk's temperature at 1/r = u, in that of the hottest ring (ThinDisk::profile).
fn disk_profile(u: f32) -> f32 {
    return max(temperature_profile(u), select(0.0, frame.least_profile, u > frame.least_profile_u));
}

// T(r) / T_max (TemperatureProfile::at).
fn temperature_profile(u: f32) -> f32 {
    let root = sqrt(min(abs(frame.signed_isco) * u, 1.0));
    let x = sqrt(1.0 - root) * f32(PROFILE_SIZE - 1u);
    let i = min(u32(x), PROFILE_SIZE - 2u);
    let entry = light_table(PROFILE_OFFSET + i);
    // The first entry, of the ISCO, is 0.
    return (entry.x + entry.y * (x - f32(i))) * root * sqrt(root);
}

// Linear radiance of the opaque, smooth disk where its temperature is `profile`, in that of the hottest ring.
fn disk_light(profile: f32, shift: Shift) -> vec3<f32> {
    let temperature = frame.disk_hottest * profile;
    let light = shifted_blackbody(temperature, frame.disk_log_reference, shift.colour, shift.beaming);
    return light * frame.disk_brightness;
}
