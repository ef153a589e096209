// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's things before the camera, on both tracers, however rays are found: the crossings that they leave, by the
//! distances that outputs give, one tracer against the other, parts of frames, and what they must not change.

use crate::frames::{both, cpu, differing, floats, gpu, picture};
use crate::random::runs_all;
use crate::volumes::{haze, in_haze, radial};
use bhr::image::{ImageMut, ImageRef, PixelFormat, memory::Layout};
use bhr::job::OutputTarget;
use bhr::renderer::Renderer;
use bhr::scene::{
    Camera, Chart, HotSpot, LensTables, Motion, Occluder, RayOutputKind, Region, Scene, View, Volume, VolumeResolution,
};
use glam::DVec3;

const SIZE: [u32; 2] = [120, 80];

/// A translucent disk, of which the far side lies behind the hole.
fn scene(spin: f64, tables: LensTables) -> Scene {
    let mut scene = Scene::plain();
    let position = DVec3::new(14.0, -20.0, 6.0) * 3.0;
    (scene.hole.spin, scene.hole.mass) = (spin, 3.0);
    scene.camera = Camera { position, forward: -position, fov_y: 1.0, ..Camera::plain() };
    let disk = scene.disk.as_mut().unwrap();
    (disk.opacity, disk.outer_radius) = (0.5, 14.0);
    scene.quality.lens_tables = tables;
    scene
}

const WAYS: [(f64, LensTables); 4] =
    [(0.0, LensTables::Always), (0.0, LensTables::Never), (0.9, LensTables::Always), (0.9, LensTables::Never)];

fn occluder([width, height]: [u32; 2], distance: impl Fn(u32, u32) -> f32) -> Occluder {
    let all = (0..width * height).map(|i| distance(i % width, i / width)).collect::<Vec<_>>();
    let layout = Layout::packed(PixelFormat::R32F, width, height);
    Occluder::new(&ImageRef::new(layout, bytemuck::cast_slice(&all)).unwrap()).unwrap()
}

fn output(renderer: &mut Renderer, kind: RayOutputKind) -> Vec<f32> {
    let mut block = vec![0; (SIZE[0] * SIZE[1] * 4) as usize];
    let target = ImageMut::new(Layout::packed(PixelFormat::R32F, SIZE[0], SIZE[1]), &mut block).unwrap();
    let target = OutputTarget { output: kind.into(), target, transparent: false };
    renderer.render_outputs(vec![target], None, &mut |_| true).unwrap();
    floats(&block)
}

/// Alpha of each pixel tells which crossings are left: the distances that outputs give say the same.
#[test]
#[ignore = "in tests/run all; everyday: both tracers agree about things, and a mesh of a sphere hides what it should"]
fn things_hide_what_lies_behind_them() {
    for (spin, tables) in WAYS {
        for (name, mut renderer) in both() {
            renderer.scene = scene(spin, tables);
            renderer.scene.quality.refines = false;
            let depth = output(&mut renderer, RayOutputKind::Depth);
            let order = output(&mut renderer, RayOutputKind::Order);
            let plain = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, true));
            let eye = renderer.scene.camera.position.length() as f32;
            // Before everything; before the hole and behind the near side of the disk; behind the hole and before the
            // far side of the disk; behind everything.
            for distance in [1.0, eye * 0.75, eye * 1.25, 1e6] {
                renderer.set_occluder(Some(occluder(SIZE, |_, _| distance)));
                let seen = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, true));
                let mut counts = [0; 3];
                let mut off = 0;
                for (i, (seen, plain)) in seen.chunks_exact(4).zip(plain.chunks_exact(4)).enumerate() {
                    let ends = distance < 0.99 * eye * 0.8;
                    let direct = order[i] == 0.0;
                    let kept = direct && depth[i] <= distance;
                    let alike = match (ends, kept, direct) {
                        // The direct image alone, before the thing.
                        (true, true, _) => (seen[3] - 0.5).abs() < 1e-6 && seen[0] > 0.0,
                        (true, false, _) => *seen == [0.0; 4],
                        // The direct image is hidden, and nothing else.
                        (false, false, true) => seen[3] < plain[3] || plain[3] == 1.0,
                        (false, _, _) => seen.iter().zip(plain).all(|(a, b)| (a - b).abs() <= 1e-3 * (1.0 + b.abs())),
                    };
                    off += usize::from(!alike);
                    counts[if kept { 0 } else { 1 + usize::from(direct) }] += 1;
                }
                assert!(off <= 20, "{name}, spin {spin}, {tables:?}, {distance}: {off} pixels, {counts:?}");
            }
            renderer.set_occluder(None);
        }
    }
}

/// Things of any shape, with edges refined and several samples: the tracers agree, also without alpha. Everyday one of
/// these in each way: samples and turbulence know nothing of how rays are found.
#[test]
fn the_tracers_agree() {
    let shape = |x: u32, y: u32| match (x / 7 + y / 5) % 4 {
        0 => f32::INFINITY,
        1 => 40.0,
        2 => 80.0 + x as f32,
        _ => 60.0 + y as f32 / 2.0,
    };
    for (way, (spin, tables)) in WAYS.into_iter().enumerate() {
        for (i, (samples, turbulence, transparent)) in
            [(1, 0.0, true), (1, 1.0, false), (2, 0.0, true)].into_iter().enumerate()
        {
            if !runs_all() && way % 3 != i {
                continue;
            }
            let mut scene = scene(spin, tables);
            scene.quality.samples_per_pixel = samples;
            scene.disk.as_mut().unwrap().turbulence = turbulence;
            let pictures = [cpu(), gpu()].map(|mut renderer| {
                renderer.scene = scene.clone();
                renderer.set_occluder(Some(occluder(SIZE, shape)));
                let made = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, transparent);
                renderer.set_occluder(None);
                made
            });
            let off = differing(&pictures[0], &pictures[1]);
            println!("spin {spin}, {tables:?}, {samples} samples, turbulence {turbulence}: {off} pixels differ");
            assert!(off < 60, "spin {spin}, {tables:?}, {samples} samples, turbulence {turbulence}: {off}");
        }
    }
}

/// Where there is nothing, pictures are what they are without; tiles are parts of frames; views do not regard it.
#[test]
fn nothing_else_changes() {
    for (name, mut renderer) in both() {
        renderer.scene = scene(0.0, LensTables::Always);
        renderer.scene.disk.as_mut().unwrap().opacity = 1.0;
        let plain = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        renderer.set_occluder(Some(occluder(SIZE, |_, _| f32::INFINITY)));
        let same = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        assert!(differing(&plain, &same) < 10, "{name}: {}", differing(&plain, &same));
        let shape = |x: u32, y: u32| if (x / 9 + y / 11).is_multiple_of(2) { 50.0 } else { f32::INFINITY };
        renderer.set_occluder(Some(occluder(SIZE, shape)));
        let whole = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, true);
        renderer.set_occluder(Some(occluder([50, 20], |x, y| shape(x + 30, y + 25))));
        let region = Region { full_width: SIZE[0], full_height: SIZE[1], x: 30, y: 25 };
        let part = picture(&mut renderer, PixelFormat::Rgba8Srgb, [50, 20], Some(region), true);
        for (y, row) in part.chunks_exact(200).enumerate() {
            let begin = ((25 + y) * SIZE[0] as usize + 30) * 4;
            assert!(row == &whole[begin..begin + 200], "{name}, row {y}");
        }
        renderer.scene.view = View::Order;
        picture(&mut renderer, PixelFormat::R32F, SIZE, None, false);
        renderer.set_occluder(None);
    }
}

/// Pixels that edges run through take the same rays behind a screen that hides nothing: what the disk hides from them
/// does not decide how they are refined. Seen from within the horizon, where the edges of all images are in a few
/// pixels.
#[test]
fn a_screen_that_hides_nothing_changes_no_edge() {
    let size = [96, 54];
    for (name, mut renderer) in both() {
        let mut scene = Scene { time: 13.0, ..Scene::default() };
        scene.hole.spin = 0.998;
        scene.film.bloom = 0.0;
        let (sin, cos) = 0.7_f64.sin_cos();
        let position = DVec3::new(cos * cos, cos * sin, sin) * 0.949;
        let (chart, motion) = (Chart::Rain, Motion::FreeFall);
        scene.camera = Camera { position, forward: -position, fov_y: 2.3, chart, motion, ..Camera::plain() };
        renderer.scene = scene;
        let plain = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true);
        renderer.set_occluder(Some(occluder(size, |_, _| f32::INFINITY)));
        let same = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true);
        renderer.set_occluder(None);
        assert_eq!(differing(&plain, &same), 0, "{name}");
    }
}

/// A haze along a radial ray, cut at a distance: light and alpha are integrals up to there.
#[test]
fn matter_with_depth_is_cut_at_the_distance() {
    for (name, mut renderer) in both() {
        for (distance, lensed) in [(0.05, false), (1.3, true), (2.7, false), (6.1, true), (11.0, false), (1e4, true)] {
            let haze = haze(6.0, 0.05, 0.08);
            let r0 = 8.0;
            let position = DVec3::new(0.0, r0, 0.0);
            renderer.scene = in_haze(haze);
            renderer.scene.camera =
                Camera { position, forward: position, fov_y: 1e-3, up: DVec3::Z, ..Camera::plain() };
            renderer.set_occluder(Some(Occluder { lensed, ..occluder([1, 1], |_, _| distance) }));
            let pixel = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [1, 1], None, true));
            renderer.set_occluder(None);
            let (light, depth) = radial(&haze, r0, f64::from(distance).min(72.0));
            let light = light * renderer.scene.film.exposure_ev.exp2();
            let alpha = -f64::exp_m1(-depth);
            let off = [(f64::from(pixel[1]) - light) / light, (f64::from(pixel[3]) - alpha) / alpha];
            println!("{name}, {distance} M: light and alpha are off by {:.1e} and {:.1e}", off[0], off[1]);
            assert!(off.iter().all(|off| off.abs() < 1e-3), "{name}, {distance}: {pixel:?}, {light} {alpha}");
        }
    }
}

/// Without spin a ray is alike on both sides of its place nearest to the hole, and so is a haze at rest: half of its
/// depth lies before that place. That holds where light is bent by much, too.
#[test]
#[ignore = "in tests/run all; everyday: matter with depth is cut at the distance"]
fn half_of_the_matter_lies_before_the_nearest_place() {
    // Everyday in a smaller frame: rays are alike in each, and their paths take long.
    let size = if runs_all() { SIZE } else { [60, 40] };
    for (name, mut renderer) in both() {
        renderer.scene = in_haze(haze(8.0, 0.02, 0.03));
        let position = DVec3::new(0.0, -100.0, 0.0);
        renderer.scene.camera = Camera { position, forward: -position, fov_y: 0.3, ..Camera::plain() };
        let distances = (0..size[0] * size[1]).map(|i| {
            let (x, y) = (f64::from(i % size[0]) + 0.5, f64::from(i / size[0]) + 0.5);
            let ray = renderer.scene.camera_ray(size[0], size[1], None, x, y).unwrap();
            let path = renderer.trace_path(&ray, 4096).unwrap();
            let place = |p: &[f64; 4]| DVec3::new(p[0], p[1], p[2]);
            let places = path.iter().map(place).collect::<Vec<_>>();
            let i = (1..places.len() - 1).min_by(|i, j| places[*i].length().total_cmp(&places[*j].length())).unwrap();
            // Between its points the path is a parabola.
            let [a, b, c] = [places[i - 1], places[i], places[i + 1]];
            let at = |t: f64| b + 0.5 * t * (c - a) + 0.5 * t * t * (a + c - 2.0 * b);
            let nearest = (-100..=100)
                .map(|t| at(f64::from(t) / 100.0))
                .min_by(|a, b| a.length().total_cmp(&b.length()))
                .unwrap();
            // Farther in, rays wind about the hole, and come nearer to the camera again.
            if nearest.length() > 5.5 { (nearest - position).length() as f32 } else { f32::INFINITY }
        });
        let distances = distances.collect::<Vec<_>>();
        let plain = floats(&picture(&mut renderer, PixelFormat::Rgba32F, size, None, true));
        let halved = occluder(size, |x, y| distances[(y * size[0] + x) as usize]);
        renderer.set_occluder(Some(Occluder { lensed: true, ..halved }));
        let half = floats(&picture(&mut renderer, PixelFormat::Rgba32F, size, None, true));
        renderer.set_occluder(None);
        let (mut compared, mut worst) = (0, 0.0_f32);
        let pixels = half.chunks_exact(4).zip(plain.chunks_exact(4)).zip(&distances);
        for ((half, plain), _) in pixels.filter(|(_, distance)| distance.is_finite()) {
            worst = worst.max((1.0 - half[3] - (1.0 - plain[3]).sqrt()).abs());
            compared += 1;
        }
        println!("{name}: {compared} rays, half of the depth within {worst:.1e}");
        assert!(compared * 96 > distances.len() * 50 && worst < 5e-3, "{name}: {compared} {worst}");
    }
}

/// Matter with and without structure, a spot and a disk behind things of any shape, edges refined: the tracers agree.
/// Everyday in two of the four ways, in which each setting has each of its values.
#[test]
#[ignore = "in tests/run all; everyday: things with a disk, and matter is cut at the distance"]
fn the_tracers_agree_about_matter_behind_things() {
    // Everyday fewer pixels, with bounds for as many.
    let (size, least, most) = if runs_all() { (SIZE, 1000, 60) } else { ([84, 56], 500, 30) };
    let shape = |x: u32, y: u32| match (x / 17 + y / 13) % 4 {
        0 => f32::INFINITY,
        1 => 60.0,
        2 => 75.0 + x as f32 / 8.0,
        _ => 70.0 + y as f32 / 4.0,
    };
    for (spin, turbulence, lensed, half) in
        [(0.0, 0.0, false, false), (0.9, 0.0, true, false), (0.9, 1.0, true, true), (0.9, 1.0, false, false)]
            .into_iter()
            .step_by(if runs_all() { 1 } else { 2 })
    {
        let mut scene = scene(spin, LensTables::Never);
        scene.disk = (turbulence == 0.0).then_some(scene.disk).flatten();
        let disk = Volume { turbulence, thickness: 0.2, absorption: 0.4, ..Volume::default() };
        scene.volumes = [disk].into_iter().collect();
        if turbulence == 0.0 {
            scene.hot_spots = [HotSpot { radius: 9.0, ..HotSpot::default() }].into_iter().collect();
        }
        scene.quality.volume_resolution = if half { VolumeResolution::Half } else { VolumeResolution::Full };
        let pictures = [cpu(), gpu()].map(|mut renderer| {
            renderer.scene = scene.clone();
            let plain = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true);
            renderer.set_occluder(Some(Occluder { lensed, ..occluder(size, shape) }));
            let made = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true);
            renderer.set_occluder(None);
            (differing(&plain, &made), made)
        });
        let [(hidden, cpu), (_, gpu)] = pictures;
        let off = differing(&cpu, &gpu);
        println!("spin {spin}, turbulence {turbulence}, lensed {lensed}: {hidden} pixels hidden, {off} differ");
        assert!(hidden > least && off < most, "spin {spin}, turbulence {turbulence}: {hidden} {off}");
    }
}
