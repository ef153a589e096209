// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures: the GPU's against the CPU's, tiles against the whole, run against run, and the shadow's outline against
//! theory. The GPU is whatever adapter comes first; without one the tests fail.

use crate::frames::{both, cpu, differing, floats, gpu, new_gpu, picture, plain, tiled};
use crate::random::runs_all;
use bhr::gpu::{Device, Search, adapters};
use bhr::image::PixelFormat;
use bhr::physics::shadow::shadow;
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{
    Camera, EffectStrengths, Effects, EmissionLaw, KerrThreshold, LensTables, Lensing, Motion, Preset, Region, Scene,
    Sky, View,
};
use glam::DVec3;
use serde_json::Value;

/// A camera that looks at the hole from (r, inclination), azimuth 0.
fn camera(r: f64, inclination_degrees: f64, fov_degrees: f64, motion: Motion) -> Camera {
    let theta = inclination_degrees.to_radians();
    let plane = inclination_degrees == 90.0;
    let position = DVec3::new(theta.sin(), 0.0, if plane { 0.0 } else { theta.cos() }) * r;
    let up = if inclination_degrees == 0.0 { DVec3::X } else { DVec3::Z };
    Camera { position, forward: -position, up, fov_y: fov_degrees.to_radians(), motion, ..Camera::plain() }
}

type NamedScene = (&'static str, Box<dyn Fn(&mut Renderer)>);

/// Spin, camera, and what else is unusual.
fn scenes() -> Vec<NamedScene> {
    let scene = |name, spin: f64, c: Camera| -> NamedScene {
        (name, Box::new(move |r| (r.scene.hole.spin, r.scene.camera) = (spin, c)))
    };
    let mut list = vec![
        scene("default", 0.0, Camera::plain()),
        scene("edge-on", 0.0, camera(25.0, 90.0, 60.0, Motion::Static)),
        scene("polar", 0.7, camera(30.0, 0.0, 60.0, Motion::Static)),
        // The shadow fills half the sky there: along its edge.
        scene("r = 3", 0.0, Camera { forward: DVec3::Y, ..camera(3.0, 70.0, 90.0, Motion::Static) }),
        scene("r = 500", 0.3, camera(500.0, 80.0, 5.0, Motion::Static)),
        scene("spin 0.998", 0.998, camera(20.0, 75.0, 60.0, Motion::Static)),
        scene("orbit", 0.5, camera(10.0, 90.0, 80.0, Motion::Orbit)),
        scene("free fall inside", 0.0, camera(1.5, 60.0, 120.0, Motion::FreeFall)),
        // Looking back out; nearer still, f32 cannot tell the observer from the horizon.
        scene("free fall at a spinning horizon", 0.5, {
            let inward = camera((1.0 + 0.75_f64.sqrt()) * (1.0 + 1e-3), 60.0, 120.0, Motion::FreeFall);
            Camera { forward: -inward.forward, ..inward }
        }),
        scene("free fall with spin", 0.9, camera(6.0, 50.0, 100.0, Motion::FreeFall)),
    ];
    list.push((
        "retrograde, translucent, half the effects, fast camera, another axis and mass",
        Box::new(|r| {
            r.scene.hole.mass = 3.5;
            r.scene.hole.spin = -0.8;
            r.scene.hole.axis = DVec3::new(0.2, -0.5, 0.8).normalize();
            r.scene.camera = camera(40.0, 65.0, 70.0, Motion::Velocity);
            r.scene.camera.velocity = DVec3::new(-0.3, 0.4, 0.1);
            let disk = r.scene.disk.as_mut().unwrap();
            (disk.retrograde, disk.opacity, disk.outer_radius) = (true, 0.4, 15.0);
            r.scene.effects = Effects(Effects::DOPPLER_SHIFT | Effects::BEAMING);
            r.scene.quality.max_disk_order = 6;
        }),
    ));
    list.push((
        "limb-darkened, fast camera",
        Box::new(|r| {
            (r.scene.hole.spin, r.scene.camera) = (0.9, camera(20.0, 80.0, 60.0, Motion::Velocity));
            r.scene.camera.velocity = DVec3::new(-0.3, 0.4, 0.1);
            let disk = r.scene.disk.as_mut().unwrap();
            (disk.emission_law, disk.opacity) = (EmissionLaw::LimbDarkened, 0.6);
        }),
    ));
    for (name, spin, place) in [
        ("plunging", 0.0, camera(20.0, 60.0, 40.0, Motion::Static)),
        ("plunging with spin", 0.9, camera(15.0, 20.0, 60.0, Motion::FreeFall)),
        ("plunging, from inside the horizon", 0.0, camera(1.5, 60.0, 120.0, Motion::FreeFall)),
    ] {
        list.push((
            name,
            Box::new(move |r| {
                (r.scene.hole.spin, r.scene.camera) = (spin, place);
                let disk = r.scene.disk.as_mut().unwrap();
                (disk.plunges, disk.retrograde, disk.opacity) = (true, spin > 0.0, 0.8);
                disk.emission_law = EmissionLaw::LimbDarkened;
            }),
        ));
    }
    list.push((
        "turbulent",
        Box::new(|r| {
            (r.scene.hole.spin, r.scene.camera) = (0.7, camera(25.0, 70.0, 60.0, Motion::Static));
            r.scene.time = 1e6;
            let disk = r.scene.disk.as_mut().unwrap();
            (disk.turbulence, disk.seed) = (1.0, 42);
        }),
    ));
    list.push((
        "turbulent, retrograde, translucent, without delay",
        Box::new(|r| {
            (r.scene.hole.mass, r.scene.hole.spin) = (2.0, 0.6);
            r.scene.camera = camera(50.0, 40.0, 50.0, Motion::Static);
            r.scene.time = 300.0;
            r.scene.effects = Effects(Effects::ALL & !Effects::LIGHT_DELAY);
            let disk = r.scene.disk.as_mut().unwrap();
            (disk.retrograde, disk.opacity, disk.turbulence, disk.seed) = (true, 0.6, 0.8, 7 << 32);
        }),
    ));
    for (name, spin, effects) in [
        ("the default scene, looked up", 0.0, Effects::ALL),
        ("the default scene, looked up, with spin", 0.9, Effects::ALL),
        ("the default scene, looked up, with spin, without delay", 0.9, Effects::ALL & !Effects::LIGHT_DELAY),
    ] {
        list.push((
            name,
            Box::new(move |r| {
                r.scene = Default::default();
                r.scene.hole.spin = spin;
                r.scene.effects = Effects(effects);
                r.scene.quality.lens_tables = LensTables::Always;
            }),
        ));
    }
    list.push((
        "turbulent, with graded effects",
        Box::new(|r| {
            r.scene.hole.spin = 0.9;
            r.scene.effect_strengths = EffectStrengths { doppler_shift: 0.3, gravity_shift: 0.8, beaming: 0.15 };
            r.scene.disk.as_mut().unwrap().turbulence = 0.8;
        }),
    ));
    list.push((
        "turbulent, plunging",
        Box::new(|r| {
            (r.scene.hole.spin, r.scene.camera) = (0.5, camera(25.0, 50.0, 30.0, Motion::Static));
            let disk = r.scene.disk.as_mut().unwrap();
            (disk.turbulence, disk.plunges, disk.edge_softness) = (1.0, true, 0.4);
        }),
    ));
    list.push((
        "turbulent, from inside the horizon",
        Box::new(|r| {
            r.scene.camera = camera(1.5, 60.0, 120.0, Motion::FreeFall);
            r.scene.time = 1e5;
            r.scene.disk.as_mut().unwrap().turbulence = 1.0;
        }),
    ));
    list.push((
        "turbulent, falling to the horizon",
        Box::new(|r| {
            let inward = camera(2.0 + 1e-5, 75.0, 120.0, Motion::FreeFall);
            r.scene.camera = Camera { forward: DVec3::Y - 0.3 * inward.forward, ..inward };
            r.scene.disk.as_mut().unwrap().turbulence = 1.0;
            r.scene.disk.as_mut().unwrap().opacity = 0.6;
        }),
    ));
    list
}

/// The pixels of the turbulent scenes that change by more than a few steps.
#[test]
#[ignore = "in tests/run all; everyday: both tracers agree about turbulent scenes"]
fn turbulence_shows_its_seed_and_its_time() {
    let size = [192, 108];
    type Change = (&'static str, fn(&mut Renderer));
    let changes: [Change; 4] = [
        ("strength", |r| r.scene.disk.as_mut().unwrap().turbulence = 0.0),
        ("seed", |r| r.scene.disk.as_mut().unwrap().seed ^= 1 << 40),
        ("time", |r| r.scene.time += 20.0),
        ("delay", |r| r.scene.effects.0 ^= Effects::LIGHT_DELAY),
    ];
    // Seed and time show alike wherever the camera is: everyday one scene from outside, one
    // from inside the horizon.
    let everyday = ["turbulent, retrograde, translucent, without delay", "turbulent, from inside the horizon"];
    for (name, set) in scenes()
        .into_iter()
        .filter(|(name, _)| name.starts_with("turbulent") && (runs_all() || everyday.contains(name)))
    {
        // From there the disk is a narrow band.
        let least = if name.contains("horizon") { 100 } else { 1000 };
        for (tracer, mut renderer) in both() {
            for (what, change) in changes {
                renderer.scene = Default::default();
                set(&mut renderer);
                let before = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false);
                change(&mut renderer);
                let after = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false);
                let pixels = before.chunks_exact(4).zip(after.chunks_exact(4));
                let differ = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 8)).count();
                println!("{name} on {tracer}: another {what} changes {differ} pixels");
                assert!(differ > least, "{name} on {tracer}: another {what} changes {differ} pixels");
            }
        }
    }
}

/// Everyday a third of the scenes, which together have nearly every setting.
#[test]
fn gpu_and_cpu_pictures_agree() {
    let size = [192, 108];
    let everyday = [
        "r = 3",
        "free fall at a spinning horizon",
        "retrograde, translucent, half the effects, fast camera, another axis and mass",
        "plunging, from inside the horizon",
        "the default scene, looked up",
        "the default scene, looked up, with spin",
        "turbulent, plunging",
    ];
    for (name, set) in scenes().into_iter().filter(|(name, _)| runs_all() || everyday.contains(name)) {
        let mut pictures = both().map(|(_, mut renderer)| {
            set(&mut renderer);
            picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false)
        });
        let [cpu, gpu] = &mut pictures;
        let differ = differing(cpu, gpu);
        let share = differ as f64 / f64::from(size[0] * size[1]);
        let worst = cpu.iter().zip(&**gpu).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
        println!("{name}: {differ} of {} pixels differ by more than one step, up to {worst}", size[0] * size[1]);
        // Levels of the streaks' pyramid are whole, and tables of f32 and f64 give patches that differ a little: where
        // a table about a spinning hole shows the disk from near by, some patches take another level.
        let most = if name.contains("looked up, with spin") { 4e-3 } else { 1e-3 };
        assert!(share <= most && worst < 40, "{name}: {differ} pixels differ by more than one step, up to {worst}");
        let lit = cpu.chunks_exact(4).filter(|p| p[0] > 8).count();
        assert!(lit > 20, "{name}: only {lit} pixels have light");
    }
}

/// OpenGL ES and OpenGL translate the shaders by themselves, through other paths of wgpu: Mesa's software GL stands
/// for them.
#[test]
fn gl_and_cpu_pictures_agree() {
    let size = [96, 54];
    for opacity in [1.0, 0.6] {
        let [cpu, gl] = [Backend::Cpu, Backend::Gl].map(|backend| {
            let options = RendererOptions { backend: Some(backend), ..Default::default() };
            let mut renderer = plain(options);
            renderer.scene.hole.spin = 0.6;
            renderer.scene.disk.as_mut().unwrap().opacity = opacity;
            picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false)
        });
        let differ = cpu.iter().zip(&gl).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        assert!(differ < 10, "{differ} bytes differ by more than one step");
    }
}

/// Everyday the scenes where something diverges: at the horizon, within it, at the photon orbit, and in fast motion.
#[test]
#[ignore = "in tests/run all; everyday: frames at the extremes"]
fn light_is_finite_in_every_pixel() {
    let diverge = ["horizon", "inside", "plunging", "r = 3", "fast"];
    for (name, set) in
        scenes().into_iter().filter(|(name, _)| runs_all() || diverge.iter().any(|word| name.contains(word)))
    {
        for (tracer, mut renderer) in both() {
            set(&mut renderer);
            let values = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [96, 54], None, false));
            let bad = values.iter().filter(|v| !v.is_finite() || **v < 0.0).count();
            assert_eq!(bad, 0, "{name} on {tracer}");
            assert!(values.chunks_exact(4).all(|p| p[3] == 1.0), "{name} on {tracer}: alpha");
        }
    }
}

/// Pictures of TEACHING, which has no exposure of its own for each hole: their mean light as displays show it.
#[test]
fn teaching_is_about_as_bright_at_every_spin() {
    let mut renderer = cpu();
    for elevation in [6.0, 20.0, 60.0] {
        let mut range = [f64::INFINITY, 0.0_f64];
        for spin in [0.0, 0.5, 0.9, 0.998] {
            renderer.scene = Scene::default();
            Preset::Teaching.apply(&mut renderer.scene);
            renderer.scene.hole.spin = spin;
            renderer.scene.camera = camera(30.0, 90.0 - elevation, 45.0, Motion::Static);
            let shown = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [160, 90], None, false));
            let light = shown.chunks_exact(4).map(|p| {
                let [red, green, blue] = [p[0], p[1], p[2]].map(|v| f64::from(v.min(1.0)));
                0.2126 * red + 0.7152 * green + 0.0722 * blue
            });
            let mean = light.sum::<f64>() / (160.0 * 90.0);
            range = [range[0].min(mean), range[1].max(mean)];
        }
        println!("{elevation} degrees: {range:.4?}");
        assert!(range[1] < 2.25 * range[0], "{elevation}: {range:?}");
    }
}

#[test]
fn views_agree() {
    let size = [96, 54];
    for view in [View::Redshift, View::Order, View::Deflection, View::Metric] {
        let [cpu, gpu] = both().map(|(_, mut renderer)| {
            (renderer.scene.hole.spin, renderer.scene.view) = (0.6, view);
            floats(&picture(&mut renderer, PixelFormat::R32F, size, None, false))
        });
        let wrong = cpu.iter().zip(&gpu).filter(|(a, b)| a.is_nan() != b.is_nan() || (*a - *b).abs() > 2e-4).count();
        assert!(wrong * 1000 <= cpu.len(), "{view:?}: {wrong} of {}", cpu.len());
        assert!(cpu.iter().filter(|v| v.is_finite()).count() > 1000, "{view:?} shows nothing");
    }
}

/// Odd tiles, joined, and the frame a second time after another one in between.
#[test]
fn tiles_and_repetitions_give_the_same_bytes() {
    let (width, height) = (75, 50);
    for (tracer, mut renderer) in both() {
        renderer.scene.hole.spin = 0.4;
        renderer.scene.quality.samples_per_pixel = 3;
        renderer.scene.disk.as_mut().unwrap().turbulence = 1.0;
        for format in [PixelFormat::Rgba8Srgb, PixelFormat::Rgba16F] {
            let whole = picture(&mut renderer, format, [width, height], None, false);
            let joined = tiled(&mut renderer, format, [width, height]);
            assert!(whole == joined, "{tracer}: {format:?} tiles");
            renderer.scene.hole.spin = 0.0;
            picture(&mut renderer, format, [20, 90], None, false);
            renderer.scene.hole.spin = 0.4;
            assert!(whole == picture(&mut renderer, format, [width, height], None, false), "{tracer}: again");
        }
    }
}

/// Frames whose rays are looked up: their bytes are the same with tables made afresh, used again, and filled for other
/// observers in between; tile by tile; and in every frame of an observer that moves there and back. Everyday one
/// observer for each kind of table.
#[test]
#[ignore = "in tests/run all; everyday: tiles and repetitions have the same bytes"]
fn tables_give_the_same_bytes() {
    let format = PixelFormat::Rgba8Srgb;
    let (small, size) = ([40, 30], if runs_all() { [210, 140] } else { [120, 80] });
    let observers = [
        (0.0, camera(12.0, 70.0, 60.0, Motion::Static)),
        (0.9, camera(12.0, 70.0, 60.0, Motion::Static)),
        (0.0, camera(1.5, 60.0, 120.0, Motion::FreeFall)),
        (0.9, camera(6.0, 90.0, 90.0, Motion::Orbit)),
    ];
    for make in [cpu, new_gpu] {
        let mut renderer = make();
        let name = renderer.adapter().name.clone();
        let show = |renderer: &mut Renderer, (spin, camera): (f64, Camera), size: [u32; 2], region: Option<Region>| {
            (renderer.scene.hole.spin, renderer.scene.camera) = (spin, camera);
            let disk = renderer.scene.disk.as_mut().unwrap();
            (disk.turbulence, disk.opacity) = (1.0, 0.7);
            // Left to itself a scene chooses tables for greater frames than a test has the time for (scene/lensing.rs).
            renderer.scene.quality.lens_tables = if size == small { LensTables::Never } else { LensTables::Always };
            picture(renderer, format, size, region, false)
        };
        let observers = if runs_all() { &observers[..] } else { &observers[1..3] };
        let there = observers.iter().map(|observer| show(&mut renderer, *observer, size, None)).collect::<Vec<_>>();
        for (observer, first) in observers.iter().zip(&there).rev() {
            // The observer comes from elsewhere, first in a frame that has no use for tables.
            let moved = (observer.0, Camera { position: observer.1.position * 1.01, ..observer.1 });
            show(&mut renderer, moved, small, None);
            show(&mut renderer, moved, size, None);
            assert!(*first == show(&mut renderer, *observer, size, None), "{name}: back at {observer:?}");
            assert!(*first == show(&mut renderer, *observer, size, None), "{name}: again at {observer:?}");
            assert!(*first == show(&mut make(), *observer, size, None), "{name}: another renderer at {observer:?}");
            assert!(*first == tiled(&mut renderer, format, size), "{name}: tiles at {observer:?}");
            let frame = renderer.scene.observer().unwrap().frame;
            let pixels = u64::from(size[0] * size[1]);
            assert!(
                renderer.scene.lensing(&frame, pixels, KerrThreshold::GPU) != Lensing::Traced,
                "{name}: no tables at {observer:?}"
            );
        }
    }
}

/// The largest difference of two values of pictures, in codes of 8 bits, or of floats against 1 and their own size.
fn furthest_apart(format: PixelFormat, a: &[u8], b: &[u8]) -> f64 {
    let values = |bytes: &[u8]| -> Vec<f64> {
        match format {
            PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => bytes.iter().map(|code| f64::from(*code)).collect(),
            PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => {
                let words = bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap()));
                words.flat_map(|word| [0, 10, 20, 30].map(|low| f64::from(word >> low & 1023))).collect()
            }
            PixelFormat::Rgba16F => {
                let halves = bytes.chunks_exact(2).map(|half| half::f16::from_le_bytes([half[0], half[1]]));
                halves.map(f64::from).collect()
            }
            PixelFormat::Rgba32F | PixelFormat::R32F => floats(bytes).into_iter().map(f64::from).collect(),
        }
    };
    let (a, b) = (values(a), values(b));
    assert_eq!(a.len(), b.len());
    let scale =
        |value: f64| if format.bytes_per_pixel() == 4 && format != PixelFormat::R32F { 1.0 } else { 1.0 + value.abs() };
    a.iter().zip(&b).map(|(a, b)| (a - b).abs() / scale(*a)).fold(0.0, f64::max)
}

/// Kernels that put pixels into the host's memory row by row, against those that pack them on the device. They are the
/// same sums, and the same bytes on software drivers; hardware's compilers may contract multiplications and additions
/// in one and not in the other (on an H200 some bytes differ).
#[test]
#[ignore = "in tests/run all; everyday: outputs in tests/interop, which are as such frames"]
fn pixels_put_by_rows_are_the_same() {
    let set = |renderer: &mut Renderer, spin: f64, samples: u32, tables: LensTables, view: View| {
        let scene = &mut renderer.scene;
        (scene.hole.spin, scene.view) = (spin, view);
        (scene.quality.samples_per_pixel, scene.quality.lens_tables) = (samples, tables);
    };
    let adapter = adapters(Search::Auto, false).remove(0);
    assert!(Device::open(&adapter).unwrap().maps_storage(), "{}", adapter.info.name);
    let mut renderer = gpu();
    let mut deferred = 0;
    // A wide enough look at the shadow's edge, where pixels are deferred.
    renderer.scene.camera = camera(20.0, 75.0, 40.0, Motion::Static);
    use PixelFormat::{Bgra8Srgb, Rgb10A2Pq, Rgba8Srgb, Rgba16F, Rgba32F};
    let light = [Rgba8Srgb, Bgra8Srgb, Rgb10A2Pq, Rgba16F, Rgba32F];
    let light = light.map(|format| (format, View::Light));
    for (spin, samples, tables) in [
        (0.0, 1, LensTables::Never),
        (0.0, 1, LensTables::Always),
        (0.9, 1, LensTables::Always),
        (0.9, 3, LensTables::Always),
    ] {
        for (format, view) in light.into_iter().chain([(PixelFormat::R32F, View::Order)]) {
            set(&mut renderer, spin, samples, tables, view);
            // Rows of workgroups that the tile fills, and ones that it does not.
            for size in [[128, 8], [101, 67], [1, 1], [33, 5]] {
                let [packed, rows] = [false, true].map(|mapped| {
                    renderer.scene.quality.mapped_pixels = Some(mapped);
                    picture(&mut renderer, format, size, None, false)
                });
                let apart = furthest_apart(format, &packed, &rows);
                let most = match format {
                    _ if adapter.info.software => 0.0,
                    PixelFormat::Rgba8Srgb | PixelFormat::Bgra8Srgb => 1.0,
                    PixelFormat::Rgb10A2Pq | PixelFormat::Rgb10A2Hlg => 1.0,
                    PixelFormat::Rgba16F | PixelFormat::Rgba32F => 1e-3,
                    PixelFormat::R32F => 0.0,
                };
                assert!(apart <= most, "{apart}: {size:?}, spin {spin}, {samples} samples, {tables:?}, {format}");
                deferred += if tables == LensTables::Always { renderer.stats().steps } else { 0 };
                assert!(size == [1, 1] || packed.iter().any(|byte| *byte != packed[0]));
            }
        }
    }
    assert!(deferred > 0, "no pixel was put singly");
}

/// A frame cut into tiles equals one that is not: at 308 bytes for a traced pixel with all its crossings, one tile
/// holds less than 0.7 of the 0.77 million pixels.
#[test]
fn large_frames_equal_their_parts() {
    let mut renderer = gpu();
    renderer.scene.quality.max_disk_order = 15;
    renderer.scene.quality.lens_tables = LensTables::Never;
    renderer.scene.disk.as_mut().unwrap().opacity = 0.5;
    let (width, height) = (1100, 700);
    let whole = picture(&mut renderer, PixelFormat::Rgba8Srgb, [width, height], None, false);
    let region = Region { full_width: width, full_height: height, x: 500, y: 300 };
    let part = picture(&mut renderer, PixelFormat::Rgba8Srgb, [150, 100], Some(region), false);
    for (row, line) in part.chunks_exact(600).enumerate() {
        let at = ((300 + row) * width as usize + 500) * 4;
        assert!(whole[at..at + 600] == *line, "row {row}");
    }
}

/// 1 where at least half of the pixel is captured, from the alpha of a transparent picture without disk.
fn silhouette(renderer: &mut Renderer, size: [u32; 2]) -> Vec<bool> {
    renderer.scene.disk = None;
    renderer.scene.sky = Sky::black();
    let pixels = picture(renderer, PixelFormat::Rgba8Srgb, size, None, true);
    pixels.chunks_exact(4).map(|p| p[3] >= 128).collect()
}

/// Every pixel whose centre lies more than half a pixel inside Synge's (aberrated) circle is dark, every one more than
/// half a pixel outside is not.
#[test]
fn spin_zero_shadow_is_synges_circle() {
    let size = [200, 200];
    let cases = [
        (6.0, 90.0, Motion::Static),
        (20.0, 40.0, Motion::Static),
        (200.0, 5.0, Motion::Static),
        (2.5, 150.0, Motion::Static),
        (10.0, 70.0, Motion::FreeFall),
        (1.9, 130.0, Motion::FreeFall),
        (8.0, 90.0, Motion::Orbit),
        (30.0, 60.0, Motion::Velocity),
    ];
    for (tracer, mut renderer) in both() {
        for (r, fov, motion) in cases {
            renderer.scene.camera = camera(r, 80.0, fov, motion);
            renderer.scene.camera.velocity = DVec3::new(-0.4, 0.3, 0.35);
            let observer = renderer.scene.observer().unwrap();
            let circle = shadow(&observer);
            let region = Region { full_width: size[0], full_height: size[1], x: 0, y: 0 };
            let lens = renderer.scene.lens(&region).unwrap();
            let dark = silhouette(&mut renderer, size);
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = |dx: f64, dy: f64| lens.look_direction(f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy);
                    let angle = at(0.0, 0.0).angle_between(circle.center);
                    let half =
                        0.5 * at(0.0, 0.0).angle_between(at(1.0, 0.0)).max(at(0.0, 0.0).angle_between(at(0.0, 1.0)));
                    let found = dark[(y * size[0] + x) as usize];
                    let case = format!("{tracer}: r {r} {motion:?} ({x}, {y}) angle {angle} of {}", circle.radius);
                    assert!(found || angle > circle.radius - half, "{case} is not dark");
                    assert!(!found || angle < circle.radius + half, "{case} is dark");
                }
            }
        }
    }
}

/// The radius of the static shadow, from its area in pixels.
#[test]
fn shadow_radius_measured_from_the_area() {
    for (tracer, mut renderer) in both() {
        for r in [5.0, 15.0, 100.0] {
            let fov = 2.0 * (1.6 * shadow_sine(r).asin()).min(1.3);
            renderer.scene.camera = camera(r, 60.0, fov.to_degrees(), Motion::Static);
            let dark = silhouette(&mut renderer, [256, 256]).iter().filter(|d| **d).count();
            let pixels = (dark as f64 / std::f64::consts::PI).sqrt();
            let expect = 128.0 * shadow_sine(r).asin().tan() / (0.5 * fov).tan();
            assert!((pixels - expect).abs() < 0.5, "{tracer}: r {r}: {pixels} pixels, Synge {expect}");
        }
    }
}

fn shadow_sine(r: f64) -> f64 {
    (27.0 * (r - 2.0) / r.powi(3)).sqrt()
}

/// From 10^5 M the silhouette of a spinning hole is Bardeen's curve, of the reference values, to half a pixel. Everyday
/// each curve on one tracer, by turns.
#[test]
fn spinning_shadow_is_bardeens_curve() {
    let text = std::fs::read_to_string("tests/golden/kerr_shadow.json").unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    let (size, r) = ([160_u32, 160_u32], 1e5);
    // The frame is 16 M wide.
    let fov = 2.0 * (8.0_f64 / r).atan();
    let mut judged = 0;
    for (i, (tracer, mut renderer)) in both().into_iter().enumerate() {
        for (j, case) in file["cases"].as_array().unwrap().iter().enumerate() {
            if !runs_all() && i != j % 2 {
                continue;
            }
            let (a, inclination) = (case["a"].as_f64().unwrap(), case["inclination_deg"].as_f64().unwrap());
            renderer.scene.hole.spin = a;
            renderer.scene.camera = camera(r, inclination, fov.to_degrees(), Motion::Static);
            let dark = silhouette(&mut renderer, size);
            let curve = outline(case);
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let scale = 16.0 / f64::from(size[0]);
                    let alpha = (f64::from(x) + 0.5 - f64::from(size[0]) / 2.0) * scale;
                    let beta = (f64::from(size[1]) / 2.0 - f64::from(y) - 0.5) * scale;
                    let (inside, distance) = side(&curve, alpha, beta);
                    if distance < 0.5 * scale {
                        continue;
                    }
                    judged += 1;
                    let found = dark[(y * size[0] + x) as usize];
                    assert_eq!(found, inside, "{tracer}: a {a} i {inclination}: alpha {alpha} beta {beta}");
                }
            }
        }
    }
    assert!(judged > 100_000);
}

/// The closed curve of a reference case.
fn outline(case: &Value) -> Vec<(f64, f64)> {
    let point = |p: &Value| (p["alpha"].as_f64().unwrap(), p["beta"].as_f64().unwrap());
    let upper = case["boundary"].as_array().unwrap().iter().map(point).collect::<Vec<_>>();
    let lower = upper.iter().rev().map(|&(alpha, beta)| (alpha, -beta)).collect::<Vec<_>>();
    [upper, lower].concat()
}

/// Whether a point is inside the polygon (even-odd rule), and its distance from it.
fn side(polygon: &[(f64, f64)], x: f64, y: f64) -> (bool, f64) {
    let mut inside = false;
    let mut distance = f64::INFINITY;
    for (i, &(x0, y0)) in polygon.iter().enumerate() {
        let (x1, y1) = polygon[(i + 1) % polygon.len()];
        if (y0 > y) != (y1 > y) && x < x0 + (y - y0) / (y1 - y0) * (x1 - x0) {
            inside = !inside;
        }
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = dx * dx + dy * dy;
        let t = if length == 0.0 { 0.0 } else { (((x - x0) * dx + (y - y0) * dy) / length).clamp(0.0, 1.0) };
        distance = distance.min((x - x0 - t * dx).hypot(y - y0 - t * dy));
    }
    (inside, distance)
}
