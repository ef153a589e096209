// SPDX-License-Identifier: MIT OR Apache-2.0
//! A scene in the layout of the shaders' uniforms: `Frame` and `Pass` of shared/frame.wgsl and shared/pass.wgsl, field
//! by field. The only place where f64 becomes f32 on its way to the GPU.

use super::matter::{MatterUniform, uniforms_of};
use crate::emit::Emitters;
use crate::emit::bands::{Bands, MOST_BANDS};
use crate::emit::half::Evenness;
use crate::emit::thin_disk::SoftEdges;
use crate::error::Result;
use crate::gpu::kernel::sizes::MOST_MATTER;
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::geodesic::Clock;
use crate::physics::lens::critical::CurveLevel;
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::{horizon_inner, horizon_outer, zamo_omega};
use crate::physics::trace::Settings;
use crate::scene::frame::sample_offset;
use crate::scene::observer::Lens;
use crate::scene::refine::{DiskEdges, EDGE_SAMPLES};
use crate::scene::{EmissionLaw, Projection, Scene};
use crate::sky::least_patch;
use crate::tracer::{FrameRequest, Tile};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec4};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FrameUniform {
    right: Vec4,
    up: Vec4,
    forward: Vec4,
    beta: Vec4,
    e_r: Vec4,
    e_theta: Vec4,
    e_phi: Vec4,
    place: Vec4,
    zamo: Vec4,
    hole: Vec4,
    sky_x: Vec4,
    sky_y: Vec4,
    sky_z: Vec4,
    disk: Vec4,
    size: Vec4,
    turbulence: Vec4,
    critical: Vec4,
    disk_u: [f32; 2],
    opaque_u: [f32; 2],
    capture_u: f32,
    max_steps: u32,
    max_crossings: u32,
    rain: u32,
    effects: u32,
    view: u32,
    pattern: [u32; 2],
    /// Known once the textures are there (`Tables::map_sizes`).
    pub map_sizes: [u32; 4],
    projection: u32,
    medium_layer: u32,
    plane_u: [f32; 2],
    soft_edges: Vec4,
    surface: Vec4,
    shown_edges: Vec4,
    plunge: Vec4,
    occluder: Vec4,
    bands: [[u32; 4]; MOST_BANDS],
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
    /// `EDGE_SAMPLES` or `CURVE_SAMPLES`.
    pub refined: u32,
    pub light_origin: [i32; 2],
    pub image_origin: [u32; 2],
    pub pixels_first: u32,
    pub pixels_row: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layouts() -> [crate::gpu::kernel::layout::Layout; 2] {
    use crate::gpu::kernel::layout::layout;
    let frame = layout!(FrameUniform as "Frame": right, up, forward, beta, e_r, e_theta, e_phi, place, zamo, hole,
        sky_x, sky_y, sky_z, disk, size, turbulence, critical, disk_u, opaque_u, capture_u, max_steps,
        max_crossings, rain, effects, view, pattern, map_sizes, projection,
        medium_layer, plane_u, soft_edges, surface, shown_edges, plunge, occluder, bands, depth_u, matter_count,
        matter_delay, matter);
    let pass = layout!(PassUniform as "Pass": origin, size, offset, weight, first, slot, refined, light_origin,
        image_origin, pixels_first, pixels_row);
    [frame, pass]
}

fn with(v: DVec3, w: f64) -> Vec4 {
    v.as_vec3().extend(w as f32)
}

fn four(x: f64, y: f64, z: f64, w: f64) -> Vec4 {
    with(DVec3::new(x, y, z), w)
}

/// omega, q, sqrt(Sg), sqrt(Sg D) of the start values (docs/numerics.md); 0 in the rain frame, which has its own.
fn zamo(frame: &LocalFrame) -> Vec4 {
    if frame.rain {
        return Vec4::ZERO;
    }
    let (a, u) = (frame.a, 1.0 / frame.r);
    let au2 = (a * u).powi(2);
    let sigma = 1.0 + au2 * frame.cos * frame.cos;
    let d = (1.0 - horizon_outer(a) * u) * (1.0 - horizon_inner(a) * u);
    let big_a = (1.0 + au2).powi(2) - d * au2 * frame.sin * frame.sin;
    four(zamo_omega(a, frame.r, frame.sin), (big_a / sigma).sqrt() / u, sigma.sqrt(), (sigma * d).sqrt())
}

/// An interval of 1/r; (1, 0), which nothing lies in, for none.
fn range(u: Option<[f64; 2]>) -> [f32; 2] {
    u.map_or([1.0, 0.0], |u| u.map(|u| u as f32))
}

/// Bands as `bands.wgsl` has them; beyond the last one it goes on.
pub(in crate::gpu) fn bands(bands: &Bands) -> [[u32; 4]; MOST_BANDS] {
    std::array::from_fn(|i| {
        let band = bands.band(bands.first + i as i32);
        [(band.age as f32).to_bits(), (band.spacing as f32).to_bits(), band.generation, (band.drift as f32).to_bits()]
    })
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
        bytemuck::bytes_of(&Self { map_sizes: other.map_sizes, ..*self }) == bytemuck::bytes_of(other)
    }

    /// `settings`: those of f32 pixels; `crossings`: most that a traced record holds. Errors: as `Scene::lens`.
    pub fn new(scene: &Scene, emitters: &Emitters, lens: &Lens, settings: &Settings, crossings: u32) -> Result<Self> {
        let frame = &lens.observer.frame;
        let a = scene.hole.spin;
        let disk = scene.disk.unwrap_or_default();
        let sky = scene.chart_to_sky();
        let isco = scene.disk_isco();
        let turbulence = emitters.disk.and_then(|disk| disk.turbulence);
        let [hottest, least] = emitters.disk.and_then(|disk| disk.least_profile).unwrap_or_default();
        let [least_light, tolerance] = evenness(scene);
        let edges = DiskEdges::new(emitters.disk_u().unwrap_or_default(), emitters.fading_u());
        let (matter, matter_count) = uniforms_of(&emitters.volumes);
        let u = 1.0 / frame.r;
        let CurveLevel { critical: [sin, cos], by_margin, .. } = CurveLevel::new(frame);
        Ok(Self {
            right: with(lens.axes.x_axis, lens.mapping.pixel_angle),
            up: with(lens.axes.y_axis, 0.0),
            forward: with(lens.axes.z_axis, 0.0),
            beta: with(lens.observer.beta, lens.observer.gamma),
            e_r: with(frame.e_r, 0.0),
            e_theta: with(frame.e_theta, 0.0),
            e_phi: with(frame.e_phi, 0.0),
            place: four(u, frame.sin, frame.cos, if frame.rain { (2.0 * u).sqrt() } else { frame.lapse }),
            zamo: zamo(frame),
            hole: four(a, horizon_outer(a), horizon_inner(a), if disk.retrograde { -isco } else { isco }),
            sky_x: with(sky.x_axis, scene.sky.stars_brightness),
            sky_y: with(sky.y_axis, scene.sky.map_brightness),
            sky_z: with(sky.z_axis, least_patch(lens.mapping.pixel_angle)),
            disk: four(
                emitters.disk.map_or(disk.temperature, |thin| thin.hottest),
                BlackbodyTable::shared().ln_luminance(disk.temperature),
                disk.opacity,
                disk.brightness,
            ),
            size: four(lens.mapping.width, lens.mapping.height, settings.step, settings.tolerance),
            turbulence: turbulence
                .map_or(Vec4::ZERO, |t| four(t.strength, t.reference_delay, t.fades_inside.unwrap_or(-1e30), 0.0)),
            critical: four(sin, cos, f64::from(u8::from(by_margin)), 0.0),
            disk_u: range(emitters.disk_u()),
            opaque_u: range(settings.opaque_u),
            capture_u: settings.capture_u as f32,
            max_steps: settings.max_steps,
            max_crossings: settings.max_crossings as u32,
            rain: u32::from(frame.rain) + u32::from(frame.clock() == Clock::Rain),
            effects: scene.effects.light(),
            view: scene.view as u32,
            pattern: turbulence.map_or([0; 2], |t| [t.bands.seed, t.bands.first as u32]),
            map_sizes: [1; 4],
            projection: lens.mapping.projection as u32,
            medium_layer: crossings,
            plane_u: range(emitters.plane_u()),
            soft_edges: emitters.disk.map_or(Vec4::ZERO, |thin| {
                let SoftEdges { outer, inner } = thin.edges;
                four(outer[0], outer[1], inner[0], inner[1])
            }),
            surface: four(f64::from(u8::from(disk.emission_law == EmissionLaw::LimbDarkened)), hottest, least, 0.0),
            shown_edges: four(edges.least[0], edges.least[1], least_light, tolerance),
            occluder: scene.occluder.as_ref().map_or(four(0.0, 0.0, 1.0, 0.0), |occluder| {
                let [x, y] = occluder.origin.map(f64::from);
                four(x, y, scene.hole.mass, f64::from(u8::from(occluder.lensed)))
            }),
            plunge: scene.matter().plunge.map_or(Vec4::ZERO, |p| four(p.isco, p.energy, p.spin_term, p.x)),
            bands: turbulence.map_or([[0; 4]; MOST_BANDS], |t| bands(&t.bands)),
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
    projection: Projection,
    slot: u32,
    light_origin: [u32; 2],
) -> PassUniform {
    let region = request.region;
    let [dx, dy] = sample_offset(sample, samples, projection);
    PassUniform {
        origin: [(region.x + tile.x) as i32 - 1, (region.y + tile.y) as i32 - 1],
        size: [tile.width + 2, tile.height + 2],
        offset: [dx as f32, dy as f32],
        weight: 1.0 / samples as f32,
        first: u32::from(sample == 0),
        slot,
        refined: EDGE_SAMPLES,
        light_origin: light_origin.map(|v| v as i32),
        image_origin: [tile.x, tile.y],
        pixels_first: 0,
        pixels_row: 0,
    }
}
