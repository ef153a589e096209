// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames with structured matter: its mean, its motion, and how well a pixel's one ray shows it. `emit::clouds` has the
//! tests of the structure itself.

use crate::frames::{both, cpu, floats, gpu, picture};
use crate::random::runs_all;
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Effects, FlowLaw, LensTables, Ray, Region, Scene, Shape, Sky, Transfer, View, Volume};
use glam::{DQuat, DVec3};

const SIZE: [u32; 2] = [48, 27];

/// Volumes by themselves, from r = 28, so many degrees above the plane.
fn alone(elevation: f64, volume: Volume) -> Scene {
    let (sin, cos) = elevation.to_radians().sin_cos();
    let position = DVec3::new(28.0 * cos, 0.0, 28.0 * sin);
    let camera = Camera { position, forward: -position, up: DVec3::Z, fov_y: 0.7, ..Camera::plain() };
    let mut scene = Scene { disk: None, sky: Sky::black(), camera, time: 35.0, ..Scene::plain() };
    scene.hole.spin = 0.6;
    scene.quality.refines = false;
    scene.quality.lens_tables = LensTables::Never;
    scene.volumes.push(volume);
    scene
}

fn light(renderer: &mut Renderer, scene: &Scene) -> Vec<f32> {
    renderer.scene = scene.clone();
    let pixels = floats(&picture(renderer, PixelFormat::Rgba32F, SIZE, None, false));
    pixels.as_chunks::<4>().0.iter().map(|p| p[1]).collect()
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}

fn apart(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.len() as f64
}

/// On average over what it may look like, matter with structure is as thick as even matter, and a power law as bright.
#[test]
fn structure_keeps_the_mean() {
    let mut renderer = cpu();
    let thin = Volume { absorption: 0.02, thickness: 0.15, power_law: true, ..Volume::default() };
    for view in [View::OpticalDepth, View::Intensity] {
        let mut value = |turbulence: f64, seed: u64| {
            let scene = Scene { view, ..alone(40.0, Volume { turbulence, seed, ..thin }) };
            renderer.scene = scene;
            let values = floats(&picture(&mut renderer, PixelFormat::R32F, SIZE, None, false));
            mean(&values.into_iter().map(|v| if v.is_nan() { 0.0 } else { v }).collect::<Vec<_>>())
        };
        let even = value(0.0, 0);
        let structured = (0..12).map(|seed| value(1.0, seed)).collect::<Vec<_>>();
        let average = structured.iter().sum::<f64>() / 12.0;
        assert!((average / even - 1.0).abs() < 0.08, "{view:?}: {structured:?}, not {even}");
        assert!(structured.iter().any(|v| (v / even - 1.0).abs() > 0.02), "{view:?}: {structured:?} all are {even}");
    }
}

/// Structure moves from frame to frame, evenly: no frame differs from the one before by much more than others do.
#[test]
fn structure_moves_and_nothing_pops() {
    let mut renderer = cpu();
    for (volume, begin) in [
        (Volume::default(), 35.0),
        (
            Volume { shape: Shape::Jet, flow: FlowLaw::Outflow, thickness: 0.05, absorption: 0.3, ..Volume::default() },
            1e9,
        ),
    ] {
        let mut scene = alone(15.0, volume);
        let mut frame = |time: f64| {
            scene.time = time;
            light(&mut renderer, &scene)
        };
        let frames = (0..if runs_all() { 24 } else { 14 }).map(|i| frame(begin + f64::from(i))).collect::<Vec<_>>();
        let mut steps = frames.windows(2).map(|pair| apart(&pair[0], &pair[1])).collect::<Vec<_>>();
        steps.sort_by(f64::total_cmp);
        let (median, most) = (steps[steps.len() / 2], steps[steps.len() - 1]);
        assert!(most < 2.0 * median && median < 0.2 * mean(&frames[0]), "{:?}: {steps:?}", volume.shape);
        let far = apart(&frames[0], &frames[frames.len() - 1]);
        assert!(far > 3.0 * median, "{:?}: {far} {median}", volume.shape);
        assert_eq!(frames[0], frame(begin), "{:?}", volume.shape);
    }
}

/// A frame is a function of its time alone: in any order, and after a jump of a thousand million M and back, frames
/// have the same bytes.
#[test]
fn frames_in_any_order_have_the_same_bytes() {
    for (tracer, mut renderer) in both() {
        let mut scene = alone(10.0, Volume::default());
        let mut frame = |time: f64| {
            scene.time = time;
            renderer.scene = scene.clone();
            picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false)
        };
        let times = [3.0, 3.5, 1e9, 4.0];
        let first = times.map(&mut frame);
        for (time, first) in [1, 3, 0, 2].map(|i| (times[i], &first[i])) {
            assert!(frame(time) == *first, "{tracer}, at {time}");
        }
        assert!(first[0] != first[1] && first[0] != first[2], "{tracer}");
    }
}

/// Births do not pop: however a generation begins to show, no frame differs from the ones about it by much more than
/// others do.
#[test]
#[ignore = "in tests/run all; everyday: structure moves and nothing pops"]
fn births_do_not_pop() {
    let mut renderer = cpu();
    let region = Region { full_width: 1920, full_height: 1080, x: 500, y: 400 };
    let mut last = Vec::<Vec<f32>>::new();
    let mut bends = Vec::new();
    for i in 0..120 {
        renderer.scene = Scene { time: 100.0 + 0.25 * f64::from(i), ..alone(6.5, Volume::default()) };
        let pixels = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, Some(region), false));
        last.push(pixels.into_iter().skip(1).step_by(4).collect());
        if let [a, b, c] = &last[..] {
            let bend = a.iter().zip(b).zip(c).map(|((a, b), c)| f64::from((a - 2.0 * b + c).abs())).sum::<f64>();
            bends.push(bend);
            last.remove(0);
        }
    }
    bends.sort_by(f64::total_cmp);
    let (median, most) = (bends[bends.len() / 2], bends[bends.len() - 1]);
    println!("second differences {median:.4}, at most {most:.4}");
    assert!(most < 1.5 * median, "{bends:?}");
}

/// Light that took longer shows older structure, unless that is off; and seeds differ.
#[test]
fn structure_is_seen_with_its_delay() {
    let mut renderer = cpu();
    let mut scene = alone(10.0, Volume::default());
    let delayed = light(&mut renderer, &scene);
    scene.effects = Effects(Effects::ALL & !Effects::LIGHT_DELAY);
    let at_once = light(&mut renderer, &scene);
    assert!(apart(&delayed, &at_once) > 0.1 * mean(&delayed));
    scene.volumes[0].seed = 1 << 40;
    assert!(apart(&light(&mut renderer, &scene), &at_once) > 0.1 * mean(&delayed));
    scene.volumes[0].turbulence = 0.0;
    scene.volumes[0].seed = 0;
    let even = light(&mut renderer, &scene);
    scene.volumes[0].clumping = 3.0;
    assert_eq!(light(&mut renderer, &scene), even);
}

/// One ray of a pixel shows about the mean of what many find there, and no less light.
#[test]
fn pixels_show_about_what_many_rays_find() {
    let mut renderer = cpu();
    // Everyday the two thick ones.
    let first = usize::from(!runs_all());
    for volume in [
        Volume::default(),
        Volume { thickness: 0.14, absorption: 0.3, ..Volume::default() },
        Volume {
            shape: Shape::Torus,
            thickness: 0.2,
            absorption: 0.1,
            flow: FlowLaw::AngularMomentum,
            ..Volume::default()
        },
    ]
    .into_iter()
    .skip(first)
    {
        let mut scene = alone(10.0, volume);
        let one = light(&mut renderer, &scene);
        scene.quality.samples_per_pixel = 16;
        let many = light(&mut renderer, &scene);
        let (difference, brightness) = (apart(&one, &many), mean(&many));
        println!("{:?}: {difference} of {brightness}, {}", volume.shape, mean(&one));
        assert!(difference < 0.2 * brightness, "{:?}: {difference} {brightness}", volume.shape);
        assert!((mean(&one) / brightness - 1.0).abs() < 0.06, "{:?}: {} {brightness}", volume.shape, mean(&one));
    }
}

/// Where structure is larger than pixels, layers are so thin that they leave no ripples along filaments: a picture is
/// near to what rays find that are summed in fine cells.
#[test]
#[ignore = "in tests/run all; everyday: both tracers agree about structure"]
fn layers_leave_no_ripples() {
    for (i, (tracer, mut renderer)) in both().into_iter().enumerate() {
        for (j, (x, y)) in [(300, 700), (1100, 560), (500, 400)].into_iter().enumerate() {
            // Everyday each part by one tracer: layers are chosen by one rule, and pictures of both are compared.
            if !runs_all() && (i + j) % 2 == 1 {
                continue;
            }
            let mut scene = alone(6.5, Volume::default());
            scene.camera.forward = -scene.camera.position;
            let region = Region { full_width: 1920, full_height: 1080, x, y };
            let mut rays = vec![Ray::default(); (SIZE[0] * SIZE[1]) as usize];
            scene.camera_rays(SIZE[0], SIZE[1], Some(region), &mut |i, ray| rays[i] = ray).unwrap();
            renderer.scene = scene;
            let pixels = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, Some(region), false));
            let mut found = vec![Transfer::default(); rays.len()];
            renderer.transfer_rays(&rays, &mut found).unwrap();
            let green = || pixels.iter().skip(1).step_by(4).map(|v| f64::from(*v));
            let pairs = || green().zip(found.iter().map(|f| f.light[1]));
            let brightness = pairs().map(|(_, exact)| exact).sum::<f64>() / found.len() as f64;
            let off = pairs().map(|(seen, exact)| (seen - exact).powi(2)).sum::<f64>() / found.len() as f64;
            let off = off.sqrt() / brightness;
            println!("{tracer}, {x} {y}: off by {off:.4}");
            assert!(off < 0.012 && brightness > 1e-3, "{tracer}, {x} {y}: {off} of {brightness}");
        }
    }
}

/// Films do not crawl: what changes from frame to frame other than evenly is at most 1.5 times what it is where each
/// pixel has 16 rays. A view that turns, and time that passes.
#[test]
#[ignore = "in tests/run all; everyday: pixels change evenly while the camera pans"]
fn films_do_not_crawl() {
    // Everyday, a few frames of one film.
    let (frames, size, films) = if runs_all() { (240, [640, 360], 4) } else { (3, [48, 27], 1) };
    let mut renderer = gpu();
    let thick = Volume { thickness: 0.14, absorption: 0.3, inner_radius: 2.55, ..Volume::default() };
    let scenes = [("soft disk", 6.5, Volume::default()), ("thick disk", 10.0, thick)];
    for (turns, (name, elevation, volume)) in
        [true, false].into_iter().flat_map(|turns| scenes.map(|scene| (turns, scene))).take(films)
    {
        let mut unsteady = |samples: u32| {
            let mut scene = alone(elevation, volume);
            scene.quality.refines = true;
            scene.quality.samples_per_pixel = samples;
            let forward = scene.camera.forward;
            let (mut before, mut sum) = (Vec::<Vec<u8>>::new(), 0.0);
            for frame in 0..frames {
                if turns {
                    scene.camera.forward = DQuat::from_rotation_z(5e-4 * f64::from(frame)) * forward;
                } else {
                    scene.time = 35.0 + 0.25 * f64::from(frame);
                }
                renderer.scene = scene.clone();
                before.push(picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false));
                if let [a, b, c] = &before[..] {
                    let bend = |i: usize| (f64::from(a[i]) - 2.0 * f64::from(b[i]) + f64::from(c[i])).abs();
                    sum += (0..a.len()).map(bend).sum::<f64>() / a.len() as f64;
                    before.remove(0);
                }
            }
            sum / f64::from(frames - 2)
        };
        let (one, many) = (unsteady(1), unsteady(16));
        println!("{name}, {}: {one:.3} of 255, {many:.3} with 16 samples", if turns { "turning" } else { "in time" });
        assert!(many > 0.05 && one <= 1.5 * many, "{name}, turning {turns}: {one} {many}");
    }
}
