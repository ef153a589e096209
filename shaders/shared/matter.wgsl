// SPDX-License-Identifier: MIT OR Apache-2.0
// A volume or a hot spot as the kernels of a frame see it. Mirrors `MatterUniform` of
// src/gpu/frame/uniforms/matter.rs; what its numbers mean stands in src/emit/volume.rs and src/emit/hot_spot.rs.

struct Matter {
    // SHAPE_* and MOTION_*.
    shape: u32,
    motion: u32,
    // 1 for a power law's light, 0 for a blackbody's.
    power_law: u32,
    // The standard deviation of a spot's density, M.
    size: f32,
    // 1/r between which the matter is, outer end first, and the greatest |cos theta|.
    u_outer: f32,
    u_inner: f32,
    most_cosine: f32,
    // The sense of motion: +1 or -1.
    sense: f32,
    // Radii between which a volume is, M; the radius that its shape is about, or that of a spot's orbit; the width of a
    // torus. Of a spot in free fall `inner` is 1 if its places are the denser the nearer to the last, else 0;
    // radius and width are the two of SpotMatter::lingers in src/emit/matter.rs.
    inner: f32,
    outer: f32,
    radius: f32,
    width: f32,
    // Thickness, opening angle of a jet, slope of the density: as in BhrVolume.
    thickness: f32,
    opening: f32,
    slope: f32,
    // The ISCO of the matter's sense of motion.
    isco: f32,
    // Numbers of the law of motion. KEPLERIAN: sub_keplerian, infall; ANGULAR_MOMENTUM: l0, 0; RIGID: angular velocity,
    // 0; OUTFLOW: speed, base; FREE: rain time of the first place less that of the frame, and time to the last one, M.
    law: vec2<f32>,
    // A spot's azimuth at the frame's time, and its angular velocity towards +phi, rad/M; of one in free fall the
    // second is FreeCentre::pace of src/emit/free_spot.rs.
    azimuth: f32,
    angular_velocity: f32,
    // Absorption per M at density 1; temperature, K, at the reference radius, and the power of r that it falls by.
    absorption: f32,
    temperature: f32,
    reference_radius: f32,
    temperature_slope: f32,
    // ln of the reference luminance, spectral index, brightness.
    log_reference: f32,
    spectral_index: f32,
    brightness: f32,
    // The least density that is not left out.
    least_density: f32,
    // Linear Rec. 709.
    tint: vec3<f32>,
    // The first entry of light_tables that has places of a spot in free fall.
    places: u32,
}
