// SPDX-License-Identifier: MIT OR Apache-2.0
//! Outputs beside the picture, of both tracers, however rays are found: against rays that are traced one by one in f64
//! on the CPU, against pictures and views, and the picture among them against the same frame alone, byte for byte.

use crate::frames::{both, cpu, floats, picture};
use crate::random::runs_all;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::job::OutputTarget;
use bhr::renderer::Renderer;
use bhr::scene::{
    Camera, Hit, LensTables, Motion, Output, Projection, Ray, RayOutput, RayOutputKind, Region, Scene, View, Volume,
};
use glam::DVec3;

const fn of(kind: RayOutputKind, index: u32) -> Output {
    Output::Ray(RayOutput { kind, index })
}

const DEPTH: Output = of(RayOutputKind::Depth, 0);
const SKY: Output = of(RayOutputKind::Sky, 0);
const TRANSMISSION: Output = of(RayOutputKind::Transmission, 0);
const POSITION: Output = of(RayOutputKind::Position, 0);
const SECOND: Output = of(RayOutputKind::Position, 1);
const DISK: Output = of(RayOutputKind::Disk, 0);
const REDSHIFT: Output = of(RayOutputKind::Redshift, 0);
const ORDER: Output = of(RayOutputKind::Order, 0);

/// The images of `outputs`, LIGHT in `light`.
fn outputs(
    renderer: &mut Renderer,
    outputs: &[Output],
    light: PixelFormat,
    [width, height]: [u32; 2],
    region: Option<Region>,
) -> Vec<Vec<u8>> {
    let layouts = outputs.iter().map(|o| Layout::packed(o.format().unwrap_or(light), width, height));
    let layouts = layouts.collect::<Vec<_>>();
    let bytes = |l: &Layout| (width * height) as usize * l.format.bytes_per_pixel();
    let mut blocks = layouts.iter().map(|l| vec![0xa5; bytes(l)]).collect::<Vec<_>>();
    let targets = outputs.iter().zip(layouts).zip(&mut blocks).map(|((output, layout), block)| OutputTarget {
        output: *output,
        target: ImageMut::new(layout, block).unwrap(),
        transparent: false,
    });
    let targets = targets.collect();
    renderer.render_outputs(targets, region, &mut |_| true).unwrap();
    blocks
}

fn scene(spin: f64, tables: LensTables, projection: Projection, opacity: f64) -> Scene {
    let mut scene = Scene::plain();
    let position = DVec3::new(9.0, -14.0, 5.0) * 2.5;
    scene.hole.spin = spin;
    scene.hole.mass = 2.5;
    scene.hole.axis = DVec3::new(0.3, -0.2, 0.9).normalize();
    scene.camera = Camera { projection, position, forward: -position, fov_y: 1.1, ..Camera::plain() };
    if projection != Projection::Perspective {
        scene.camera.fov_y = 3.0;
    }
    let disk = scene.disk.as_mut().unwrap();
    (disk.opacity, disk.outer_radius) = (opacity, 12.0);
    scene.quality.lens_tables = tables;
    scene
}

const SIZE: [u32; 2] = [96, 64];

/// The rays through the pixels' centres and what they hit, in f64.
fn hits(scene: &Scene, [width, height]: [u32; 2]) -> (Vec<Ray>, Vec<Hit>) {
    let mut tracer = cpu();
    tracer.scene = Scene { camera: Camera { motion: Motion::Static, ..scene.camera }, ..scene.clone() };
    let count = (width * height) as usize;
    let mut rays = vec![Ray::default(); count];
    scene.camera_rays(width, height, None, &mut |i, ray| rays[i] = ray).unwrap();
    let mut hits = vec![Hit::default(); count];
    tracer.trace_rays(&rays, &mut hits).unwrap();
    (rays, hits)
}

/// Shares of pixels at which numbers may differ by more than `tolerance`: those beside the disk's edges and the
/// critical curve, where one ray meets something and the next does not.
fn compare(name: &str, found: &[f32], wanted: &[f64], tolerance: f64, most: f64) {
    assert_eq!(found.len(), wanted.len(), "{name}");
    let alike = |(found, wanted): (&f32, &f64)| {
        let found = f64::from(*found);
        (found.is_nan() && wanted.is_nan())
            || found == *wanted
            || (found - wanted).abs() <= tolerance * (1.0 + wanted.abs())
    };
    let off = found.iter().zip(wanted).filter(|pair| !alike(*pair)).count();
    let share = off as f64 / found.len() as f64;
    println!("{name}: {off} of {} differ by more than {tolerance:e}", found.len());
    if share > most {
        for (i, pair) in found.iter().zip(wanted).enumerate().filter(|(_, pair)| !alike(*pair)).take(12) {
            println!("  {i}: {pair:?}");
        }
    }
    assert!(share <= most, "{name}: {share}");
}

/// Every output against single rays, which know nothing of outputs.
#[test]
fn outputs_are_what_rays_meet() {
    let ways = [
        (0.0, LensTables::Always, Projection::Perspective, 0.5),
        (0.0, LensTables::Never, Projection::Fisheye, 1.0),
        (0.9, LensTables::Always, Projection::Perspective, 1.0),
        (0.9, LensTables::Never, Projection::Perspective, 0.5),
        (0.9, LensTables::Always, Projection::Equirect, 0.5),
        (0.0, LensTables::Always, Projection::Cube, 1.0),
    ];
    for (spin, tables, projection, opacity) in ways.into_iter().take(if runs_all() { 6 } else { 4 }) {
        let scene = scene(spin, tables, projection, opacity);
        let size = match projection {
            Projection::Cube => [192, 32],
            _ => SIZE,
        };
        let (rays, hits) = hits(&scene, size);
        let wanted = Wanted { scene: &scene, size, rays: &rays, hits: &hits };
        for (name, mut renderer) in both() {
            renderer.scene = scene.clone();
            let list = [DEPTH, SKY, POSITION, SECOND, DISK, REDSHIFT, ORDER];
            let images = outputs(&mut renderer, &list, PixelFormat::Rgba8Srgb, size, None);
            let images = images.iter().map(|image| floats(image)).collect::<Vec<_>>();
            let name = |of: &str| format!("{name}, spin {spin}, {tables:?}, {projection:?}: {of}");
            // f32 keeps six digits of rays, of which those that wind about the hole lose some.
            let tolerance = 5e-5;
            compare(&name("depth"), &images[0], &wanted.values(|w, i| vec![w.depth(i)]), tolerance, 0.002);
            compare(&name("sky"), &images[1], &wanted.values(Wanted::sky), tolerance, 0.002);
            compare(&name("position 0"), &images[2], &wanted.values(|w, i| w.position(i, 0)), tolerance, 0.002);
            compare(&name("position 1"), &images[3], &wanted.values(|w, i| w.position(i, 1)), tolerance, 0.002);
            compare(&name("disk"), &images[4], &wanted.values(Wanted::disk), tolerance, 0.002);
            compare(&name("g"), &images[5], &wanted.values(|w, i| vec![w.redshift(i)]), tolerance, 0.002);
            compare(&name("order"), &images[6], &wanted.values(|w, i| vec![w.order(i)]), 0.0, 0.002);
        }
    }
}

/// Outputs by their definitions, from hits.
struct Wanted<'a> {
    scene: &'a Scene,
    size: [u32; 2],
    rays: &'a [Ray],
    hits: &'a [Hit],
}

impl Wanted<'_> {
    fn values(&self, of: impl Fn(&Self, usize) -> Vec<f64>) -> Vec<f64> {
        (0..self.hits.len()).flat_map(|i| of(self, i)).collect()
    }

    /// Whether the projection shows anything at a pixel.
    fn seen(&self, i: usize) -> bool {
        let [width, height] = self.size.map(f64::from);
        let [x, y] = [i as f64 % width, (i as f64 / width).floor()].map(|at| at.floor() + 0.5);
        let out = (x - width / 2.0).hypot(y - height / 2.0) > 0.5 * width.min(height);
        !(self.scene.camera.projection == Projection::Fisheye && out)
    }

    /// The orders of the crossings within the disk's radii.
    fn crossings(&self, i: usize) -> Vec<usize> {
        let disk = self.scene.disk.unwrap();
        let mass = self.scene.hole.mass;
        let within = |r: f64| r <= disk.outer_radius * mass && r >= self.scene.disk_isco() * mass;
        let hit = &self.hits[i];
        (0..hit.crossing_count as usize).filter(|k| within(hit.crossings[*k].radius)).collect()
    }

    fn fate(&self, i: usize) -> f64 {
        if self.hits[i].fate == bhr::scene::Fate::Escaped { -1.0 } else { -2.0 }
    }

    fn place(&self, i: usize, order: usize) -> DVec3 {
        let crossing = &self.hits[i].crossings[order];
        let (sin, cos) = crossing.azimuth.sin_cos();
        self.scene.hole.scene_to_chart().transpose() * (DVec3::new(cos, sin, 0.0) * crossing.radius)
    }

    fn depth(&self, i: usize) -> f64 {
        if !self.seen(i) {
            return f64::NAN;
        }
        let eye = self.scene.camera.position;
        match self.crossings(i).first() {
            Some(0) => (self.place(i, 0) - eye).length(),
            None if self.fate(i) == -1.0 => f64::INFINITY,
            _ => (-eye.dot(self.rays[i].direction)).max(0.0),
        }
    }

    fn sky(&self, i: usize) -> Vec<f64> {
        let hit = &self.hits[i];
        match self.seen(i) && self.fate(i) == -1.0 {
            true => hit.sky_direction.extend(hit.sky_redshift).to_array().into(),
            false => vec![0.0; 4],
        }
    }

    fn position(&self, i: usize, index: usize) -> Vec<f64> {
        match (self.seen(i), self.crossings(i).get(index)) {
            (false, _) => vec![f64::NAN; 4],
            (true, Some(order)) => self.place(i, *order).extend(*order as f64).to_array().into(),
            (true, None) => DVec3::NAN.extend(self.fate(i)).to_array().into(),
        }
    }

    fn disk(&self, i: usize) -> Vec<f64> {
        match self.crossings(i).first() {
            Some(order) if self.seen(i) => {
                let crossing = &self.hits[i].crossings[*order];
                vec![crossing.radius, crossing.azimuth, crossing.redshift, crossing.delay]
            }
            _ => vec![f64::NAN; 4],
        }
    }

    fn redshift(&self, i: usize) -> f64 {
        let sky = if self.fate(i) == -1.0 { self.hits[i].sky_redshift } else { f64::NAN };
        let value = self.crossings(i).first().map_or(sky, |order| self.hits[i].crossings[*order].redshift);
        if self.seen(i) { value } else { f64::NAN }
    }

    fn order(&self, i: usize) -> f64 {
        let value = self.crossings(i).first().map_or(self.fate(i), |order| *order as f64);
        if self.seen(i) { value } else { f64::NAN }
    }
}

/// LIGHT has the bytes of the frame alone: with edges refined, several samples, glare, turbulence, and in regions.
#[test]
#[ignore = "in tests/run all; everyday: outputs in tests/interop"]
fn light_is_the_frame_alone() {
    for (name, mut renderer) in both() {
        for (samples, bloom, turbulence, spin) in [(1, 0.0, 0.0, 0.9), (3, 0.0, 1.0, 0.0), (1, 0.3, 0.0, 0.0)] {
            renderer.scene = scene(spin, LensTables::Always, Projection::Perspective, 1.0);
            renderer.scene.quality.samples_per_pixel = samples;
            renderer.scene.film.bloom = bloom;
            renderer.scene.disk.as_mut().unwrap().turbulence = turbulence;
            // Everyday several samples are seen in half floats, one sample in bytes.
            let formats = [PixelFormat::Rgba8Srgb, PixelFormat::Rgba16F];
            for format in formats.into_iter().filter(|format| runs_all() || (*format == formats[1]) == (samples > 1)) {
                let alone = picture(&mut renderer, format, SIZE, None, false);
                let among = outputs(&mut renderer, &[DEPTH, Output::Light, SKY], format, SIZE, None);
                assert!(alone == among[1], "{name}, {samples} samples, bloom {bloom}, {format}");
                let again = picture(&mut renderer, format, SIZE, None, false);
                assert!(alone == again, "{name}: a frame after outputs");
            }
        }
    }
}

/// TRANSMISSION is 1 - alpha of a picture without the sky and with one ray a pixel; matter with depth counts.
#[test]
fn transmission_is_what_alpha_leaves() {
    for (name, mut renderer) in both() {
        for volume in [false, true] {
            renderer.scene = scene(0.0, LensTables::Always, Projection::Perspective, 0.7);
            renderer.scene.quality.refines = false;
            if volume {
                renderer.scene.volumes.push(Volume { absorption: 0.2, ..Volume::default() });
            }
            let alpha = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, true));
            let left = alpha.chunks_exact(4).map(|pixel| f64::from(1.0 - pixel[3])).collect::<Vec<_>>();
            let found = &outputs(&mut renderer, &[TRANSMISSION], PixelFormat::Rgba8Srgb, SIZE, None)[0];
            compare(&format!("{name}, volume {volume}"), &floats(found), &left, 1e-5, 0.002);
            assert!(left.contains(&1.0) && left.contains(&0.0));
            assert!(left.iter().any(|v| (0.05..0.6).contains(v)), "{name}: something is translucent");
        }
    }
}

/// Views among outputs are what frames of these views hold.
#[test]
#[ignore = "in tests/run all; everyday: outputs of views in tests/c"]
fn views_are_those_of_frames() {
    let views =
        [View::Redshift, View::Order, View::Deflection, View::Steps, View::Metric, View::OpticalDepth, View::Intensity];
    for (name, mut renderer) in both() {
        renderer.scene = scene(0.0, LensTables::Always, Projection::Perspective, 1.0);
        renderer.scene.volumes.push(Volume { power_law: true, ..Volume::default() });
        let found = outputs(&mut renderer, &views.map(Output::of_view), PixelFormat::Rgba8Srgb, SIZE, None);
        for (view, found) in views.into_iter().zip(&found) {
            renderer.scene.view = view;
            let alone = floats(&picture(&mut renderer, PixelFormat::R32F, SIZE, None, false));
            let alone = alone.into_iter().map(f64::from).collect::<Vec<_>>();
            compare(&format!("{name}, {}", view.name()), &floats(found), &alone, 1e-4, 0.005);
        }
    }
}

/// Parts of a frame are parts of its outputs, and a job makes what a call makes.
#[test]
fn regions_and_jobs_are_the_same() {
    let list = [DEPTH, POSITION, Output::Light, SKY, TRANSMISSION];
    for (name, mut renderer) in both() {
        renderer.scene = scene(0.0, LensTables::Always, Projection::Perspective, 0.5);
        let whole = outputs(&mut renderer, &list, PixelFormat::Rgba16F, SIZE, None);
        let [width, height] = [40, 17];
        let region = Region { full_width: SIZE[0], full_height: SIZE[1], x: 31, y: 22 };
        let part = outputs(&mut renderer, &list, PixelFormat::Rgba16F, [width, height], Some(region));
        for ((whole, part), output) in whole.iter().zip(&part).zip(list) {
            let bytes = output.format().unwrap_or(PixelFormat::Rgba16F).bytes_per_pixel();
            for (y, row) in part.chunks_exact(width as usize * bytes).enumerate() {
                let begin = ((22 + y) * SIZE[0] as usize + 31) * bytes;
                assert!(row == &whole[begin..begin + row.len()], "{name}, {output:?}, row {y}");
            }
        }
        let blocks = whole.iter().map(|image| &*vec![0_u8; image.len()].leak()).collect::<Vec<_>>();
        let targets = list.iter().zip(&blocks).map(|(output, block)| {
            let layout = Layout::packed(output.format().unwrap_or(PixelFormat::Rgba16F), SIZE[0], SIZE[1]);
            // SAFETY: leaked for this test, which reads the block when the job is done.
            let target = unsafe { ImageMut::from_raw(layout, block.as_ptr().cast_mut(), block.len() as u64) }.unwrap();
            OutputTarget { output: *output, target, transparent: false }
        });
        let job = renderer.render_outputs_in_background(targets.collect(), None).unwrap();
        let mut told = vec![];
        let outcome = job.wait(None, &mut |fraction| {
            told.push(fraction);
            true
        });
        outcome.unwrap().unwrap();
        assert!(told.is_sorted(), "{told:?}");
        assert!(blocks.iter().zip(&whole).all(|(job, call)| **job == call[..]), "{name}: a job");
    }
}

/// Progress never falls, ends at 1, and cancels between the parts and within them.
#[test]
fn progress_is_of_all_outputs() {
    for (name, mut renderer) in both() {
        renderer.scene = scene(0.0, LensTables::Always, Projection::Perspective, 1.0);
        let mut blocks = [vec![0; 96 * 64 * 4], vec![0; 96 * 64 * 16]];
        let [light, sky] = &mut blocks;
        let mut told: Vec<f64> = vec![];
        let mut render = |light: &mut [u8], sky: &mut [u8], stop: f64| {
            let target = |output: Output, format, block| OutputTarget {
                output,
                target: ImageMut::new(Layout::packed(format, 96, 64), block).unwrap(),
                transparent: false,
            };
            let targets =
                vec![target(Output::Light, PixelFormat::Rgba8Srgb, light), target(SKY, PixelFormat::Rgba32F, sky)];
            told.clear();
            let result = renderer.render_outputs(targets, None, &mut |fraction| {
                told.push(fraction);
                fraction < stop
            });
            (result, told.clone())
        };
        let (result, told) = render(light, sky, 2.0);
        result.unwrap();
        assert!(told.is_sorted() && told.last() == Some(&1.0), "{name}: {told:?}");
        assert!(told.contains(&0.5), "{name}: {told:?}");
        let (result, _) = render(light, sky, 0.5);
        let error = result.unwrap_err();
        assert_eq!(error.kind, bhr::error::ErrorKind::Cancelled, "{name}");
    }
}
