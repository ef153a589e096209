// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras in the chart RAIN about a spinning hole: the GPU's pictures against the CPU's, inside the horizon and beside
//! it, with matter of every kind; a fall through r = 3 M, where tracers change charts, and through r+; and pixels that
//! count as edges.

use crate::frames::{both, cpu, floats, gpu, picture};
use crate::random::runs_all;
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Chart, Disk, HotSpot, LensTables, Motion, Scene, Sky, View, Volume, VolumeResolution};
use glam::DVec3;

const SIZE: [u32; 2] = [160, 90];

/// A camera at (r, theta, azimuth) of the chart RAIN, M = 1, which looks across the hole.
fn camera(motion: Motion, [r, theta, azimuth]: [f64; 3]) -> Camera {
    let position = DVec3::new(theta.sin() * azimuth.cos(), theta.sin() * azimuth.sin(), theta.cos()) * r;
    Camera {
        position,
        forward: position.cross(DVec3::Z) - position * 0.4 + DVec3::new(0.1, 0.2, -0.3) * r,
        fov_y: 1.6,
        motion,
        velocity: DVec3::new(0.3, -0.2, 0.25),
        chart: Chart::Rain,
        ..Camera::plain()
    }
}

type Set = fn(&mut Scene);

/// Matter that shines besides the sky.
fn matter() -> [(&'static str, Set); 5] {
    [
        ("a disk", |scene| scene.disk = Some(Disk { turbulence: 0.0, ..Disk::plain() })),
        ("a turbulent disk", |scene| scene.disk = Some(Disk { turbulence: 1.0, opacity: 0.7, ..Disk::plain() })),
        ("clouds", |scene| {
            (scene.disk, scene.time) = (None, 40.0);
            scene.volumes = [Volume { turbulence: 1.0, ..Volume::default() }].into_iter().collect();
        }),
        ("a spot and a halo", |scene| {
            scene.disk = Some(Disk::plain());
            scene.volumes = [Volume { turbulence: 0.0, ..Volume::default() }].into_iter().collect();
            scene.hot_spots = [HotSpot::default()].into_iter().collect();
        }),
        ("a plunging disk", |scene| scene.disk = Some(Disk { plunges: true, ..Disk::plain() })),
    ]
}

/// Spin, place, motion.
fn places() -> [(f64, [f64; 3], Motion); 12] {
    use Motion::{FreeFall, Static, Velocity};
    [
        (0.9, [1.43588989, 1.3, 0.4], FreeFall),
        (0.9, [1.2, 1.3, 0.4], FreeFall),
        (0.9, [0.7, 1.2, 2.0], Velocity),
        (0.9, [0.57, 1.0, -2.0], FreeFall),
        (0.9, [1.6, 1.4, 1.0], Velocity),
        (0.9, [2.99, 1.5, 0.4], FreeFall),
        (0.5, [1.0, 1.3, 3.0], Velocity),
        (0.5, [0.3, 0.2, 3.0], FreeFall),
        (-0.7, [1.1, 2.0, 1.0], Velocity),
        (0.99, [1.05, 1.4, 0.0], FreeFall),
        (0.2, [1.9, 1.57, 5.0], Velocity),
        (0.9, [2.2, 1.1, 0.4], Static),
    ]
}

/// The picture that a tracer makes of a scene.
fn seen(renderer: &mut Renderer, format: PixelFormat, set: &dyn Fn(&mut Scene)) -> Vec<u8> {
    renderer.scene = Scene::plain();
    renderer.scene.sky.flags = Sky::GRID | Sky::STARS;
    set(&mut renderer.scene);
    picture(renderer, format, SIZE, None, false)
}

#[test]
fn the_tracers_agree() {
    let (mut cpu, mut gpu) = (cpu(), gpu());
    for (i, (spin, place, motion)) in places().into_iter().enumerate() {
        // Everyday four places, each with another kind of matter.
        if !runs_all() && ![0, 2, 3, 11].contains(&i) {
            continue;
        }
        let (name, shines) = matter()[i % matter().len()];
        let set = |scene: &mut Scene| {
            scene.hole.spin = spin;
            scene.camera = camera(motion, place);
            shines(scene);
            scene.quality.volume_resolution = VolumeResolution::Full;
        };
        let [a, b] = [&mut cpu, &mut gpu].map(|renderer| seen(renderer, PixelFormat::Rgba8Srgb, &set));
        let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
        let count = pixels.len();
        let off = |limit: u8| {
            let differs = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > limit);
            pixels.clone().filter(|pair| differs(*pair)).count()
        };
        let lit = a.chunks_exact(4).filter(|pixel| pixel[..3].iter().any(|v| *v > 8)).count();
        let (beyond, far) = (off(2), off(24));
        println!(
            "spin {spin}, {place:?}, {motion:?}, {name}: {lit} of {count} lit; {beyond} beyond 2, {far} beyond 24"
        );
        assert!(lit > count / 20, "spin {spin}, {place:?}, {name}: {lit} pixels are lit");
        // Stars and grid lines move by a hair.
        assert!(beyond * 1000 <= count * 4 && far * 1000 <= count, "spin {spin}, {place:?}, {name}: {beyond}, {far}");
    }
}

/// Pictures of the sky and of thin disks by tables of the lens: both tracers show the same, as they do ray by ray.
#[test]
fn tables_show_what_rays_do() {
    let (mut cpu, mut gpu) = (cpu(), gpu());
    let shown: [(&str, Set); 3] = [("nothing", |scene| scene.disk = None), matter()[0], matter()[1]];
    for (i, (spin, place, motion)) in
        places().into_iter().enumerate().filter(|(_, (.., motion))| *motion != Motion::Static)
    {
        for (kind, (name, shines)) in shown.into_iter().enumerate() {
            // From within the plane disks are traced.
            let edge_on = kind > 0 && place[1].cos().abs() < 0.03;
            if edge_on || (!runs_all() && (i > 4 || i % 3 != kind)) {
                continue;
            }
            let seen_by = |renderer: &mut Renderer, tables: LensTables| {
                let set = |scene: &mut Scene| {
                    (scene.hole.spin, scene.camera, scene.quality.lens_tables) = (spin, camera(motion, place), tables);
                    shines(scene);
                    // The grid's equator lies beside the image of the disk's far edge, where tables and rays refine
                    // other pixels.
                    scene.sky.flags = Sky::STARS;
                };
                seen(renderer, PixelFormat::Rgba8Srgb, &set)
            };
            let traced = seen_by(&mut cpu, LensTables::Never);
            let steps = cpu.stats().steps;
            let pictures = [&mut cpu, &mut gpu].map(|renderer| {
                let picture = seen_by(renderer, LensTables::Always);
                (picture, renderer.stats().lens_tables, renderer.stats().steps)
            });
            let off = |a: &[u8], b: &[u8], limit: u8| {
                let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > limit);
                a.chunks_exact(4).zip(b.chunks_exact(4)).filter(differs).count()
            };
            let count = traced.len() / 4;
            let [(on_cpu, ..), (on_gpu, ..)] = &pictures;
            let found = [(on_cpu, &traced), (on_cpu, on_gpu)].map(|(a, b)| [off(a, b, 2), off(a, b, 24)]);
            let told = pictures.each_ref().map(|(_, made, steps)| (*made, *steps));
            println!("spin {spin}, {place:?}, {motion:?}, {name}: {found:?} of {count}; {told:?}, traced {steps}");
            // Where a disk's image is as narrow as a pixel, tables and rays refine other pixels.
            for ([beyond, far], [most, most_far]) in found.into_iter().zip([[10, 3], [5, 1]]) {
                let few = beyond * 1000 <= count * most && far * 1000 <= count * most_far;
                assert!(few, "spin {spin}, {place:?}, {name}: {found:?}");
            }
            // Most rays are looked up, in tables that were made for the picture.
            for (made, integrated) in told {
                assert!(made == 1 && 2 * integrated < steps, "spin {spin}, {place:?}, {name}: {told:?}, {steps}");
            }
        }
    }
}

/// Numbers that depend on nothing but the ray: deflection and g of the sky.
#[test]
fn the_tracers_agree_on_views() {
    let (mut cpu, mut gpu) = (cpu(), gpu());
    for (i, (spin, place, motion)) in places().into_iter().enumerate() {
        if !runs_all() && i % 4 != 3 {
            continue;
        }
        for view in [View::Deflection, View::Redshift, View::Order] {
            let set = |scene: &mut Scene| {
                (scene.hole.spin, scene.camera, scene.view) = (spin, camera(motion, place), view);
                scene.disk = Some(Disk::plain());
            };
            let [a, b] = [&mut cpu, &mut gpu].map(|renderer| floats(&seen(renderer, PixelFormat::R32F, &set)));
            let differs = |(a, b): &(&f32, &f32)| a.is_nan() != b.is_nan() || (*a - *b).abs() > 2e-4 * (1.0 + a.abs());
            let far = a.iter().zip(&b).filter(differs).count();
            assert!(far * 500 < a.len(), "spin {spin}, {place:?}, {view:?}: {far} of {} pixels", a.len());
        }
    }
}

/// Frames of a fall 1e-4 M of proper time apart, by what `advance_camera` says: through r = 3 M, where tracers change
/// charts, and through r+. Each follows from the two before as well as the others do: nothing jumps there, neither
/// place nor time of the disk's structure nor its light.
#[test]
fn a_fall_has_no_seam() {
    const STEP: f64 = 1e-4;
    let spin = 0.9_f64;
    for (tracer, mut renderer) in both() {
        for seam in [1.0 + (1.0 - spin * spin).sqrt(), 3.0] {
            renderer.scene = Scene::plain();
            let scene = &mut renderer.scene;
            (scene.hole.spin, scene.sky, scene.time) = (spin, Sky::black(), 1e3);
            scene.camera = camera(Motion::FreeFall, [seam + 4.5 * STEP, 1.3, 0.4]);
            scene.disk = Some(Disk { turbulence: 1.0, outer_radius: 20.0, ..Disk::plain() });
            // More rays for pixels with edges would come and go.
            scene.quality.refines = false;
            let mut frames: Vec<Vec<f32>> = Vec::new();
            for _ in 0..10 {
                frames.push(floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, false)));
                let scene = &mut renderer.scene;
                let (after, passed) = scene.advance_camera(&scene.camera, STEP).unwrap();
                (scene.camera, scene.time) = (after, scene.time + passed);
            }
            let light = frames[0].iter().map(|v| f64::from(*v)).sum::<f64>() / frames[0].len() as f64;
            let jolts = frames.windows(3).map(|f| {
                let bends = (0..f[0].len()).map(|i| f64::from((f[0][i] - 2.0 * f[1][i] + f[2][i]).abs()));
                bends.sum::<f64>() / f[0].len() as f64 / light
            });
            let mut jolts = jolts.collect::<Vec<_>>();
            let at_seam = jolts[2..6].iter().copied().fold(0.0, f64::max);
            jolts.sort_by(f64::total_cmp);
            println!("{tracer}, through {seam}: jolts {:.1e}, at the seam {at_seam:.1e}", jolts[4]);
            // In single precision every frame is off by as much as two charts are.
            assert!(at_seam < 2.0 * jolts[4] + 2e-5, "{tracer}, through {seam}: {jolts:?}");
        }
    }
}

/// Pixels of a picture of which the light differs from another's.
fn unlike(a: &[f32], b: &[f32]) -> Vec<bool> {
    let differs = |(a, b): (&[f32], &[f32])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-3 * (a.abs() + b.abs()));
    a.chunks_exact(4).zip(b.chunks_exact(4)).map(differs).collect()
}

/// Between the horizons crossings of the disk's plane begin at r+: where the first of a ray's is lost there, the sky
/// alone is seen on both sides, and no edge. More rays for its pixels would show single stars in a line through the
/// even glow of all. Edges of the disk stay refined.
#[test]
#[ignore = "in tests/run all; everyday: the tracers agree inside, and a fall has no seam"]
fn no_edge_runs_along_the_horizon() {
    const FULL: [u32; 2] = [320, 180];
    let around = |x: i32, reach: i32, size: u32| (x - reach).max(0)..(x + reach + 1).min(size as i32);
    for (tracer, mut renderer) in both() {
        for (place, motion) in [([0.9, 0.96, -1.6], Motion::FreeFall), ([0.57, 0.49, -1.6], Motion::FreeFall)] {
            let mut light = |disk: bool, sky: bool, refines: bool| {
                renderer.scene = Scene::plain();
                let scene = &mut renderer.scene;
                scene.hole.spin = 0.9;
                scene.camera = Camera { forward: -camera(motion, place).position, ..camera(motion, place) };
                scene.camera.fov_y = 2.0;
                scene.disk = disk.then(|| Disk { inner_radius: 4.0, turbulence: 0.0, ..Disk::plain() });
                scene.sky = if sky { Sky { flags: Sky::STARS, ..Sky::plain() } } else { Sky::black() };
                scene.quality.refines = refines;
                floats(&picture(&mut renderer, PixelFormat::Rgba32F, FULL, None, false))
            };
            // Pixels whose light changes when edges are refined: of all, of the sky alone, and of the disk alone.
            let refined = unlike(&light(true, true, true), &light(true, true, false));
            let of_sky = unlike(&light(false, true, true), &light(false, true, false));
            let edges = unlike(&light(true, false, true), &light(true, false, false));
            let disk: Vec<bool> = light(true, false, false).chunks_exact(4).map(|p| p[..3] != [0.0; 3]).collect();
            let lone = |i: &usize| {
                let (x, y) = (*i as i32 % FULL[0] as i32, *i as i32 / FULL[0] as i32);
                let is_sky = |[x, y]: [i32; 2]| !disk[(y * FULL[0] as i32 + x) as usize];
                let apart = around(y, 3, FULL[1]).all(|y| around(x, 3, FULL[0]).all(|x| is_sky([x, y])));
                refined[*i] && !of_sky[*i] && apart
            };
            let alone = (0..refined.len()).filter(lone).count();
            let count = |pixels: &[bool]| pixels.iter().filter(|pixel| **pixel).count();
            println!(
                "{tracer}, {place:?}: {} refined, {} without the disk, {} of the disk's edges, {alone} far from both",
                count(&refined),
                count(&of_sky),
                count(&edges)
            );
            assert!(alone < 8, "{tracer}, {place:?}: {alone} pixels of the sky are refined");
            assert!(count(&edges) > 300, "{tracer}, {place:?}: {} pixels", count(&edges));
        }
    }
}
