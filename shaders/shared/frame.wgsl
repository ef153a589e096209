// The scene as the kernels of a frame see it. Mirrors `FrameUniform` of src/gpu/frame/uniforms.rs.

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
    // Unit vectors of the local frame, chart; w: components of the shadow's centre in it (critical.rs).
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
    // Temperature, its ln Y, opacity, brightness.
    disk: vec4<f32>,
    // The size of the full frame, pixels; then the step in sigma and the tolerance.
    size: vec4<f32>,
    // Strength, age at the reference time, delay of light of that time (M), 0 of Turbulence in src/emit/turbulence.rs.
    turbulence: vec4<f32>,
    // Radius, brightness, absorption of Haze in src/emit/haze.rs, 0.
    haze: vec4<f32>,
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
    // Seed of the turbulence, and its generation at the reference time.
    pattern: vec2<u32>,
    // Columns and rows of the finest levels of the Milky Way and of the host's map.
    map_sizes: vec4<u32>,
    // BHR_PROJECTION_*, for kernels that serve all.
    projection: u32,
    // The layer of traced records that holds the medium before the first crossing (traced/layout.wgsl).
    medium_layer: u32,
    // 1/r between which crossings of the plane are kept: all emitters of the plane lie there. (1, 0) without any.
    plane_u: vec2<f32>,
}

const RAIN_CLOCK: u32 = 2u;

