// SPDX-License-Identifier: MIT OR Apache-2.0
//! A host's own picture put together with bhr's: its sky along the lens map against bhr's own map of the same sky, and
//! its spheres, on straight lines of sight and at their lensed places, against the same spheres on the curves of bhr's
//! rays.

use crate::frames::{both, cpu, floats, picture};
use crate::lensed::Mesh;
use crate::random::runs_all;
use bhr::image::{ImageMut, ImageRef, PixelFormat, memory::Layout};
use bhr::job::OutputTarget;
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Effects, LensTables, RayOutputKind, Scene, Sky};
use bhr::sky::{SkyMap, StoredMap};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const SIZE: [u32; 2] = [192, 120];

/// A smooth sky, 0 .. 1.
fn sky(d: DVec3) -> [f64; 3] {
    [
        0.5 + 0.4 * (3.0 * d.x + d.y).sin(),
        0.5 + 0.4 * (4.0 * d.y - d.z).cos(),
        0.5 + 0.45 * (2.0 * d.z + d.x * d.y).sin(),
    ]
}

/// `sky` as a map of bhr's (bhr.h, bhr_set_sky_map).
fn map() -> StoredMap {
    let [width, height] = [1024, 512];
    let direction = |x: u32, y: u32| {
        let ra = TAU * (0.5 - (f64::from(x) + 0.5) / f64::from(width));
        let dec = PI * (0.5 - (f64::from(y) + 0.5) / f64::from(height));
        DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin())
    };
    let texel = |i: u32| {
        let [r, g, b] = sky(direction(i % width, i / width)).map(|v| v as f32);
        [r, g, b, 1.0]
    };
    let texels = (0..width * height).flat_map(texel).collect::<Vec<f32>>();
    let layout = Layout::packed(PixelFormat::Rgba32F, width, height);
    SkyMap::new(&ImageRef::new(layout, bytemuck::cast_slice(&texels)).unwrap()).unwrap().into()
}

fn lens_map(renderer: &mut Renderer) -> Vec<[f32; 4]> {
    let mut block = vec![0; (SIZE[0] * SIZE[1] * 16) as usize];
    let target = ImageMut::new(Layout::packed(PixelFormat::Rgba32F, SIZE[0], SIZE[1]), &mut block).unwrap();
    let target = OutputTarget { output: RayOutputKind::Sky.into(), target, transparent: false };
    renderer.render_outputs(vec![target], None, &mut |_| true).unwrap();
    floats(&block).as_chunks().0.to_vec()
}

/// Within a step of 8 bits, but where a pixel shows more of the sky than one direction can stand for.
#[test]
#[ignore = "in tests/run all; everyday: the composite example, spheres at their lensed places"]
fn the_lens_map_shows_a_sky_as_bhr_does() {
    let map = Arc::new(map());
    for (name, mut renderer) in both() {
        for (spin, tables) in [(0.0, LensTables::Always), (0.9, LensTables::Always), (0.9, LensTables::Never)] {
            let mut scene = Scene { disk: None, sky_map: Some(map.clone()), ..Scene::plain() };
            let position = DVec3::new(5.0, -17.0, 6.0);
            scene.camera = Camera { position, forward: -position, fov_y: 1.1, ..Camera::plain() };
            scene.hole.spin = spin;
            scene.sky = Sky { flags: Sky::MAP, ..scene.sky };
            scene.effects = Effects(0);
            scene.quality.refines = false;
            scene.quality.lens_tables = tables;
            renderer.scene = scene;
            let own = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, false));
            let lens = lens_map(&mut renderer);
            let width = SIZE[0] as usize;
            let direction =
                |i: usize| lens.get(i).map(|[x, y, z, _]| DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)));
            let (mut compared, mut worst) = (0, 0.0_f64);
            for (i, own) in own.chunks_exact(4).enumerate() {
                let Some(d) = direction(i).filter(|d| *d != DVec3::ZERO) else { continue };
                let neighbours = [i.wrapping_sub(1), i + 1, i.wrapping_sub(width), i + width];
                let turn = |n: usize| direction(n).map_or(0.0, |there| (there - d).length());
                if neighbours.into_iter().any(|n| turn(n) > 0.06) {
                    continue;
                }
                compared += 1;
                let off = sky(d).iter().zip(own).map(|(a, b)| 255.0 * (a - f64::from(*b)).abs()).fold(0.0, f64::max);
                worst = worst.max(off);
            }
            println!("{name}, spin {spin}, {tables:?}: {compared} pixels, at most {worst:.3} steps of 255");
            assert!(compared > lens.len() * 3 / 4 && worst <= 1.0, "{name}, spin {spin}, {tables:?}: {worst}");
        }
    }
}

/// How a host draws a sphere.
#[derive(Clone, Copy, PartialEq)]
enum Drawn {
    Straight,
    /// A mesh, its vertices at their lensed places.
    Lensed,
}

/// The greatest distance, pixels, between the outline of a sphere as a host draws it and on bhr's rays.
fn outline(renderer: &Renderer, [width, height]: [u32; 2], (centre, radius): (DVec3, f64), drawn: Drawn) -> f64 {
    let scene = &renderer.scene;
    let mesh = (drawn == Drawn::Lensed).then(|| Mesh::new(scene, [width, height], centre, radius));
    let near = |a: DVec3, b: DVec3| {
        let along = ((centre - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a + (b - a) * along - centre).length()
    };
    let straight = |x: f64, y: f64| {
        let ray = scene.camera_ray(width, height, None, x, y).unwrap();
        near(ray.position, ray.position + ray.direction.normalize() * 4.0 * ray.position.length()) < radius
    };
    let curved = |x: f64, y: f64| {
        let ray = scene.camera_ray(width, height, None, x, y).unwrap();
        let path = renderer.trace_path(&ray, 4096).unwrap();
        let place = |p: &[f64; 4]| DVec3::new(p[0], p[1], p[2]);
        path.windows(2).any(|pair| near(place(&pair[0]), place(&pair[1])) < radius)
    };
    let host = |x: f64, y: f64| mesh.as_ref().map_or_else(|| straight(x, y), |mesh| mesh.distance(x, y).is_some());
    // The middle of the image.
    let middle = match &mesh {
        Some(mesh) => mesh.middle(),
        None => {
            let camera = &scene.camera;
            let right = camera.forward.cross(camera.up).normalize();
            let up = right.cross(camera.forward).normalize();
            let seen = centre - camera.position;
            let ahead = seen.dot(camera.forward.normalize());
            let scale = f64::from(height) / (2.0 * (camera.fov_y / 2.0).tan());
            let (x, y) = (scale * seen.dot(right) / ahead, scale * seen.dot(up) / ahead);
            [0.5 * f64::from(width) + x, 0.5 * f64::from(height) - y]
        }
    };
    assert!(host(middle[0], middle[1]) && curved(middle[0], middle[1]), "{centre}: {middle:?}");
    let mut worst = 0.0_f64;
    for k in 0..12 {
        let (sin, cos) = (TAU * f64::from(k) / 12.0).sin_cos();
        let edge = |inside: &dyn Fn(f64, f64) -> bool| {
            let (mut low, mut high) = (0.0, f64::from(width));
            for _ in 0..30 {
                let at = 0.5 * (low + high);
                if inside(middle[0] + at * cos, middle[1] + at * sin) { low = at } else { high = at }
            }
            low
        };
        worst = worst.max((edge(&host) - edge(&curved)).abs());
    }
    worst
}

/// Straight lines of sight hold where a host's things are many M from the hole, or the camera is: half a pixel then.
/// Near the hole they are off by the angle from it over r / M, which the last sight measures.
#[test]
fn spheres_on_straight_lines_are_where_rays_see_them_far_from_the_hole() {
    let mut renderer = cpu();
    renderer.scene = Scene { disk: None, ..Scene::plain() };
    let sights = [
        // r of the camera, the field of view, the sphere before the hole and its radius, and pixels that it is off.
        (1000.0, 0.10, DVec3::new(6.0, -800.0, 4.0), 9.0, 0.5),
        (1000.0, 0.10, DVec3::new(25.0, -500.0, -9.0), 6.0, 0.5),
        (300.0, 0.2, DVec3::new(-1.0, -250.0, 1.5), 1.2, 0.5),
        (26.0, 0.78, DVec3::new(3.0, -20.0, 1.0), 1.0, 5.0),
    ];
    for (r, fov_y, centre, radius, most) in sights {
        let position = DVec3::new(0.0, -r, 0.0);
        renderer.scene.camera = Camera { position, forward: -position, fov_y, ..Camera::plain() };
        let off = outline(&renderer, [320, 180], (centre, radius), Drawn::Straight);
        println!("from {r} M, a sphere at {centre}: its outline is off by {off:.3} pixels");
        assert!(off < most, "from {r} M, a sphere at {centre}: {off} pixels");
    }
}

/// Vertices at the places where `bhr_project_points` sees them: outlines are right from near, too, before the hole,
/// beside it and behind it, with spin and without.
#[test]
fn spheres_at_their_lensed_places_are_where_rays_see_them() {
    let mut renderer = cpu();
    let sights = [
        (26.0, 0.78, DVec3::new(3.0, -20.0, 1.0), 1.0),
        (26.0, 0.78, DVec3::new(-5.0, -4.0, 2.0), 1.5),
        (26.0, 0.78, DVec3::new(6.0, 9.0, -3.0), 2.0),
        (12.0, 1.3, DVec3::new(2.5, -7.0, 1.5), 0.8),
        (12.0, 1.3, DVec3::new(-4.0, 1.0, 1.0), 0.7),
        (12.0, 1.3, DVec3::new(4.0, 8.0, 2.0), 1.0),
    ];
    for (i, spin) in [0.0, 0.9].into_iter().enumerate() {
        renderer.scene = Scene { disk: None, ..Scene::plain() };
        renderer.scene.hole.spin = spin;
        for (j, (r, fov_y, centre, radius)) in sights.into_iter().enumerate() {
            // Everyday four of the sights, each at one spin.
            if !runs_all() && (i * 3 + j) % 4 != 0 {
                continue;
            }
            let position = DVec3::new(0.0, -r, 0.0);
            renderer.scene.camera = Camera { position, forward: -position, fov_y, ..Camera::plain() };
            let off = outline(&renderer, [320, 180], (centre, radius), Drawn::Lensed);
            println!("spin {spin}, from {r} M, a sphere at {centre}: its outline is off by {off:.3} pixels");
            assert!(off < 0.5, "spin {spin}, from {r} M, a sphere at {centre}: {off} pixels");
        }
    }
}
