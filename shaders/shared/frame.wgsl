// SPDX-License-Identifier: MIT OR Apache-2.0
// The scene as the kernels of a frame see it. Mirrors `FrameUniform` of src/gpu/frame/uniforms/frame.rs.

#import constants
#import shared/matter
#import shared/not_inlined
#requires var frame: Frame

// The scene in the hole's units; the same for all tiles and samples of a frame.
struct Frame {
    // Units of a FramePoint (camera/projection.wgsl), to the right, up, forward, as components in the observer's frame.
    // w of the first: the angle of a fisheye's pixel.
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    // Velocity against the local frame, and gamma.
    beta: vec4<f32>,
    // Unit vectors of the local frame, chart.
    e_r: vec4<f32>,
    e_theta: vec4<f32>,
    e_phi: vec4<f32>,
    // u, sin theta, cos theta of the observer, and the lapse (rain: sqrt(2 u)).
    place: vec4<f32>,
    // omega, q, sqrt(Sg), sqrt(Sg D) of docs/numerics.md's start values.
    zamo: vec4<f32>,
    // a, r+, r-, ISCO of the disk's matter: negative for matter towards -ph.
    hole: vec4<f32>,
    // Columns that take chart directions to sky axes; w of the first: brightness of the stars, of the second: of the
    // maps, of the third: least_patch of stars.rs.
    sky_x: vec4<f32>,
    sky_y: vec4<f32>,
    sky_z: vec4<f32>,
    // Temperature of the hottest ring, ln Y of the stated temperature, opacity, brightness.
    disk: vec4<f32>,
    // The size of the full frame, pixels; then the step in sigma and the tolerance.
    size: vec4<f32>,
    // Strength, delay of light of the reference time (M), then ln r inside which it fades out (-1e30:
    // nowhere), of Turbulence in src/emit/turbulence.rs; 0.
    turbulence: vec4<f32>,
    // Sine and cosine of the critical angle, whether the capture margin tells the level, of CurveLevel in
    // src/physics/lens/critical.rs; 0.
    critical: vec4<f32>,
    // 1/r of the disk's outer and inner edge, (1, 0) without one; the same if nothing behind it matters, else (1, 0).
    disk_u: vec2<f32>,
    opaque_u: vec2<f32>,
    capture_u: f32,
    max_steps: u32,
    max_crossings: u32,
    // The local frame: 0 static, 1 rain, RAIN_CLOCK rain and of that clock.
    rain: u32,
    // BHR_EFFECT_* bits that colour light, BHR_VIEW_*.
    effects: u32,
    view: u32,
    // Seed of the turbulence, and the number of its first band (i32).
    pattern: vec2<u32>,
    // Columns and rows of the finest levels of the Milky Way and of the host's map.
    map_sizes: vec4<u32>,
    // BHR_PROJECTION_*, for kernels that serve all.
    projection: u32,
    // The layer of traced records that holds the medium before the first crossing (traced/layout.wgsl).
    medium_layer: u32,
    // 1/r between which crossings of the plane are kept: all emitters of the plane lie there. (1, 0) without any.
    plane_u: vec2<f32>,
    // SoftEdges of src/emit/thin_disk.rs: outer, inner.
    soft_edges: vec4<f32>,
    // 1 if the disk's light is limb-darkened, 0 if it is isotropic; then ThinDisk::least_profile of
    // src/emit/thin_disk.rs, (0, 0) without; 0.
    surface: vec4<f32>,
    // `least` of DiskEdges in src/scene/refine.rs: outer, inner; light that need not be told exactly at half
    // resolution, and the tolerance there (`Evenness` of src/emit/half.rs).
    shown_edges: vec4<f32>,
    // Plunge of src/physics/plunge.rs: ISCO, E, a x, x; 0 where no matter plunges.
    plunge: vec4<f32>,
    // The first pixel of the occluder in the full frame, M in scene lengths; 1 where its things are lensed, else 0.
    occluder: vec4<f32>,
    // Bands of the turbulence: age, time from birth to birth (f32), number of the youngest generation; 0.
    bands: array<vec4<u32>, MOST_BANDS>,
    // 1/r, outer end first, outside which no matter with depth is; how many volumes and spots there are; delay of light
    // of the reference time (M), of When in src/emit/turbulence.rs.
    depth_u: vec2<f32>,
    matter_count: u32,
    matter_delay: f32,
    matter: array<Matter, MOST_MATTER>,
}

const RAIN_CLOCK: u32 = 2u;

