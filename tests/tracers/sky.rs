// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky in pictures: the Milky Way, the host's map and the grid on both tracers, what the lens does to them, and
//! where they are. The GPU is whatever adapter comes first; without one the tests fail.

use crate::frames::both;
use crate::random::runs_all;
use bhr::image::{ImageMut, ImageRef, Layout, PixelFormat};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, LensTables, Motion, Projection, Sky};
use bhr::sky::{CompressedMap, SkyMap, StoredMap};
use glam::{DQuat, DVec3};
use std::sync::Arc;

fn picture(renderer: &mut Renderer, format: PixelFormat, size: [u32; 2], transparent: bool) -> Vec<u8> {
    let mut pixels = vec![0; (size[0] * size[1]) as usize * format.bytes_per_pixel()];
    let mut image = ImageMut::new(Layout::packed(format, size[0], size[1]), &mut pixels).unwrap();
    renderer.render(&mut image, transparent, None, &mut |_| true).unwrap();
    pixels
}

/// Linear light.
fn light(renderer: &mut Renderer, size: [u32; 2]) -> Vec<[f32; 4]> {
    bytemuck::pod_collect_to_vec(&picture(renderer, PixelFormat::Rgba32F, size, false))
}

/// A map whose light at (x, y) of `size` is what `at` says.
fn map(size: [u32; 2], at: impl Fn(u32, u32) -> [f32; 3]) -> Arc<StoredMap> {
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    let floats = pixels.flat_map(|(x, y)| at(x, y).into_iter().chain([1.0])).collect::<Vec<f32>>();
    let layout = Layout::packed(PixelFormat::Rgba32F, size[0], size[1]);
    Arc::new(SkyMap::new(&ImageRef::new(layout, bytemuck::cast_slice(&floats)).unwrap()).unwrap().into())
}

/// Hills of every size down to texels, in three colours, with a checkerboard.
fn busy_map() -> Arc<StoredMap> {
    busy_map_of([512, 256])
}

fn busy_map_of(size: [u32; 2]) -> Arc<StoredMap> {
    map(size, |x, y| {
        let wave = |k: f32| 0.5 + 0.5 * ((x as f32 * k).sin() * (y as f32 * k * 1.3).cos());
        let check = f32::from(u8::from((x / 16 + y / 16) % 2 == 0));
        [0.4 * wave(0.05) + 0.2 * check, 0.3 * wave(0.21) + 0.2 * check, 0.5 * wave(1.3) * check]
    })
}

fn towards(ra: f64, dec: f64) -> DVec3 {
    let (ra, dec) = (ra.to_radians(), dec.to_radians());
    DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin())
}

/// Looks along `forward` from far away, the hole behind: there the sky is as it is.
fn far_from_everything(renderer: &mut Renderer, forward: DVec3, fov_degrees: f64) {
    let up = if forward.z.abs() > 0.9 { DVec3::X } else { DVec3::Z };
    renderer.scene.disk = None;
    renderer.scene.camera =
        Camera { position: forward * 1e7, forward, up, fov_y: fov_degrees.to_radians(), ..Camera::plain() };
}

fn shown(renderer: &mut Renderer, flags: u32, map: Option<&Arc<StoredMap>>) {
    renderer.scene.sky.flags = flags;
    renderer.scene.sky_map = map.cloned();
}

const ALL: u32 = Sky::STARS | Sky::MILKY_WAY | Sky::MAP | Sky::GRID;

/// Looked up and traced, near and far, spinning or not, of every part of the sky and all together; maps filtered texel
/// by texel, and by a sampler, whose weights have but 8 bits. In `tests/run all` each part alone is seen in every way,
/// else in one, because all of them together show its faults in the others; and every picture is made with and without
/// the sampler, else each in one of these ways, because samplers know nothing of rays. All together are not seen from
/// afar everyday, where the Milky Way alone is.
#[test]
fn gpu_and_cpu_pictures_agree() {
    for sampler in [false, true] {
        agree(sampler);
    }
}

/// A map in blocks shows what its texels do, on both tracers, read by the device itself and unpacked for it: of a size
/// that devices take in blocks, and of one that they do not. Where a sampler reads blocks, a map takes a quarter of the
/// memory.
#[test]
fn maps_in_blocks_are_their_texels() {
    for size in [[512, 256], [510, 254]] {
        let pack = || CompressedMap::of(busy_map_of(size).texels().unwrap()).unwrap();
        let texels = Arc::new(StoredMap::from(pack().unpacked().unwrap()));
        let blocks = Arc::new(StoredMap::from(pack()));
        for (tracer, mut renderer) in both() {
            renderer.scene.disk = None;
            let mut bytes = [[0; 2]; 2];
            for (sampler, of_sampler) in [false, true].into_iter().zip(&mut bytes) {
                renderer.scene.quality.map_sampler = Some(sampler);
                shown(&mut renderer, Sky::MAP, Some(&texels));
                let wanted = picture(&mut renderer, PixelFormat::Rgba8Srgb, [192, 108], false);
                of_sampler[0] = renderer.stats().device_bytes;
                shown(&mut renderer, Sky::MAP, Some(&blocks));
                let found = picture(&mut renderer, PixelFormat::Rgba8Srgb, [192, 108], false);
                of_sampler[1] = renderer.stats().device_bytes;
                let worst = wanted.iter().zip(&found).map(|(a, b)| a.abs_diff(*b)).max();
                // Texels hold the darker channels of a colour less exactly than blocks do.
                assert!(worst <= Some(3), "{tracer}, {size:?}, by a sampler: {sampler}: {worst:?}");
                assert!(wanted.iter().any(|code| *code > 100 && *code < 255), "{tracer}: the map is not seen");
            }
            if tracer == "gpu" {
                let saved = bytes.map(|[texels, blocks]| texels.saturating_sub(blocks));
                // A texel takes 4 bytes, in blocks 1: 3 saved, times 4 / 3 for the levels.
                let wanted = if size[0] == 512 { 512 * 256 * 4 } else { 0 };
                assert_eq!(saved[0], 0, "without a sampler: {bytes:?}");
                assert!(saved[1].abs_diff(wanted) < 100, "{size:?}: {bytes:?}");
            }
        }
    }
}

fn agree(sampler: bool) {
    let size = [192, 108];
    let busy = busy_map();
    let centre = towards(266.4, -28.9);
    let mut worst = 0;
    let mut renderers = both();
    for (way, (name, spin, r, motion, tables)) in [
        ("far", 0.0, 60.0, Motion::Static, LensTables::Always),
        ("near", 0.0, 6.0, Motion::Orbit, LensTables::Always),
        ("spinning", 0.9, 20.0, Motion::Static, LensTables::Always),
        ("traced", 0.9, 12.0, Motion::FreeFall, LensTables::Never),
    ]
    .into_iter()
    .enumerate()
    {
        for flags in [Sky::MILKY_WAY, Sky::MAP, Sky::GRID, ALL] {
            let alone_in = if flags == Sky::MILKY_WAY { "far" } else { "spinning" };
            let with_sampler = if flags == ALL { way % 2 == 1 } else { flags == Sky::MAP };
            let seen = if flags == ALL { name != "far" } else { name == alone_in };
            if !runs_all() && (sampler != with_sampler || !seen) {
                continue;
            }
            let pictures = renderers.each_mut().map(|(_, renderer)| {
                renderer.scene = Default::default();
                renderer.scene.hole.spin = spin;
                renderer.scene.quality.lens_tables = tables;
                renderer.scene.quality.map_sampler = Some(sampler);
                let position = if motion == Motion::Orbit { DVec3::X * r } else { -centre * r };
                renderer.scene.camera = Camera { position, forward: centre, fov_y: 1.2, motion, ..Camera::plain() };
                shown(renderer, flags, Some(&busy));
                renderer.scene.film.exposure_ev = if flags == Sky::MILKY_WAY { 3.0 } else { 0.0 };
                picture(renderer, PixelFormat::Rgba8Srgb, size, false)
            });
            let pixels = pictures[0].chunks_exact(4).zip(pictures[1].chunks_exact(4));
            let differ = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
            let steps = pictures[0].iter().zip(&pictures[1]).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            println!("{name}, flags {flags}, sampler {sampler}: {differ} pixels differ by more than one step, {steps}");
            worst = worst.max(differ);
            let lit = pictures[0].chunks_exact(4).filter(|p| p[0].max(p[1]).max(p[2]) > 20).count();
            assert!(lit > 200, "{name}, flags {flags}: {lit} pixels have light");
        }
    }
    // The weights of a GPU's sampler have 8 bits, between levels, too: that shows where dark texels lie beside bright
    // ones. Software samplers have more.
    let least_share = if sampler { 250 } else { 1000 };
    assert!(worst * least_share <= (size[0] * size[1]) as usize, "{worst} pixels differ");
}

/// A map of one colour is that colour wherever the light of it arrives as it left.
#[test]
fn flat_maps_are_flat() {
    let value = [0.25, 0.5, 0.125];
    let flat = map([64, 32], |_, _| value);
    for (tracer, mut renderer) in both() {
        for forward in [DVec3::X, DVec3::Z, towards(180.0, 1.0)] {
            far_from_everything(&mut renderer, forward, 60.0);
            shown(&mut renderer, Sky::MAP, Some(&flat));
            for rgba in light(&mut renderer, [64, 36]) {
                assert!((0..3).all(|c| (rgba[c] / value[c] - 1.0).abs() < 1e-5), "{tracer} {forward}: {rgba:?}");
            }
            renderer.scene.sky.map_brightness = 3.0;
            let pixel = light(&mut renderer, [8, 8])[0];
            assert!((pixel[1] / 1.5 - 1.0).abs() < 1e-5, "{tracer}: {pixel:?}");
            renderer.scene.sky.map_brightness = 1.0;
        }
        // Without a map, and hidden by TRANSPARENT, there is none.
        shown(&mut renderer, Sky::MAP, None);
        assert!(light(&mut renderer, [8, 8]).iter().all(|p| p[..3] == [0.0; 3]), "{tracer}");
        shown(&mut renderer, ALL, Some(&flat));
        let clear = picture(&mut renderer, PixelFormat::Rgba8Srgb, [8, 8], true);
        assert!(clear.iter().all(|byte| *byte == 0), "{tracer}");
    }
}

/// The lens moves the light of a map about, but makes none brighter: around the hole radiance is that of the map.
#[test]
fn lensed_radiance_is_that_of_the_map() {
    let flat = map([64, 32], |_, _| [0.5; 3]);
    for (tracer, mut renderer) in both() {
        renderer.scene.disk = None;
        renderer.scene.camera.fov_y = 0.9;
        renderer.scene.effects.0 = 0;
        // At the shadow's edge a pixel's mean is darker.
        renderer.scene.quality.refines = false;
        for spin in [0.0, 0.9] {
            renderer.scene.hole.spin = spin;
            shown(&mut renderer, Sky::MAP, Some(&flat));
            let pixels = light(&mut renderer, [160, 90]);
            let seen = pixels.iter().filter(|p| p[1] > 0.0).count();
            assert!(seen > 10_000 && seen < pixels.len(), "{tracer}: {seen} pixels see the sky");
            let off = pixels.iter().filter(|p| p[1] > 0.0 && (p[1] - 0.5).abs() > 1e-5).count();
            assert_eq!(off, 0, "{tracer} spin {spin}: without effects all of the sky is as bright");
        }
    }
}

/// A spot of the map is where the documented formula and the orientation put it, as large as it is, and right of what
/// has more right ascension.
#[test]
fn the_orientation_turns_the_map_as_documented() {
    // One bright texel in a dark map, at right ascension 90 and declination 30.
    let spot = map([360, 180], |x, y| [f32::from(u8::from((88..92).contains(&x) && (58..62).contains(&y))); 3]);
    let place = towards(90.0, 30.0);
    for (tracer, mut renderer) in both() {
        shown(&mut renderer, Sky::MAP, Some(&spot));
        let turns = [
            DQuat::IDENTITY,
            DQuat::from_rotation_z(1.0),
            DQuat::from_rotation_x(-0.7) * DQuat::from_rotation_y(2.0),
            -DQuat::from_rotation_y(0.3),
        ];
        for turn in turns {
            renderer.scene.sky.orientation = turn;
            // Sky axes to scene axes.
            far_from_everything(&mut renderer, turn * place, 10.0);
            let pixels = light(&mut renderer, [33, 33]);
            assert!(pixels[16 * 33 + 16][1] > 0.5, "{tracer} {turn}: {:?}", pixels[16 * 33 + 16]);
            let lit = pixels.iter().map(|p| p[1]).sum::<f32>();
            // 16 square degrees of 100, narrower by the cosine of the declination, on a plane.
            let share = lit / (33.0 * 33.0);
            assert!((share - 0.16 * 0.866).abs() < 0.01, "{tracer} {turn}: {share}");
        }
        // Seen from inside with north up, right ascension grows to the left, as in the picture.
        renderer.scene.sky.orientation = DQuat::IDENTITY;
        far_from_everything(&mut renderer, towards(88.0, 30.0), 10.0);
        let pixels = light(&mut renderer, [33, 33]);
        let (left, right): (Vec<_>, Vec<_>) = (0..pixels.len()).partition(|i| i % 33 < 16);
        let sum = |side: Vec<usize>| side.iter().map(|i| pixels[*i][1]).sum::<f32>();
        assert!(sum(left) > 3.0 * sum(right), "{tracer}: the spot is on the right");
    }
}

/// Smooth maps show no line where their sides meet and no star at their poles, at any zoom.
#[test]
fn seams_and_poles_do_not_show() {
    // Smooth on the sphere, and steep nowhere: but its texels at the poles differ by longitude.
    let smooth = map([128, 64], |x, y| {
        let (ra, dec) = (360.0 * (0.5 - (x as f64 + 0.5) / 128.0), 180.0 * (0.5 - (y as f64 + 0.5) / 64.0));
        let d = towards(ra, dec);
        [0.5 + 0.4 * d.x, 0.5 + 0.4 * d.y, 0.5 + 0.4 * d.z].map(|v| v as f32)
    });
    let size = [160, 90];
    for (tracer, mut renderer) in both() {
        shown(&mut renderer, Sky::MAP, Some(&smooth));
        for forward in [DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z, towards(180.0, 89.0), towards(-179.9, 40.0)] {
            for fov in [90.0, 10.0, 1.0] {
                far_from_everything(&mut renderer, forward, fov);
                let pixels = light(&mut renderer, size);
                // Texels are 2.8 degrees high and hold what changes by 0.02 in them, in steps of 1 / 512.
                let pixel = fov.to_radians() / 90.0;
                let limit = (4.0 * 0.4 * pixel) as f32 + 0.0045 * (pixel / 0.049).min(1.0) as f32 + 1e-4;
                for (i, p) in pixels.iter().enumerate() {
                    for next in [i + 1, i + size[0] as usize] {
                        if (i + 1) % size[0] as usize == 0 || next >= pixels.len() {
                            continue;
                        }
                        let step = (0..3).map(|c| (p[c] - pixels[next][c]).abs()).fold(0.0, f32::max);
                        assert!(step < limit, "{tracer} {forward} {fov}: {step} at {i}, limit {limit}");
                    }
                }
            }
        }
    }
}

/// Across a meridian and a parallel: the light of the line, over black, in pixels of full lines.
#[test]
fn grid_lines_have_their_width_on_screen() {
    let size = [201, 201];
    for (tracer, mut renderer) in both() {
        shown(&mut renderer, Sky::GRID, None);
        let mut widths = Vec::new();
        for (fov, forward) in [(20.0, towards(30.0, 7.0)), (2.0, towards(45.0, 52.0)), (6.0, towards(120.0, -62.0))] {
            far_from_everything(&mut renderer, forward, fov);
            let pixels = light(&mut renderer, size);
            let brightest = pixels.iter().map(|p| p[2]).fold(0.0, f32::max);
            // Rows between parallels: the meridian in the middle.
            let row =
                (0..size[1] as usize).find(|y| pixels[y * 201][2] == 0.0 && pixels[y * 201 + 40][2] == 0.0).unwrap();
            let sum = pixels[row * 201 + 60..row * 201 + 140].iter().map(|p| p[2]).sum::<f32>() / brightest;
            widths.push(sum);
        }
        println!("{tracer}: {widths:?}");
        assert!(widths.iter().all(|w| (w - 1.3).abs() < 0.02), "{tracer}: {widths:?}");
        // Over white light, the line is as bright: laid over, not added.
        let white = map([8, 4], |_, _| [4.0; 3]);
        shown(&mut renderer, Sky::GRID | Sky::MAP, Some(&white));
        let on_line = light(&mut renderer, size)[100 * 201 + 100];
        assert!(on_line[1] < 0.3, "{tracer}: {on_line:?}");
    }
}

/// A map is exchanged, removed and set again; pictures follow it, and the device's memory.
#[test]
fn maps_come_and_go() {
    let [_, (_, mut renderer)] = both();
    far_from_everything(&mut renderer, DVec3::X, 60.0);
    for sampler in [false, true] {
        renderer.scene.quality.map_sampler = Some(sampler);
        come_and_go(&mut renderer, sampler);
    }
}

fn come_and_go(renderer: &mut Renderer, sampler: bool) {
    let sizes = [[512, 256], [1024, 512]];
    let [small, large] = sizes.map(|size| map(size, |x, _| [x as f32 / size[0] as f32; 3]));
    let mut show = |map: Option<&Arc<StoredMap>>| {
        shown(renderer, Sky::MAP, map);
        let sum = light(renderer, [32, 18]).iter().map(|p| p[1]).sum::<f32>();
        (sum, renderer.stats().device_bytes)
    };
    // The first frame of a renderer leaves some buffers to the second.
    show(None);
    let (dark, without) = show(None);
    let (bright, with_small) = show(Some(&small));
    let (_, with_large) = show(Some(&large));
    let (again, back) = show(Some(&small));
    let (black, none) = show(None);
    assert!(dark == 0.0 && black == 0.0 && bright > 1.0 && bright == again, "{dark} {bright} {again} {black}");
    // Four bytes a texel; the coarser levels side by side take half as much again, as levels of the texture a third.
    let levels =
        |[w, h]: [u32; 2]| (0..=w.ilog2()).map(move |level| ((w >> level).max(1) * (h >> level).max(1)) as u64);
    let bytes = |[w, h]: [u32; 2]| if sampler { 4 * levels([w, h]).sum::<u64>() } else { u64::from(w * h * 6) };
    assert_eq!([with_small - without, with_large - without], sizes.map(bytes));
    assert_eq!([back, none], [with_small, without]);
}

/// Over the six sides of a cube, far from the hole, where every direction is seen once: the mean of a busy map.
#[test]
fn the_mean_is_kept() {
    let busy = busy_map();
    let mean = busy.texels().unwrap().light(DVec3::X, DVec3::splat(1e30), DVec3::splat(1e30));
    for (tracer, mut renderer) in both() {
        shown(&mut renderer, Sky::MAP, Some(&busy));
        renderer.scene.quality.lens_tables = LensTables::Never;
        let mut sum = [0.0_f64; 3];
        // The six sides of a cube, weighted by solid angle.
        let side = 48;
        for (forward, up) in [
            (DVec3::X, DVec3::Z),
            (DVec3::NEG_X, DVec3::Z),
            (DVec3::Y, DVec3::Z),
            (DVec3::NEG_Y, DVec3::Z),
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Z, DVec3::X),
        ] {
            renderer.scene.disk = None;
            let position = DVec3::new(1e7, 2e7, 3e7);
            renderer.scene.camera = Camera {
                projection: Projection::Perspective,
                position,
                forward,
                up,
                fov_y: 90_f64.to_radians(),
                ..Camera::plain()
            };
            let pixels = light(&mut renderer, [side, side]);
            for (i, p) in (0..).zip(&pixels) {
                let place = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(side) - 1.0;
                let (x, y) = (place(i % side), place(i / side));
                let solid_angle = 4.0 / f64::from(side * side) / (1.0 + x * x + y * y).powf(1.5);
                (0..3).for_each(|c| sum[c] += f64::from(p[c]) * solid_angle / (4.0 * std::f64::consts::PI));
            }
        }
        println!("{tracer}: {sum:?} of {mean:?}");
        assert!((0..3).all(|c| (sum[c] / mean[c] - 1.0).abs() < 0.01), "{tracer}: {sum:?} of {mean:?}");
    }
}
