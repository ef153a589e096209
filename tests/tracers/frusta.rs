// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frusta between four tangents, and jitter: against perspective pictures, against parts and shifts of larger ones, and
//! the two tracers against each other. Projections of other kinds are in `cameras`.

use crate::frames::{both, differing, picture, tiled};
use bhr::image::PixelFormat;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Frustum, LensTables, Motion, Projection, Region, Scene};
use glam::{DVec2, DVec3};

const SIZE: [u32; 2] = [108, 60];

/// Spins and how their rays are found: traced, and looked up.
const WAYS: [(f64, LensTables); 2] = [(0.0, LensTables::Always), (0.9, LensTables::Never)];

/// Looks past the hole, which is near a border of the picture, and moves.
fn camera() -> Camera {
    Camera {
        position: DVec3::new(14.0, -9.0, 3.0),
        forward: DVec3::new(-0.8, 0.75, -0.1),
        up: DVec3::new(0.1, -0.1, 0.9),
        fov_y: 0.9,
        motion: Motion::Velocity,
        velocity: DVec3::new(0.1, 0.2, -0.1),
        ..Camera::plain()
    }
}

/// The borders of the perspective picture's columns x0 .. x1 and rows y0 .. y1.
fn borders(fov_y: f64, [width, height]: [u32; 2], [x0, x1]: [u32; 2], [y0, y1]: [u32; 2]) -> Frustum {
    let tan = (0.5 * fov_y).tan();
    let (width, height) = (f64::from(width), f64::from(height));
    let across = |x: u32| tan * width / height * (2.0 * f64::from(x) / width - 1.0);
    let upward = |y: u32| tan * (1.0 - 2.0 * f64::from(y) / height);
    Frustum { left: across(x0), right: across(x1), down: upward(y1), up: upward(y0) }
}

fn set(renderer: &mut Renderer, (spin, tables): (f64, LensTables)) {
    renderer.scene = Scene::plain();
    renderer.scene.camera = camera();
    renderer.scene.hole.spin = spin;
    renderer.scene.quality.lens_tables = tables;
}

fn shown(renderer: &mut Renderer, size: [u32; 2], region: Option<Region>) -> Vec<u8> {
    picture(renderer, PixelFormat::Rgba8Srgb, size, region, false)
}

#[test]
fn a_symmetric_frustum_is_a_perspective_picture_to_the_byte() {
    for (tracer, mut renderer) in both() {
        for way in WAYS {
            set(&mut renderer, way);
            let perspective = shown(&mut renderer, SIZE, None);
            let tan = (0.5 * renderer.scene.camera.fov_y).tan();
            let wide = tan * f64::from(SIZE[0]) / f64::from(SIZE[1]);
            renderer.scene.camera.projection = Projection::Frustum;
            renderer.scene.camera.frustum = Frustum { left: -wide, right: wide, down: -tan, up: tan };
            // A frustum ignores the field of view.
            renderer.scene.camera.fov_y = 3.0;
            assert!(shown(&mut renderer, SIZE, None) == perspective, "{tracer}, {way:?}: other bytes");
            assert!(tiled(&mut renderer, PixelFormat::Rgba8Srgb, SIZE) == perspective, "{tracer}, {way:?}: tiles");
        }
    }
}

#[test]
fn an_off_axis_frustum_is_a_part_of_a_larger_picture() {
    let ([x0, x1], [y0, y1]) = ([53, 106], [3, 40]);
    for (tracer, mut renderer) in both() {
        for way in WAYS {
            set(&mut renderer, way);
            let size = [x1 - x0, y1 - y0];
            let region = Region { full_width: SIZE[0], full_height: SIZE[1], x: x0, y: y0 };
            let part = shown(&mut renderer, size, Some(region));
            assert!(part.chunks_exact(4).any(|p| p != &part[..4]), "nothing is to be seen");
            renderer.scene.camera.frustum = borders(renderer.scene.camera.fov_y, SIZE, [x0, x1], [y0, y1]);
            renderer.scene.camera.projection = Projection::Frustum;
            // In as small a frame tables would not pay, but ALWAYS and NEVER do not ask.
            let alone = shown(&mut renderer, size, None);
            let wrong = differing(&part, &alone);
            println!("{tracer}, {way:?}: {wrong} of {} pixels differ", size[0] * size[1]);
            // Rounding moves a ray by 1e-7 of a pixel's side, across an edge here and there.
            assert!(wrong <= if tracer == "cpu" { 0 } else { 4 }, "{tracer}, {way:?}: {wrong} pixels differ");
        }
    }
}

#[test]
fn a_jitter_of_a_pixel_moves_the_picture_by_a_pixel() {
    for (tracer, mut renderer) in both() {
        for (way, projection) in WAYS.into_iter().zip([Projection::Perspective, Projection::Frustum]) {
            set(&mut renderer, way);
            renderer.scene.camera.projection = projection;
            renderer.scene.camera.frustum = borders(0.9, SIZE, [20, 92], [5, 45]);
            let still = shown(&mut renderer, SIZE, None);
            for jitter in [DVec2::new(1.0, 0.0), DVec2::new(-1.0, 1.0)] {
                renderer.scene.camera.jitter = jitter;
                let moved = shown(&mut renderer, SIZE, None);
                assert!(moved != still, "{tracer}, {way:?}: jitter does nothing");
                let (mut before, mut after) = (Vec::new(), Vec::new());
                for y in 2..SIZE[1] as i32 - 2 {
                    for x in 2..SIZE[0] as i32 - 2 {
                        let at = |x: i32, y: i32| 4 * (y as usize * SIZE[0] as usize + x as usize);
                        let there = at(x + jitter.x as i32, y + jitter.y as i32);
                        before.extend_from_slice(&still[at(x, y)..][..4]);
                        after.extend_from_slice(&moved[there..][..4]);
                    }
                }
                let wrong = differing(&before, &after);
                println!("{tracer}, {way:?}, {jitter}: {wrong} pixels differ");
                assert!(wrong <= if tracer == "cpu" { 0 } else { 8 }, "{tracer}, {way:?}: {wrong} pixels differ");
            }
        }
    }
}

#[test]
fn jitter_is_ignored_where_no_image_plane_is() {
    let [(_, mut renderer), _] = both();
    for (projection, size) in
        [(Projection::Fisheye, [40, 40]), (Projection::Equirect, [64, 32]), (Projection::Cube, [96, 16])]
    {
        set(&mut renderer, WAYS[0]);
        renderer.scene.camera.projection = projection;
        let still = shown(&mut renderer, size, None);
        renderer.scene.camera.jitter = DVec2::new(0.7, -0.4);
        assert!(shown(&mut renderer, size, None) == still, "{projection:?}");
    }
}

/// The ray through a pixel is seen between the tangents, and a jitter takes it along.
#[test]
fn rays_of_a_frustum_lie_between_its_tangents() {
    let mut scene = Scene::plain();
    scene.camera = Camera { motion: Motion::Static, ..camera() };
    scene.camera.projection = Projection::Frustum;
    scene.camera.frustum = Frustum { left: -0.3, right: 1.1, down: 0.2, up: 0.7 };
    let axes = scene.camera.axes().unwrap();
    let seen = |scene: &Scene, x: f64, y: f64| {
        let ray = scene.camera_ray(SIZE[0], SIZE[1], None, x, y).unwrap();
        let n = axes.transpose() * ray.direction;
        DVec2::new(n.x, n.y) / n.z
    };
    let (width, height) = (f64::from(SIZE[0]), f64::from(SIZE[1]));
    let at = |x: f64, y: f64| DVec2::new(-0.3 + 1.4 * x / width, 0.7 - 0.5 * y / height);
    for (x, y) in [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height), (31.5, 40.5), (-12.0, 70.0)] {
        assert!(seen(&scene, x, y).abs_diff_eq(at(x, y), 1e-14), "{} {}", seen(&scene, x, y), at(x, y));
    }
    scene.camera.jitter = DVec2::new(0.25, -0.5);
    assert!(seen(&scene, 31.5, 40.5).abs_diff_eq(at(31.25, 41.0), 1e-14));
}

/// Off-axis, jittered, wider than high in another ratio than the frame, and moving.
#[test]
fn both_tracers_show_the_same_frustum() {
    for way in WAYS {
        let pictures = both().map(|(_, mut renderer)| {
            set(&mut renderer, way);
            renderer.scene.camera.projection = Projection::Frustum;
            renderer.scene.camera.frustum = Frustum { left: -1.2, right: 0.4, down: -0.3, up: 0.9 };
            renderer.scene.camera.jitter = DVec2::new(0.3, -0.45);
            shown(&mut renderer, SIZE, None)
        });
        let wrong = differing(&pictures[0], &pictures[1]);
        println!("{way:?}: {wrong} pixels differ");
        assert!(wrong <= (SIZE[0] * SIZE[1]) as usize / 100, "{way:?}: {wrong} pixels differ");
    }
}
