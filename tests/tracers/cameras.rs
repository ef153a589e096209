// SPDX-License-Identifier: MIT OR Apache-2.0
//! Projections: the faces of the cube against perspective views, fisheye and equirectangular frames against
//! perspective ones that look the same way, the GPU's pictures against the CPU's, tiles against the whole, and what
//! lies outside a fisheye's circle.

use crate::frames::{both, differing, floats, picture, tiled};
use crate::random::runs_all;
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, LensTables, Projection, Ray, Region, Scene, Sky, View};
use bhr::sky::catalogue;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Spins and how their rays are found.
const WAYS: [(f64, LensTables); 4] =
    [(0.0, LensTables::Always), (0.0, LensTables::Never), (0.9, LensTables::Always), (0.9, LensTables::Never)];

/// One of them with spin, one without: of what they have little part in. (A kernel takes lavapipe half a second to
/// compile.)
const TWO_WAYS: [(f64, LensTables); 2] = [WAYS[1], WAYS[2]];

/// All of them in `tests/run all`, else two.
fn ways() -> &'static [(f64, LensTables)] {
    if runs_all() { &WAYS } else { &TWO_WAYS }
}

/// A camera that has the hole beside, not before it, its axes no axes of the scene.
fn camera(projection: Projection) -> Camera {
    Camera {
        projection,
        position: DVec3::new(9.0, -4.0, 3.0),
        forward: DVec3::new(-0.6, 0.9, -0.4),
        up: DVec3::new(0.2, -0.3, 0.9),
        fov_y: 1.25 * PI,
        ..Camera::plain()
    }
}

/// Projections, with a small frame for each.
const PROJECTIONS: [(Projection, [u32; 2]); 4] = [
    (Projection::Perspective, [108, 60]),
    (Projection::Fisheye, [108, 84]),
    (Projection::Equirect, [144, 72]),
    (Projection::Cube, [252, 42]),
];

fn set(renderer: &mut Renderer, projection: Projection, (spin, tables): (f64, LensTables)) {
    renderer.scene = Scene::plain();
    renderer.scene.camera = camera(projection);
    // Stars are the part of the sky with the smallest detail.
    renderer.scene.sky.flags = Sky::STARS;
    if projection == Projection::Perspective {
        renderer.scene.camera.fov_y = 2.0;
    }
    renderer.scene.hole.spin = spin;
    renderer.scene.quality.lens_tables = tables;
}

/// Forward and up of the faces, in the order of the frame, for the camera's axes (right, up, forward).
fn faces(axes: DMat3) -> [(DVec3, DVec3); 6] {
    let [right, up, forward] = [axes.x_axis, axes.y_axis, axes.z_axis];
    [(right, up), (-right, up), (up, -forward), (-up, forward), (forward, up), (-forward, up)]
}

/// The `i`th face of a frame of six, each `side` pixels wide; `words` floats to a pixel.
fn face(frame: &[f32], i: usize, side: usize, words: usize) -> Vec<f32> {
    let rows = frame.chunks_exact(6 * side * words);
    rows.flat_map(|row| &row[i * side * words..][..side * words]).copied().collect()
}

fn close(a: f32, b: f32, relative: f32) -> bool {
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= relative * (1.0 + a.abs().max(b.abs()))
}

#[test]
fn faces_of_the_cube_are_perspective_views() {
    const SIDE: u32 = 40;
    let side = SIDE as usize;
    for (tracer, mut renderer) in both() {
        for (i, &way) in ways().iter().enumerate() {
            for (j, view) in [View::Light, View::Deflection, View::Redshift, View::Order].into_iter().enumerate() {
                // Everyday each view in one way: views know nothing of how rays are found.
                if !runs_all() && i != j % 2 {
                    continue;
                }
                let format = if view == View::Light { PixelFormat::Rgba32F } else { PixelFormat::R32F };
                let words = format.bytes_per_pixel() / 4;
                set(&mut renderer, Projection::Cube, way);
                renderer.scene.view = view;
                let cube = floats(&picture(&mut renderer, format, [6 * SIDE, SIDE], None, false));
                assert!(cube.iter().any(|v| *v != cube[0]), "{view:?} is empty");
                let sides = faces(renderer.scene.camera.axes().unwrap());
                let mut wrong = 0;
                for (side_index, (forward, up)) in sides.into_iter().enumerate() {
                    let straight = Camera { forward, up, fov_y: FRAC_PI_2, ..camera(Projection::Perspective) };
                    renderer.scene.camera = straight;
                    let alone = floats(&picture(&mut renderer, format, [SIDE, SIDE], None, false));
                    let found = face(&cube, side_index, side, words);
                    for (pixel, (a, b)) in found.chunks_exact(words).zip(alone.chunks_exact(words)).enumerate() {
                        // Derivatives of traced pixels, of which Kerr tables leave some, are one-sided at the border
                        // of a face, and light of the sky goes by them.
                        let border = [0, side - 1].contains(&(pixel % side));
                        if view == View::Light && way != (0.0, LensTables::Always) && border {
                            continue;
                        }
                        wrong += usize::from(!a.iter().zip(b).all(|(a, b)| close(*a, *b, 2e-4)));
                    }
                }
                println!("{tracer}, {way:?}, {view:?}: {wrong} of {} pixels differ", 6 * SIDE * SIDE);
                // A look direction in f32 that rounding turns may cross an edge.
                let allowed = if tracer == "cpu" { 0 } else { 6 * side * side / 1000 };
                assert!(wrong <= allowed, "{tracer}, {way:?}, {view:?}: {wrong} pixels differ");
            }
        }
    }
}

/// The direction seen at a pixel position, by the words of the header; `None`: nothing.
fn direction(camera: &Camera, [width, height]: [u32; 2], x: f64, y: f64) -> Option<DVec3> {
    let (width, height) = (f64::from(width), f64::from(height));
    let axes = camera.axes().unwrap();
    let turned = |from_forward: f64, side: DVec3| axes.z_axis * from_forward.cos() + side * from_forward.sin();
    match camera.projection {
        Projection::Fisheye => {
            let from_centre = DVec2::new(x - width / 2.0, height / 2.0 - y);
            let share = from_centre.length() / (width.min(height) / 2.0);
            let side = (axes.x_axis * from_centre.x + axes.y_axis * from_centre.y).normalize_or(axes.x_axis);
            (share <= 1.0).then(|| turned(share * camera.fov_y / 2.0, side))
        }
        Projection::Equirect => {
            let (longitude, latitude) = ((x / width - 0.5) * TAU, (0.5 - y / height) * PI);
            Some(turned(longitude, axes.x_axis) * latitude.cos() + axes.y_axis * latitude.sin())
        }
        _ => unreachable!("only these two"),
    }
}

/// Frames of one pixel that look the way in which a pixel of the wide frame does.
#[test]
#[ignore = "in tests/run all; everyday: faces of a cube are perspective views, and each projection's map"]
fn wide_frames_show_what_perspective_ones_do() {
    for (tracer, mut renderer) in both() {
        for &way in ways() {
            for (projection, size) in [(Projection::Fisheye, [60, 66]), (Projection::Equirect, [90, 36])] {
                for view in [View::Light, View::Deflection, View::Redshift] {
                    let format = if view == View::Light { PixelFormat::Rgba32F } else { PixelFormat::R32F };
                    let words = format.bytes_per_pixel() / 4;
                    set(&mut renderer, projection, way);
                    (renderer.scene.view, renderer.scene.sky) = (view, Sky::black());
                    // A pixel of another projection is another patch of sky.
                    renderer.scene.quality.refines = false;
                    let wide = renderer.scene.camera;
                    let frame = floats(&picture(&mut renderer, format, size, None, false));
                    let (mut wrong, mut seen) = (0, 0);
                    // A prime: all rows and columns.
                    for i in (0..(size[0] * size[1]) as usize).step_by(17) {
                        let at = [i as u32 % size[0], i as u32 / size[0]].map(|p| f64::from(p) + 0.5);
                        let ray = {
                            renderer.scene.camera = wide;
                            renderer.scene.camera_ray(size[0], size[1], None, at[0], at[1]).unwrap()
                        };
                        let found = &frame[i * words..][..words];
                        let Some(truth) = direction(&wide, size, at[0], at[1]) else {
                            assert_eq!((ray.direction, ray.frequency_ratio), (DVec3::ZERO, 1.0));
                            assert!(if words == 1 { found[0].is_nan() } else { found == [0.0, 0.0, 0.0, 1.0] });
                            continue;
                        };
                        assert!(ray.direction.abs_diff_eq(truth, 1e-12), "{projection:?} {at:?}: {}", ray.direction);
                        let up = truth.any_orthonormal_vector();
                        renderer.scene.camera =
                            Camera { projection: Projection::Perspective, forward: truth, up, fov_y: 0.1, ..wide };
                        let alone = floats(&picture(&mut renderer, format, [1, 1], None, false));
                        seen += usize::from(alone[0] > 0.0);
                        wrong += usize::from(!found.iter().zip(&alone).all(|(a, b)| close(*a, *b, 1e-4)));
                    }
                    println!("{tracer}, {way:?}, {projection:?}, {view:?}: {wrong} wrong, {seen} with light or value");
                    assert!(seen > 20 && wrong == 0, "{tracer}, {way:?}, {projection:?}, {view:?}: {wrong}");
                }
            }
        }
    }
}

#[test]
#[ignore = "in tests/run all; everyday: tiles of perspective frames, whole frames of all projections"]
fn tiles_of_every_projection_join() {
    // Wide enough for the odd tiles.
    let sizes = [[75, 50], [61, 50], [75, 50], [300, 50]];
    for (tracer, mut renderer) in both() {
        for (i, ((projection, _), size)) in PROJECTIONS.into_iter().zip(sizes).enumerate() {
            for (j, way) in TWO_WAYS.into_iter().enumerate() {
                // Everyday each wide projection in one way; `pictures` has tiles of perspective ones.
                if !runs_all() && (i == 0 || i % 2 != j) {
                    continue;
                }
                set(&mut renderer, projection, way);
                renderer.scene.disk.as_mut().unwrap().turbulence = 1.0;
                let format = PixelFormat::Rgba16F;
                let whole = picture(&mut renderer, format, size, None, false);
                let joined = tiled(&mut renderer, format, size);
                assert!(whole == joined, "{tracer}, {projection:?}, {way:?}");
                assert!(whole.iter().any(|byte| *byte != whole[0]));
            }
        }
    }
}

/// Whole small frames of a smooth disk; and with turbulence, by samples, a part of a large frame with the shadow's
/// edge, because tables of spinning holes are for frames that large. Everyday each wide projection in one way: looks do
/// not regard what becomes of rays, and most other tests see perspective frames.
#[test]
fn gpu_and_cpu_pictures_of_every_projection_agree() {
    let mut renderers = both();
    for (i, (projection, size)) in PROJECTIONS.into_iter().enumerate() {
        // The edge is straight ahead then: in the fifth of a cube's faces.
        let [full_width, full_height] = size.map(|side| 8 * side);
        let middle = if projection == Projection::Cube { full_width / 4 * 3 } else { full_width / 2 };
        let width = size[0].min(100);
        let part = Region { full_width, full_height, x: middle - width / 2, y: full_height / 2 - size[1] / 2 };
        for (j, &way) in ways().iter().enumerate() {
            if !runs_all() && (i == 0 || i % 2 != j) {
                continue;
            }
            // Each ray by itself is small frames' way.
            let looked_up = way.1 == LensTables::Always;
            let part = looked_up.then_some(([width, size[1]], Some(part)));
            for (size, region) in [(size, None)].into_iter().chain(part) {
                let [cpu, gpu] = renderers.each_mut().map(|(_, renderer)| {
                    set(renderer, projection, way);
                    if region.is_some() {
                        renderer.scene.quality.samples_per_pixel = 3;
                        renderer.scene.disk.as_mut().unwrap().turbulence = 1.0;
                        renderer.scene.camera.forward = DVec3::new(0.0, 0.0, 4.5) - renderer.scene.camera.position;
                    }
                    picture(renderer, PixelFormat::Rgba8Srgb, size, region, false)
                });
                let differ = differing(&cpu, &gpu);
                let pixels = (size[0] * size[1]) as usize;
                println!("{projection:?}, {way:?}, {region:?}: {differ} of {pixels} pixels differ");
                // The part is full of the shadow's edge, where the turbulence of integrated samples is filtered
                // otherwise; of the whole frame it is a hundredth.
                let limit = if region.is_some() { 3 } else { 1 };
                assert!(differ * 1000 <= limit * pixels, "{projection:?}, {way:?}, {region:?}: {differ} differ");
                assert!(cpu.chunks_exact(4).filter(|p| p[0] > 8).count() > 20, "{projection:?} is dark");
            }
        }
    }
}

/// Largest difference of the directions in which both tracers see the sky of a hole too far to bend light: of their
/// looks.
#[test]
fn looks_in_single_precision() {
    let mut renderers = both();
    for (projection, _) in PROJECTIONS {
        let size = match projection {
            Projection::Cube => [600, 100],
            _ if runs_all() => [400, 300],
            _ => [200, 150],
        };
        let [cpu, gpu] = renderers.each_mut().map(|(_, renderer)| {
            // Traced: tables are less exact than looks are.
            set(renderer, projection, (0.0, LensTables::Never));
            renderer.scene.disk = None;
            renderer.scene.camera.position = DVec3::new(3e5, -2e5, 1e5);
            if projection == Projection::Fisheye {
                renderer.scene.camera.fov_y = PI;
            }
            renderer.ray_records(size[0], size[1]).unwrap()
        });
        let distances = cpu.iter().zip(&gpu).map(|(a, b)| a.direction.distance(b.direction));
        let worst = distances.fold(0.0, f64::max);
        println!("{projection:?}: {worst:.1e}");
        // For the perspective view 6e-7 was measured.
        assert!(worst < 1e-6, "{projection:?}: {worst:e}");
    }
}

#[test]
#[ignore = "in tests/run all; everyday: both tracers agree about fisheyes"]
fn outside_the_circle_there_is_nothing() {
    let size = [70, 50];
    let inside = |x: u32, y: u32| (f64::from(x) - 34.5).hypot(f64::from(y) - 24.5) <= 25.0;
    for (tracer, mut renderer) in both() {
        for (i, way) in TWO_WAYS.into_iter().enumerate() {
            // Everyday each of these in one way: the circle is found before any ray is.
            let here = |j: usize| runs_all() || j % 2 == i;
            set(&mut renderer, Projection::Fisheye, way);
            // The picture has a translucent disk, the sky and the hole in all directions.
            renderer.scene.camera.fov_y = TAU;
            renderer.scene.sky = Sky::plain();
            for transparent in [false, true] {
                let pixels = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, transparent);
                let mut covered = 0;
                for (i, pixel) in (0..).zip(pixels.chunks_exact(4)) {
                    let (x, y) = (i % size[0], i / size[0]);
                    covered += usize::from(inside(x, y) && pixel[3] == 255);
                    if !inside(x, y) {
                        let alpha = if transparent { 0 } else { 255 };
                        assert_eq!(pixel[..], [0, 0, 0, alpha], "{tracer}, {way:?} ({x}, {y})");
                    }
                }
                assert!(covered > 50, "{tracer}, {way:?}: hole and disk cover {covered} pixels");
            }
            let views = [View::Redshift, View::Deflection, View::Order, View::Steps].into_iter().enumerate();
            for (_, view) in views.filter(|(j, _)| here(*j)) {
                renderer.scene.view = view;
                let values = floats(&picture(&mut renderer, PixelFormat::R32F, size, None, false));
                for (i, value) in (0..).zip(values) {
                    let (x, y) = (i % size[0], i / size[0]);
                    assert!(inside(x, y) || value.is_nan(), "{tracer}, {way:?}, {view:?} ({x}, {y}): {value}");
                }
            }
            if !here(0) {
                continue;
            }
            renderer.scene.view = View::Light;
            // Half a circle's edge shows in the pixels that it cuts.
            renderer.scene.quality.samples_per_pixel = 16;
            renderer.scene.camera.position = DVec3::new(2.4, 0.0, 0.5);
            (renderer.scene.camera.forward, renderer.scene.camera.fov_y) = (-renderer.scene.camera.position, 0.5);
            let pixels = picture(&mut renderer, PixelFormat::Rgba8Srgb, size, None, true);
            assert!(pixels.chunks_exact(4).any(|p| (32..224).contains(&p[3])), "{tracer}, {way:?}: hard edge");
        }
    }
}

/// Luminance times solid angle of the pixels of a cube's frame around `star`.
fn light_of_star(renderer: &mut Renderer, side: u32, star: DVec3) -> f64 {
    let size = [6 * side, side];
    let light = floats(&picture(renderer, PixelFormat::Rgba32F, size, None, false));
    let mut sum = 0.0;
    let half = f64::from(side) / 2.0;
    let mut add = |index: usize, ray: Ray| {
        let (column, row) = (index as u32 % side, index as u32 / size[0]);
        let place = DVec2::new(f64::from(column) + 0.5 - half, f64::from(row) + 0.5 - half) / half;
        // Farther away there is only other stars' light.
        if ray.direction.dot(star) > (3.0 / half).cos() {
            // d(omega) = da db / (1 + a^2 + b^2)^(3/2).
            let solid_angle = (1.0 + place.length_squared()).powf(-1.5) / (half * half);
            let rgb = &light[index * 4..][..3];
            let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
            sum += f64::from(luminance) * solid_angle;
        }
    };
    renderer.scene.camera_rays(size[0], size[1], None, &mut add).unwrap();
    sum
}

/// Unit vectors as columns, the first along `v`.
fn basis(v: DVec3) -> DMat3 {
    let (v, across) = (v.normalize(), v.normalize().any_orthonormal_vector());
    DMat3::from_cols(v, across, v.cross(across))
}

/// Sirius, with no other bright star near, is brought to places on and beside the borders of faces: what each face
/// draws of it sums up to what one face draws of it in its middle.
#[test]
#[ignore = "in tests/run all; everyday: a field of stars has its flux, faces are perspective views"]
fn stars_keep_their_light_across_the_borders_of_faces() {
    const SIDE: u32 = 128;
    let star = catalogue::stars().next().unwrap().direction;
    for (tracer, mut renderer) in both() {
        // So far from the hole all ways find the same rays: everyday one of them.
        for way in TWO_WAYS.into_iter().take(if runs_all() { 2 } else { 1 }) {
            set(&mut renderer, Projection::Cube, way);
            renderer.scene.disk = None;
            renderer.scene.camera.position = DVec3::new(2e5, 3e5, -1e5);
            let mut look_at = |place: DVec3| {
                // A turn that brings `place` (right, up, backward) to the star.
                let turn = basis(star) * basis(place).transpose();
                (renderer.scene.camera.forward, renderer.scene.camera.up) = (turn * DVec3::NEG_Z, turn * DVec3::Y);
                light_of_star(&mut renderer, SIDE, star)
            };
            let alone = look_at(DVec3::new(0.003, 0.002, -1.0));
            assert!(alone > 0.0);
            let pixel = 2.0 / f64::from(SIDE);
            for (i, across) in [-1.2, -0.5, 0.3, 0.8].into_iter().enumerate() {
                let edge = 1.0 + across * pixel;
                // Front to right, back to left, front to up, right to up, down to left.
                let places =
                    [(edge, 0.2, -1.0), (-edge, -0.4, 1.0), (0.5, edge, -1.0), (1.0, edge, 0.3), (-1.0, -edge, 0.0)];
                // Everyday each border at one distance: a star is spread over pixels by one rule at all of them.
                let places = places.into_iter().enumerate().filter(|(j, _)| runs_all() || j % 4 == i);
                for (_, (x, y, z)) in places {
                    let sum = look_at(DVec3::new(x, y, z));
                    let error = sum / alone - 1.0;
                    assert!(error.abs() < 0.03, "{tracer}, {way:?}: ({x}, {y}, {z}): {error}");
                }
            }
            let corner = look_at(DVec3::new(1.0, 1.0, -1.0)) / alone - 1.0;
            println!("{tracer}, {way:?}: at a corner {:+.1} %", 100.0 * corner);
            // There three pixel grids meet that no turn makes one of.
            assert!((-0.3..0.02).contains(&corner), "{tracer}, {way:?}: {corner}");
        }
    }
}

#[test]
fn a_cube_of_another_shape_is_refused() {
    for (_, mut renderer) in both() {
        set(&mut renderer, Projection::Cube, WAYS[0]);
        let mut pixels = vec![7; 60 * 11 * 4];
        let mut image = ImageMut::new(Layout::packed(PixelFormat::Rgba8Srgb, 60, 11), &mut pixels).unwrap();
        let error = renderer.render(&mut image, false, None, &mut |_| true).unwrap_err();
        assert!(error.message.contains("60 x 11") && error.message.contains("66"), "{error}");
        assert!(pixels.iter().all(|byte| *byte == 7), "a refused frame was written");
        // The shape of the full frame counts, not that of the region.
        let region = Region { full_width: 120, full_height: 20, x: 37, y: 3 };
        picture(&mut renderer, PixelFormat::Rgba8Srgb, [60, 11], Some(region), false);
        assert!(renderer.scene.camera_ray(60, 11, None, 0.5, 0.5).is_err());
        assert!(renderer.scene.camera_ray(66, 11, None, 0.5, 0.5).is_ok());
    }
}
