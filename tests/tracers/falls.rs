// SPDX-License-Identifier: MIT OR Apache-2.0
//! A whole fall into a spinning hole, frame by frame, and cameras anywhere inside such holes.

use crate::frames::{both, floats, picture};
use crate::random::{Random, count_from, runs_all};
use bhr::image::PixelFormat;
use bhr::scene::{Camera, Chart, Disk, Effects, HotSpot, LensTables, Motion, Projection, Scene, Sky, Volume};
use glam::DVec3;

/// A film of 240 frames from r = 10 M through r+ to just above r-: the second differences in time of the pixels' light
/// are no larger where the film passes r = 3 M or r+ than beside.
#[test]
#[ignore = "in tests/run all; everyday: ten frames about each seam (inside::a_fall_has_no_seam)"]
fn a_fall_of_240_frames_is_one_film() {
    const FRAMES: usize = 240;
    const SIZE: [u32; 2] = [320, 180];
    let spin = 0.9_f64;
    let root = (1.0 - spin * spin).sqrt();
    let ways = [LensTables::Never, LensTables::Always];
    for (tables, (tracer, mut renderer)) in ways.into_iter().flat_map(|tables| both().map(|one| (tables, one))) {
        renderer.scene = Scene::plain();
        let scene = &mut renderer.scene;
        (scene.hole.spin, scene.sky, scene.time) = (spin, Sky::black(), 1e3);
        let position = DVec3::new(8.6, 4.0, 3.2);
        scene.camera = Camera {
            position,
            forward: -position + DVec3::new(-1.0, 3.0, 0.0),
            up: DVec3::Z,
            fov_y: 1.6,
            motion: Motion::FreeFall,
            chart: Chart::Rain,
            ..Camera::plain()
        };
        let turbulence = if tables == LensTables::Always { 1.0 } else { 0.0 };
        scene.disk = Some(Disk { turbulence, outer_radius: 20.0, ..Disk::plain() });
        (scene.quality.refines, scene.quality.lens_tables) = (false, tables);
        // Proper time from rest at infinity goes as r^(3/2) or so; the film is slower where the fall is faster.
        let (mut frames, mut jolts, mut radii) = (Vec::<Vec<f32>>::new(), Vec::new(), Vec::new());
        for _ in 0..FRAMES {
            let r = renderer.scene.camera.position.length();
            radii.push(r);
            frames.push(floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, false)));
            if frames.len() == 3 {
                let light = frames[1].iter().map(|v| f64::from(*v)).sum::<f64>();
                let bends = (0..frames[0].len()).map(|i| (frames[0][i] - 2.0 * frames[1][i] + frames[2][i]).abs());
                jolts.push(bends.map(f64::from).sum::<f64>() / light);
                frames.remove(0);
            }
            let step = 0.0175 * (r - (1.0 - root)).max(0.01) * r.sqrt();
            let scene = &mut renderer.scene;
            let (after, passed) = scene.advance_camera(&scene.camera, step).unwrap();
            (scene.camera, scene.time) = (after, scene.time + passed);
        }
        let end = radii[FRAMES - 1] - (1.0 - root);
        assert!((0.0..0.2).contains(&end), "{tracer}, {tables:?}: the film ends {end} M above the inner horizon");
        for seam in [3.0, 1.0 + root] {
            let at = radii.iter().position(|r| *r < seam).expect("the film passes it");
            let around = |low: usize, high: usize| jolts[low..high].iter().copied().fold(0.0, f64::max);
            // jolts[k] is that of the frames k, k + 1 and k + 2.
            let (here, beside) = (around(at - 2, at), around(at - 12, at - 4).max(around(at + 2, at + 10)));
            println!("{tracer}, {tables:?}: at r = {seam} jolts {here:.1e}, beside it {beside:.1e}");
            assert!(here <= 1.2 * beside, "{tracer}, {tables:?}, r = {seam}: {here:e}, beside {beside:e}: {jolts:?}");
        }
    }
}

/// Whatever a camera inside does and looks at, frames end and hold numbers.
#[test]
fn random_cameras_inside_give_numbers() {
    // Each combination of these needs kernels of its own, which lavapipe takes longer to compile than to render such
    // frames with: everyday runs have these three, tests/run all mixes them freely.
    let looks = [
        (Projection::Perspective, 0, true, false),
        (Projection::Equirect, Effects::ALL, true, true),
        (Projection::Fisheye, 3, false, false),
    ];
    for (name, mut renderer) in both() {
        let mut random = Random(20_261_128);
        let mut lit = 0;
        let count = count_from("BHR_TEST_CAMERAS_INSIDE", 8, 100_000);
        for i in 0..count {
            let [a, b, c, d] = [0; 4].map(|_| if runs_all() { random.pick(&looks) } else { looks[i % looks.len()] });
            let (projection, effects, has_disk, has_matter) = (a.0, b.1, c.2, d.3);
            let spin: f64 = random.pick(&[0.0, 1e-3, 0.3, -0.7, 0.9, 0.9999, -0.9999]) * random.pick(&[1.0, 1.0, 0.99]);
            let root = (1.0 - spin * spin).sqrt();
            let inner = (1.0 - root).max(1e-3) * (1.0 + 3e-6);
            let r = inner + (1.05 * (1.0 + root) - inner) * random.range(0.0, 1.0).powi(2);
            let mut scene = Scene::plain();
            scene.hole.spin = spin;
            scene.time = random.range(-1e4, 1e4);
            scene.effects = Effects(effects);
            scene.camera = Camera {
                position: random.direction() * r,
                forward: random.direction(),
                up: random.direction(),
                fov_y: random.range(0.2, 2.5),
                motion: random.pick(&[Motion::FreeFall, Motion::Velocity]),
                velocity: random.direction() * random.range(0.0, 0.999),
                projection,
                chart: Chart::Rain,
                ..Camera::plain()
            };
            scene.disk = has_disk.then(|| Disk { plunges: i % 2 == 0, ..Disk::plain() });
            if has_matter {
                scene.volumes.push(Volume::default());
                scene.hot_spots.push(HotSpot::default());
            }
            // Everyday the cameras without a disk look their rays up in tables.
            let tables = if runs_all() { random.pick(&[0, 1, 2]) } else { i % looks.len() };
            scene.quality.lens_tables = if tables == 2 { LensTables::Always } else { LensTables::Never };
            renderer.scene = scene;
            let side = if runs_all() { 4 } else { 8 };
            let pixels = floats(&picture(&mut renderer, PixelFormat::Rgba32F, [side, side], None, false));
            let good = pixels.iter().all(|v| v.is_finite() && *v >= 0.0);
            assert!(good, "{name}: {pixels:?} of {:?}", renderer.scene);
            lit += usize::from(pixels.as_chunks::<4>().0.iter().any(|p| p[0] > 0.0));
        }
        println!("{name}: {lit} of {count} frames have light");
        assert!(lit > count / 3, "{name}: {lit} of {count}");
    }
}
