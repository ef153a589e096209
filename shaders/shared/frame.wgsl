// SPDX-License-Identifier: MIT OR Apache-2.0
// The scene as the kernels of a frame see it. Mirrors `FrameUniform` of src/gpu/frame/uniforms/frame.rs.

#import constants
#import shared/band
#import shared/matter
#import shared/not_inlined
#requires var frame: Frame

// The scene in the hole's units; the same for all tiles and samples of a frame.
struct Frame {
    // Units of a FramePoint (camera/projection.wgsl), to the right, up, forward, as components in the observer's frame.
    right: vec3<f32>,
    // The angle of a fisheye's pixel, radians.
    pixel_angle: f32,
    up: vec4<f32>,
    forward: vec4<f32>,
    // Velocity against the local frame, and its Lorentz factor.
    beta: vec3<f32>,
    gamma: f32,
    // Unit vectors of the local frame, chart.
    e_r: vec4<f32>,
    e_theta: vec4<f32>,
    e_phi: vec4<f32>,
    // 1/r, sin theta and cos theta of the observer, and the lapse there (rain: sqrt(2 u)).
    observer_u: f32,
    observer_sine: f32,
    observer_cosine: f32,
    lapse: f32,
    // omega, q, sqrt(Sg), sqrt(Sg D) of docs/numerics.md's start values.
    omega: f32,
    q: f32,
    root_sigma: f32,
    root_sigma_d: f32,
    // The hole's spin a, and its outer and inner horizon.
    spin: f32,
    r_plus: f32,
    r_minus: f32,
    // The ISCO of the disk's matter: negative for matter towards -ph.
    signed_isco: f32,
    // Columns that take chart directions to sky axes, each with a number beside it: brightness of the stars, brightness
    // of the maps, and least_patch of stars.rs.
    sky_x: vec3<f32>,
    stars_brightness: f32,
    sky_y: vec3<f32>,
    map_brightness: f32,
    sky_z: vec3<f32>,
    least_patch: f32,
    // Temperature of the disk's hottest ring, K; ln Y of the stated temperature; opacity; brightness.
    disk_hottest: f32,
    disk_log_reference: f32,
    disk_opacity: f32,
    disk_brightness: f32,
    // The size of the full frame, pixels.
    size: vec2<f32>,
    // The integration's step in sigma, and its tolerance.
    step: f32,
    tolerance: f32,
    // Strength, delay of light of the reference time (M), and ln r inside which it fades out (-1e30: nowhere), of
    // Turbulence in src/emit/turbulence.rs.
    turbulence_strength: f32,
    turbulence_delay: f32,
    turbulence_fades_inside: f32,
    // How strongly the Doppler shift, gravity's shift and beaming show, 0 to 1 (src/emit/effects.rs).
    doppler_strength: f32,
    // Sine and cosine of the critical angle, and the rays whose capture margin tells the level, of CurveLevel in
    // src/physics/lens/critical.rs.
    critical: vec2<f32>,
    critical_by_margin: u32,
    gravity_strength: f32,
    // 1/r of the disk's outer and inner edge, (1, 0) without one.
    disk_u: vec2<f32>,
    // 1/r between which crossings hide all that is behind them, (1, 0) without such.
    opaque_u: vec2<f32>,
    capture_u: f32,
    max_steps: u32,
    max_crossings: u32,
    // The local frame: 0 static, 1 rain, RAIN_CLOCK rain and of that clock.
    rain: u32,
    beaming_strength: f32,
    // BHR_VIEW_*.
    view: u32,
    // Seed of the turbulence, and the number of its first band.
    pattern_seed: u32,
    first_band: i32,
    // Columns and rows of the finest levels of the Milky Way and of the host's map.
    milky_way_size: vec2<u32>,
    map_size: vec2<u32>,
    // BHR_PROJECTION_*, for kernels that serve all.
    projection: u32,
    // The layer of traced records that holds the medium before the first crossing (traced/layout.wgsl).
    medium_layer: u32,
    // 1/r between which crossings of the plane are kept: all emitters of the plane lie there. (1, 0) without any.
    plane_u: vec2<f32>,
    // `outer` and `inner` of SoftEdges in src/emit/thin_disk.rs.
    soft_outer: vec2<f32>,
    soft_inner: vec2<f32>,
    // 1 if the disk's light is limb-darkened, 0 if it is isotropic.
    limb_darkened: u32,
    // ThinDisk::least_profile of src/emit/thin_disk.rs: 1/r beyond which it counts, and the profile; 0 without.
    least_profile_u: f32,
    least_profile: f32,
    // In Doran's chart: Kerr's azimuth less Doran's at the observer.
    kerr_turn: f32,
    // `least` of DiskEdges in src/scene/refine.rs: outer, inner.
    shown_edges: vec2<f32>,
    // Light that need not be told exactly at half resolution, and the tolerance there (`Evenness` of src/emit/half.rs).
    least_light: f32,
    half_tolerance: f32,
    // Plunge of src/physics/plunge.rs: ISCO, E, a x, x; 0 where no matter plunges.
    plunge_isco: f32,
    plunge_energy: f32,
    plunge_spin_term: f32,
    plunge_x: f32,
    // The first pixel of the occluder in the full frame.
    occluder_origin: vec2<f32>,
    // M in scene lengths, which distances of the occluder are in.
    hole_mass: f32,
    // 1 where the occluder's things are lensed, else 0.
    occluder_lensed: f32,
    // Columns that take directions along the observer's axes to the chart as hosts have them (Lens::placed), each with
    // a number beside it: the delays of the camera's chart less those of records (1e38: it has none), and lapse and
    // angular velocity of the static observer (StaticObserver) at a rain frame; a lapse of 0 where there is none.
    placed_r: vec3<f32>,
    delay_offset: f32,
    placed_theta: vec3<f32>,
    static_lapse: f32,
    placed_phi: vec3<f32>,
    static_angular_velocity: f32,
    // The observer's place as hosts have it, M, and Lens::place_speed.
    eye: vec4<f32>,
    // RainTriad of src/physics/observer.rs: sin_turn, cos_turn, rho, circumference.
    rain_triad: vec4<f32>,
    // OffsetSeries of src/physics/rain.rs: poles, outer before inner, and two terms each; azimuth before time.
    offset_poles: vec4<f32>,
    offset_terms: array<vec4<f32>, OFFSET_PAIRS>,
    // The bands of the disk's turbulence, which do not drift.
    bands: array<Band, MOST_BANDS>,
    // 1/r, outer end first, outside which no matter with depth is.
    depth_u: vec2<f32>,
    // The number of volumes and spots.
    matter_count: u32,
    // Delay of light of the reference time (M), of When in src/emit/turbulence.rs.
    matter_delay: f32,
    matter: array<Matter, MOST_MATTER>,
}

const RAIN_CLOCK: u32 = 2u;

