// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene in the layout of the shaders' uniforms: `Frame` and `Pass` of shared/frame.wgsl and shared/pass.wgsl, field
//! by field. The only place where f64 becomes f32 on its way to the GPU.

use super::band::BandUniform;
use super::matter::{MatterUniform, uniforms_of};
use crate::emit::Emitters;
use crate::emit::bands::MOST_BANDS;
use crate::emit::half::Evenness;
use crate::emit::moment::Shutter;
use crate::emit::thin_disk::SoftEdges;
use crate::error::Result;
use crate::gpu::kernel::sizes::{MOST_MATTER, OFFSET_PAIRS};
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::geodesic::Clock;
use crate::physics::lens::critical::CurveLevel;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_inner, horizon_outer, zamo_omega};
use crate::physics::rain::doran_turn;
use crate::physics::trace::Settings;
use crate::scene::frame::sample_of;
use crate::scene::observer::Lens;
use crate::scene::refine::{CURVE_SAMPLES, DiskEdges};
use crate::scene::{EmissionLaw, Projection, Scene};
use crate::sky::least_patch;
use crate::tracer::{FrameRequest, Tile};
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3, Vec4};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FrameUniform {
    right: Vec3,
    pixel_angle: f32,
    up: Vec4,
    forward: Vec4,
    beta: Vec3,
    gamma: f32,
    e_r: Vec4,
    e_theta: Vec4,
    e_phi: Vec4,
    observer_u: f32,
    observer_sine: f32,
    observer_cosine: f32,
    lapse: f32,
    omega: f32,
    q: f32,
    root_sigma: f32,
    root_sigma_d: f32,
    spin: f32,
    r_plus: f32,
    r_minus: f32,
    signed_isco: f32,
    sky_x: Vec3,
    stars_brightness: f32,
    sky_y: Vec3,
    map_brightness: f32,
    sky_z: Vec3,
    least_patch: f32,
    disk_hottest: f32,
    disk_log_reference: f32,
    disk_opacity: f32,
    disk_brightness: f32,
    size: [f32; 2],
    step: f32,
    tolerance: f32,
    turbulence_strength: f32,
    turbulence_delay: f32,
    turbulence_fades_inside: f32,
    doppler_strength: f32,
    critical: [f32; 2],
    critical_by_margin: u32,
    gravity_strength: f32,
    disk_u: [f32; 2],
    opaque_u: [f32; 2],
    capture_u: f32,
    max_steps: u32,
    max_crossings: u32,
    rain: u32,
    beaming_strength: f32,
    view: u32,
    pattern_seed: u32,
    first_band: i32,
    /// Known once the textures are there, as is `map_size` (`Tables::map_sizes`).
    pub milky_way_size: [u32; 2],
    pub map_size: [u32; 2],
    projection: u32,
    medium_layer: u32,
    plane_u: [f32; 2],
    soft_outer: [f32; 2],
    soft_inner: [f32; 2],
    limb_darkened: u32,
    least_profile_u: f32,
    least_profile: f32,
    kerr_turn: f32,
    shown_edges: [f32; 2],
    least_light: f32,
    half_tolerance: f32,
    plunge_isco: f32,
    plunge_energy: f32,
    plunge_spin_term: f32,
    plunge_x: f32,
    occluder_origin: [f32; 2],
    hole_mass: f32,
    occluder_lensed: f32,
    placed_r: Vec3,
    delay_offset: f32,
    placed_theta: Vec3,
    static_lapse: f32,
    placed_phi: Vec3,
    static_angular_velocity: f32,
    eye: Vec4,
    rain_triad: Vec4,
    offset_poles: Vec4,
    offset_terms: [Vec4; OFFSET_PAIRS],
    bands: [BandUniform; MOST_BANDS],
    depth_u: [f32; 2],
    matter_count: u32,
    matter_delay: f32,
    matter: [MatterUniform; MOST_MATTER],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PassUniform {
    pub origin: [i32; 2],
    pub size: [u32; 2],
    pub offset: [f32; 2],
    pub weight: f32,
    pub first: u32,
    pub slot: u32,
    pub curve_samples: u32,
    pub light_origin: [i32; 2],
    pub image_origin: [u32; 2],
    pub pixels_first: u32,
    pub pixels_row: u32,
    pub moment: f32,
    pub unused: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::gpu::kernel::layout::layout;
    let frame = layout!(FrameUniform as "Frame": right, pixel_angle, up, forward, beta, gamma, e_r, e_theta, e_phi,
        observer_u, observer_sine, observer_cosine, lapse, omega, q, root_sigma, root_sigma_d, spin, r_plus, r_minus,
        signed_isco, sky_x, stars_brightness, sky_y, map_brightness, sky_z, least_patch, disk_hottest,
        disk_log_reference, disk_opacity, disk_brightness, size, step, tolerance, turbulence_strength,
        turbulence_delay, turbulence_fades_inside, doppler_strength, critical, critical_by_margin, gravity_strength,
        disk_u, opaque_u, capture_u, max_steps, max_crossings, rain, beaming_strength, view, pattern_seed,
        first_band, milky_way_size, map_size, projection,
        medium_layer, plane_u, soft_outer, soft_inner, limb_darkened, least_profile_u, least_profile, kerr_turn,
        shown_edges, least_light, half_tolerance, plunge_isco, plunge_energy, plunge_spin_term, plunge_x,
        occluder_origin, hole_mass, occluder_lensed, placed_r, delay_offset, placed_theta, static_lapse, placed_phi,
        static_angular_velocity, eye, rain_triad, offset_poles, offset_terms, bands, depth_u, matter_count,
        matter_delay, matter);
    let pass = layout!(PassUniform as "Pass": origin, size, offset, weight, first, slot, curve_samples, light_origin,
        image_origin, pixels_first, pixels_row, moment, unused);
    [frame, pass]
}

/// omega, q, sqrt(Sg), sqrt(Sg D) of the start values (docs/numerics.md); 0 in the rain frame, which has its own.
fn zamo(frame: &LocalFrame) -> [f64; 4] {
    if frame.rain {
        return [0.0; 4];
    }
    let (a, u) = (frame.a, 1.0 / frame.r);
    let au2 = (a * u).powi(2);
    let sigma = 1.0 + au2 * frame.cos * frame.cos;
    let d = (1.0 - horizon_outer(a) * u) * (1.0 - horizon_inner(a) * u);
    let big_a = (1.0 + au2).powi(2) - d * au2 * frame.sin * frame.sin;
    [zamo_omega(a, frame.r, frame.sin), (big_a / sigma).sqrt() / u, sigma.sqrt(), (sigma * d).sqrt()]
}

/// `RainTriad`; 0 in other frames.
fn rain_triad(frame: &LocalFrame) -> Vec4 {
    if !frame.rain {
        return Vec4::ZERO;
    }
    let triad = frame.rain_triad();
    Vec4::from_array(f32s([triad.sin_turn, triad.cos_turn, triad.rho, triad.circumference]))
}

/// The poles and the first terms of `OffsetSeries`, for rays in Doran's chart or for matter that is told in it; 0
/// without either.
fn offsets(frame: &LocalFrame, emitters: &Emitters) -> (Vec4, [Vec4; OFFSET_PAIRS]) {
    let Some(series) = frame.offsets.as_ref().or(emitters.volumes.offsets.as_ref()) else {
        return (Vec4::ZERO, [Vec4::ZERO; OFFSET_PAIRS]);
    };
    let pair = |first: DVec2, second: DVec2| Vec4::from_array(f32s([first.x, first.y, second.x, second.y]));
    let terms = std::array::from_fn(|i| pair(series.terms[2 * i], series.terms[2 * i + 1]));
    (pair(series.poles[0], series.poles[1]), terms)
}

fn f32s<const N: usize>(numbers: [f64; N]) -> [f32; N] {
    numbers.map(|v| v as f32)
}

/// A vector in 16 bytes, of which the last 4 are not used.
fn padded(v: DVec3) -> Vec4 {
    v.as_vec3().extend(0.0)
}

/// An interval of 1/r; (1, 0), which nothing lies in, for none.
fn range(u: Option<[f64; 2]>) -> [f32; 2] {
    u.map_or([1.0, 0.0], |u| u.map(|u| u as f32))
}

/// Light that need not be told exactly at half resolution, and the tolerance there; 0 without.
fn evenness(scene: &Scene) -> [f64; 2] {
    match scene.half_resolution() {
        Some(Evenness::Light { least, tolerance }) => [least, tolerance],
        Some(Evenness::Depth { tolerance }) => [0.0, tolerance],
        None => [0.0; 2],
    }
}

impl FrameUniform {
    /// Whether rays are the same with both.
    pub fn is_same(&self, other: &Self) -> bool {
        let seen = Self { milky_way_size: other.milky_way_size, map_size: other.map_size, ..*self };
        bytemuck::bytes_of(&seen) == bytemuck::bytes_of(other)
    }

    /// `settings`: those of f32 pixels; `crossings`: most that a traced record holds. Errors: as `Scene::lens`.
    pub fn new(scene: &Scene, emitters: &Emitters, lens: &Lens, settings: &Settings, crossings: u32) -> Result<Self> {
        let frame = &lens.observer.frame;
        let a = scene.hole.spin;
        let disk = scene.disk.unwrap_or_default();
        let sky = scene.chart_to_sky();
        let isco = scene.disk_isco();
        let turbulence = emitters.disk.and_then(|disk| disk.turbulence);
        let [least_profile_u, least_profile] = emitters.disk.and_then(|disk| disk.least_profile).unwrap_or_default();
        let [least_light, tolerance] = evenness(scene);
        let effects = scene.shown_effects();
        let edges = DiskEdges::new(emitters.disk_u().unwrap_or_default(), emitters.fading_u(), &scene.matter());
        let (matter, matter_count) = uniforms_of(&emitters.volumes);
        let u = 1.0 / frame.r;
        let CurveLevel { critical: [sin, cos], by_margin, .. } = CurveLevel::new(frame);
        let [omega, q, root_sigma, root_sigma_d] = f32s(zamo(frame));
        let SoftEdges { outer, inner } = emitters.disk.map(|thin| thin.edges).unwrap_or_default();
        let plunge = scene.matter().plunge.map_or([0.0; 4], |p| [p.isco, p.energy, p.spin_term, p.x]);
        let [plunge_isco, plunge_energy, plunge_spin_term, plunge_x] = f32s(plunge);
        let occluder = scene.occluder.as_ref();
        let static_observer = frame.static_observer();
        let (rain_triad, (offset_poles, offset_terms)) = (rain_triad(frame), offsets(frame, emitters));
        Ok(Self {
            right: lens.axes.x_axis.as_vec3(),
            pixel_angle: lens.mapping.pixel_angle as f32,
            up: padded(lens.axes.y_axis),
            forward: padded(lens.axes.z_axis),
            beta: lens.observer.beta.as_vec3(),
            gamma: lens.observer.gamma as f32,
            e_r: padded(frame.e_r),
            e_theta: padded(frame.e_theta),
            e_phi: padded(frame.e_phi),
            observer_u: u as f32,
            observer_sine: frame.sin as f32,
            observer_cosine: frame.cos as f32,
            lapse: if frame.rain { (2.0 * u).sqrt() } else { frame.lapse } as f32,
            omega,
            q,
            root_sigma,
            root_sigma_d,
            spin: a as f32,
            r_plus: horizon_outer(a) as f32,
            r_minus: horizon_inner(a) as f32,
            signed_isco: if disk.retrograde { -isco } else { isco } as f32,
            sky_x: sky.x_axis.as_vec3(),
            stars_brightness: scene.sky.stars_brightness as f32,
            sky_y: sky.y_axis.as_vec3(),
            map_brightness: scene.sky.map_brightness as f32,
            sky_z: sky.z_axis.as_vec3(),
            least_patch: least_patch(lens.mapping.pixel_angle) as f32,
            disk_hottest: emitters.disk.map_or(disk.temperature, |thin| thin.hottest) as f32,
            disk_log_reference: BlackbodyTable::shared().ln_luminance(disk.temperature) as f32,
            disk_opacity: disk.opacity as f32,
            disk_brightness: disk.brightness as f32,
            size: f32s([lens.mapping.width, lens.mapping.height]),
            step: settings.step as f32,
            tolerance: settings.tolerance as f32,
            turbulence_strength: turbulence.map_or(0.0, |t| t.strength as f32),
            turbulence_delay: turbulence.map_or(0.0, |t| t.reference_delay as f32),
            turbulence_fades_inside: turbulence.map_or(0.0, |t| t.fades_inside.unwrap_or(-1e30) as f32),
            doppler_strength: effects.doppler_shift as f32,
            critical: f32s([sin, cos]),
            critical_by_margin: by_margin as u32,
            gravity_strength: effects.gravity_shift as f32,
            disk_u: range(emitters.disk_u()),
            opaque_u: range(settings.opaque_u),
            capture_u: settings.capture_u as f32,
            max_steps: settings.max_steps,
            max_crossings: settings.max_crossings as u32,
            rain: u32::from(frame.rain) + u32::from(frame.clock() == Clock::Rain),
            beaming_strength: effects.beaming as f32,
            view: scene.view as u32,
            pattern_seed: turbulence.map_or(0, |t| t.bands.seed),
            first_band: turbulence.map_or(0, |t| t.bands.first),
            milky_way_size: [1; 2],
            map_size: [1; 2],
            projection: lens.mapping.projection as u32,
            medium_layer: crossings,
            plane_u: range(emitters.plane_u()),
            soft_outer: f32s(outer),
            soft_inner: f32s(inner),
            limb_darkened: u32::from(disk.emission_law == EmissionLaw::LimbDarkened),
            least_profile_u: least_profile_u as f32,
            least_profile: least_profile as f32,
            kerr_turn: if frame.rain { -doran_turn(a, u) as f32 } else { 0.0 },
            shown_edges: f32s(edges.least),
            least_light: least_light as f32,
            half_tolerance: tolerance as f32,
            plunge_isco,
            plunge_energy,
            plunge_spin_term,
            plunge_x,
            occluder_origin: occluder.map_or([0.0; 2], |occluder| occluder.origin.map(|v| v as f32)),
            hole_mass: occluder.map_or(1.0, |_| scene.hole.mass as f32),
            occluder_lensed: f32::from(occluder.is_some_and(|occluder| occluder.lensed)),
            placed_r: lens.placed(DVec3::X).as_vec3(),
            delay_offset: if lens.delay_offset.is_nan() { 1e38 } else { lens.delay_offset as f32 },
            placed_theta: lens.placed(DVec3::Y).as_vec3(),
            static_lapse: static_observer.map_or(0.0, |observer| observer.lapse) as f32,
            placed_phi: lens.placed(DVec3::Z).as_vec3(),
            static_angular_velocity: static_observer.map_or(0.0, |observer| observer.angular_velocity) as f32,
            eye: (lens.place.e_r * lens.place.r).as_vec3().extend(lens.place_speed as f32),
            rain_triad,
            offset_poles,
            offset_terms,
            bands: turbulence.map_or([BandUniform::zeroed(); MOST_BANDS], |t| BandUniform::all(&t.bands)),
            depth_u: range(emitters.depth_u()),
            matter_count,
            matter_delay: emitters.volumes.when.reference_delay as f32,
            matter,
        })
    }
}

/// The uniform of a sample (its number, and how many there are), the `slot`th of its submission.
pub fn pass_of(
    request: &FrameRequest,
    tile: Tile,
    (sample, samples): (u32, u32),
    (projection, shutter): (Projection, Shutter),
    slot: u32,
    light_origin: [u32; 2],
) -> PassUniform {
    let region = request.region;
    let ([dx, dy], moment) = sample_of(sample, samples, projection, shutter);
    PassUniform {
        origin: [(region.x + tile.x) as i32 - 1, (region.y + tile.y) as i32 - 1],
        size: [tile.width + 2, tile.height + 2],
        offset: [dx as f32, dy as f32],
        weight: 1.0 / samples as f32,
        first: u32::from(sample == 0),
        slot,
        curve_samples: CURVE_SAMPLES,
        light_origin: light_origin.map(|v| v as i32),
        image_origin: [tile.x, tile.y],
        pixels_first: 0,
        pixels_row: 0,
        moment: moment as f32,
        unused: 0,
    }
}
