// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth at half resolution, on both tracers: within its bound of full resolution, the same on both, and
//! the same bytes whole or in parts.

use crate::frames::{Lent, both, cpu, differing, floats, gpu, picture, tiled};
use crate::random::runs_all;
use crate::volumes::one_of_each;
use bhr::image::PixelFormat;
use bhr::scene::{
    Camera, Disk, HotSpot, LensTables, Motion, Projection, Region, Scene, Sky, View, Volume, VolumeResolution,
};
use glam::DVec3;

fn outside(distance: f64, elevation: f64, tan: f64) -> Camera {
    let elevation = elevation.to_radians();
    let position = distance * DVec3::new(elevation.cos(), 0.0, elevation.sin());
    Camera { position, forward: -position, up: DVec3::Z, fov_y: 2.0 * tan.atan(), ..Camera::plain() }
}

/// Scenes of every shape, with edges of other things in front of and behind the matter, and of every projection.
fn scenes() -> Vec<(&'static str, Scene)> {
    let of = |volumes: &[Volume], spin: f64, camera: Camera| {
        let mut scene = Scene { disk: None, volumes: volumes.iter().copied().collect(), camera, ..Scene::plain() };
        scene.hole.spin = spin;
        scene
    };
    let [disk, torus, halo, jet] = one_of_each(0.0);
    let beside_disk = Scene {
        disk: Some(Disk { opacity: 0.8, turbulence: 0.5, ..Disk::plain() }),
        ..of(&[halo], 0.9, outside(25.0, 20.0, 0.4))
    };
    let mut spots = of(&[], 0.5, outside(25.0, 20.0, 0.45));
    spots.hot_spots.push(HotSpot { azimuth: 0.3, ..HotSpot::default() });
    spots.hot_spots.push(HotSpot {
        azimuth: 2.5,
        radius: 5.0,
        size: 0.5,
        thermal: true,
        absorption: 2.0,
        ..HotSpot::default()
    });
    spots.time = 33.0;
    let mut within = of(&[Volume { infall: 0.3, sub_keplerian: 0.8, ..torus }], -0.7, outside(8.0, 5.0, 0.4));
    within.camera.projection = Projection::Equirect;
    let mut round = of(&[disk], 0.6, outside(20.0, 25.0, 0.4));
    (round.camera.projection, round.camera.fov_y) = (Projection::Fisheye, 1.8);
    vec![
        ("soft disk", of(&[disk], 0.6, outside(28.0, 6.5, 0.34))),
        ("torus", of(&[torus], 0.9, outside(30.0, 10.0, 0.36))),
        ("halo beside a thin disk", beside_disk),
        ("jet", of(&[jet], 0.9, outside(40.0, 20.0, 0.4))),
        ("spots", spots),
        ("within the torus", within),
        ("fisheye", round),
        ("turbulent torus", of(&[Volume { turbulence: 1.0, ..torus }], 0.9, outside(30.0, 10.0, 0.36))),
    ]
}

fn half(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.quality.volume_resolution = VolumeResolution::Half;
    scene
}

/// The rule's tolerance, and light that need not be told exactly (`emit::half`).
const TOLERANCE: f32 = 1.0 / 64.0;
const LEAST_LIGHT: f32 = 0.004;

/// How far pixels are off, relative to their brightest component; sorted.
fn errors(exact: &[f32], found: &[f32]) -> Vec<f32> {
    let pairs = exact.as_chunks::<4>().0.iter().zip(found.as_chunks::<4>().0);
    let mut errors = pairs
        .map(|(a, b)| {
            let brightest = a[0].max(a[1]).max(a[2]);
            let light = (0..3).map(|c| (a[c] - b[c]).abs() / (brightest + LEAST_LIGHT)).fold(0.0, f32::max);
            light.max((a[3] - b[3]).abs())
        })
        .collect::<Vec<_>>();
    errors.sort_by(f32::total_cmp);
    errors
}

/// Without a sky, whose stars would hide them, errors are within the tolerance, and nearly all far within it. In so
/// small a picture structure is finer than a block: the rule allows four times as much there, and finds it less surely.
#[test]
#[ignore = "in tests/run all; everyday: pictures at half resolution are those at full"]
fn half_is_as_full_within_its_bound() {
    let mut renderer = cpu();
    // The bounds hold at this size: everyday in the middle of it, where the matter is. `the_tracers_agree` holds more
    // scenes to them in 8 bits.
    let [full_width, full_height] = [320, 180];
    let middle = Region { full_width, full_height, x: 120, y: 70 };
    let (size, region) = if runs_all() { ([full_width, full_height], None) } else { ([80, 40], Some(middle)) };
    let everyday = ["halo beside a thin disk", "turbulent torus"];
    for (name, scene) in scenes().into_iter().filter(|(name, _)| runs_all() || everyday.contains(name)) {
        let bare = Scene { sky: Sky::black(), ..scene };
        let [full, found] = [bare.clone(), half(&bare)].map(|scene| {
            renderer.scene = scene;
            floats(&picture(&mut renderer, PixelFormat::Rgba32F, size, region, true))
        });
        let errors = errors(&full, &found);
        let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
        let [most, nearly_all, many] = [1.0, 0.999, 0.9].map(at);
        println!("{name}: 90 % within {many:.5}, 99.9 % within {nearly_all:.5}, all within {most:.5}");
        assert!(most > 0.0, "{name} is not at half resolution");
        let bounds = if name.starts_with("turbulent") { [32.0, 16.0, 4.0] } else { [1.0, 0.5, 0.1] };
        let [all, all_but_few, most_of_them] = bounds.map(|bound| bound * TOLERANCE);
        assert!(most <= all && nearly_all <= all_but_few && many <= most_of_them, "{name}");
    }
}

/// In 8 bits one tracer is as the other at half resolution, and both are as they are at full resolution, but for
/// structure, which may be finer than a block. Everyday in the middle of the frame, where the matter is, beside a disk
/// and with structure: blocks know nothing of shapes.
#[test]
fn the_tracers_agree() {
    let (mut cpu, mut gpu) = (cpu(), gpu());
    let everyday = ["halo beside a thin disk", "turbulent torus"];
    for (name, scene) in scenes().into_iter().filter(|(name, _)| runs_all() || everyday.contains(name)) {
        let [full_width, full_height] = [160, 90];
        let middle = Region { full_width, full_height, x: 40, y: 30 };
        let (size, region) = if runs_all() { ([full_width, full_height], None) } else { ([80, 30], Some(middle)) };
        let shown = |renderer: &mut Lent, scene: Scene| {
            renderer.scene = scene;
            picture(renderer, PixelFormat::Rgba8Srgb, size, region, false)
        };
        let full = shown(&mut cpu, scene.clone());
        let [a, b] = [&mut cpu, &mut gpu].map(|renderer| shown(renderer, half(&scene)));
        for (what, one, other) in [("the tracers", &a, &b), ("the CPU's", &full, &a), ("the GPU's", &full, &b)] {
            let far = one.iter().zip(other).filter(|(one, other)| one.abs_diff(**other) > 2).count();
            println!("{name}, {what}: {far} of {}", one.len());
            let coarse = name.starts_with("turbulent") && what != "the tracers";
            // Outside the middle there are few pixels that differ.
            let share = if runs_all() { 1000 } else { 500 };
            let most = if coarse { one.len() / 25 } else { one.len() / share };
            assert!(far <= most, "{name}, {what}: {far} of {}", one.len());
        }
    }
}

/// Where nothing shines in the plane, pixels look up what is behind the matter of the blocks: as they trace it, without
/// and with spin, in pictures of several samples, in frames with a border, in views, and in parts with the bytes of the
/// whole.
#[test]
#[ignore = "in tests/run all; everyday: the tracers agree at half resolution"]
fn the_sky_behind_blocks_is_looked_up() {
    let mut gpu = gpu();
    let named = |name: &str| scenes().into_iter().find(|(found, _)| *found == name).expect("a scene").1;
    let mut still = named("soft disk");
    (still.hole.spin, still.quality.samples_per_pixel) = (0.0, 2);
    let depth = Scene { view: View::OpticalDepth, ..named("torus") };
    let mut cube = named("soft disk");
    (cube.camera, cube.sky) = (outside(9.0, 20.0, 0.4), Sky::black());
    cube.camera.projection = Projection::Cube;
    let mut falling = named("soft disk");
    (falling.hole.spin, falling.camera.motion) = (0.0, Motion::FreeFall);
    let all = [
        ("hot spots", named("spots")),
        ("a cube", cube),
        ("a falling camera", falling),
        ("without spin, two samples", still),
        ("a fisheye", named("fisheye")),
        ("structure", named("turbulent torus")),
        ("a transparent picture", named("turbulent torus")),
        ("optical depth", depth),
    ];
    for (name, scene) in all {
        let size = if name == "a cube" { [240, 40] } else { [160, 90] };
        let [traced, looked_up] = [LensTables::Never, LensTables::Always].map(|tables| {
            gpu.scene = half(&scene);
            gpu.scene.quality.lens_tables = tables;
            let found = picture(&mut gpu, PixelFormat::Rgba8Srgb, size, None, name == "a transparent picture");
            (found, gpu.stats().steps)
        });
        assert!(looked_up.1 < traced.1 / 4, "{name}: {} steps of {}", looked_up.1, traced.1);
        let far = traced.0.iter().zip(&looked_up.0).filter(|(one, other)| one.abs_diff(**other) > 2).count();
        println!("{name}: {far} of {}, {} steps of {}", traced.0.len(), looked_up.1, traced.1);
        assert!(far <= traced.0.len() / 500, "{name}: {far} of {}", traced.0.len());
        let whole = picture(&mut gpu, PixelFormat::Rgba8Srgb, size, None, false);
        assert!(whole == tiled(&mut gpu, PixelFormat::Rgba8Srgb, size), "{name}: parts");
    }
}

/// I_nu and optical depth are told within the tolerance as well, by both tracers. Everyday by one tracer for each
/// shape and view, because they are told of the same sums.
#[test]
#[ignore = "in tests/run all; everyday: pictures at half resolution, views at full"]
fn views_are_within_the_bound() {
    for (i, (tracer, mut renderer)) in both().into_iter().enumerate() {
        for (j, (name, scene)) in scenes().into_iter().take(4).enumerate() {
            for (k, view) in [View::OpticalDepth, View::Intensity].into_iter().enumerate() {
                if !runs_all() && (i + j + k) % 2 == 1 {
                    continue;
                }
                let scene = Scene { view, ..scene.clone() };
                let [full, found] = [scene.clone(), half(&scene)].map(|scene| {
                    renderer.scene = scene;
                    floats(&picture(&mut renderer, PixelFormat::R32F, [96, 54], None, false))
                });
                let off = |a: f32, b: f32| (a - b).abs() > TOLERANCE * (a + 1e-3);
                let far = full.iter().zip(&found).filter(|(a, b)| a.is_nan() != b.is_nan() || off(**a, **b)).count();
                println!("{tracer}, {name}, {view:?}: {far} of {}", full.len());
                assert!(far <= full.len() / 500, "{tracer}, {name}, {view:?}: {far} of {}", full.len());
            }
        }
    }
}

/// Blocks are counted from the frame's corner: parts of it, and frames after other frames, have the same bytes. So have
/// frames without matter, whatever its resolution. Everyday one scene with samples, one with things before the matter
/// and one of another projection, because blocks know nothing of shapes; and one of them again, because each part is a
/// frame after others.
#[test]
#[ignore = "in tests/run all; everyday: parts of frames at full resolution"]
fn parts_have_the_bytes_of_the_whole() {
    let size = if runs_all() { [101, 67] } else { [51, 35] };
    for (tracer, mut renderer) in both() {
        let everyday = ["torus", "halo beside a thin disk", "fisheye"];
        for (name, scene) in scenes().into_iter().filter(|(name, _)| runs_all() || everyday.contains(name)) {
            let mut scene = half(&scene);
            if name == "torus" {
                scene.quality.samples_per_pixel = 3;
            }
            renderer.scene = scene;
            let whole = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false);
            assert!(whole == tiled(&mut renderer, PixelFormat::Rgba8Srgb, size), "{tracer}, {name}: parts");
            if runs_all() || name == "fisheye" {
                let again = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false);
                assert!(whole == again, "{tracer}, {name}: again");
            }
        }
        let empty = Scene { disk: Some(Disk::plain()), ..Scene::plain() };
        let [full, found] = [empty.clone(), half(&empty)].map(|scene| {
            renderer.scene = scene;
            picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, false)
        });
        assert!(full == found, "{tracer}: a scene without matter");
    }
}

/// A frame in which some thousand pixels are listed for rays of their own, several for each thread of a software
/// driver: the next one has the same bytes, at half resolution as at full, and both are alike.
#[test]
#[ignore = "in tests/run all; everyday: the tracers agree at half resolution"]
fn long_lists_are_seen_through() {
    let mut gpu = gpu();
    let (_, scene) = scenes().remove(1);
    let size = if runs_all() { [640, 360] } else { [448, 252] };
    let frames = [scene.clone(), half(&scene)].map(|scene| {
        gpu.scene = scene;
        let [first, next] = [(); 2].map(|()| picture(&mut gpu, PixelFormat::Rgba8Srgb, size, None, false));
        assert!(first == next, "two frames of one scene differ by {} pixels", differing(&first, &next));
        first
    });
    let far = frames[0].iter().zip(&frames[1]).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(far <= frames[0].len() / 50_000, "{far} of {}", frames[0].len());
}

/// Every face of a cube has blocks of its own, also where its side is odd.
#[test]
#[ignore = "in tests/run all; everyday: faces of cubes at full resolution, perspective frames at half"]
fn faces_of_a_cube_are_apart() {
    for (tracer, mut renderer) in both() {
        let (_, mut scene) = scenes().remove(0);
        scene.camera = outside(9.0, 20.0, 0.4);
        scene.camera.projection = Projection::Cube;
        scene.sky = Sky::black();
        for side in [40, 45] {
            let [full, found] = [scene.clone(), half(&scene)].map(|scene| {
                renderer.scene = scene;
                floats(&picture(&mut renderer, PixelFormat::Rgba32F, [6 * side, side], None, false))
            });
            let errors = errors(&full, &found);
            let nearly_all = errors[(errors.len() - 1) * 998 / 1000];
            println!("{tracer}, {side}: 99.8 % within {nearly_all}, all within {}", errors[errors.len() - 1]);
            assert!(nearly_all <= TOLERANCE, "{tracer}, {side}: {nearly_all}");
        }
    }
}
