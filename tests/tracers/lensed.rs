// SPDX-License-Identifier: MIT OR Apache-2.0
//! A host's spheres as meshes whose vertices lie where light shows them, and the part of the disk's direct image that
//! they leave, against the curves of bhr's rays.

use crate::frames::{both, floats, gpu, picture};
use crate::random::runs_all;
use bhr::image::{ImageRef, PixelFormat, memory::Layout};
use bhr::scene::project::{Projected, ProjectedPoint};
use bhr::scene::{Camera, Crossing, Hit, LensTables, Occluder, Projection, Scene};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Meridians and parallels of a sphere.
const CUTS: [usize; 2] = [64, 32];

/// A sphere's direct image as triangles on the screen.
pub struct Mesh {
    triangles: Vec<[ProjectedPoint; 3]>,
    middle: DVec2,
}

impl Mesh {
    pub fn new(scene: &Scene, [width, height]: [u32; 2], centre: DVec3, radius: f64) -> Self {
        let vertex = |i: usize| {
            let (phi, theta) =
                (TAU * (i % CUTS[0]) as f64 / CUTS[0] as f64, PI * (i / CUTS[0]) as f64 / CUTS[1] as f64);
            centre + DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * radius
        };
        let vertices = (0..CUTS[0] * (CUTS[1] + 1)).map(vertex).chain([centre]).collect::<Vec<_>>();
        let mut found = vec![Projected::Lost; vertices.len()];
        scene.projector(width, height, None, 0).unwrap().points(&vertices, &mut found);
        let image = |i: usize| match found[i] {
            Projected::At(image) => image,
            other => panic!("{}: {other:?}", vertices[i]),
        };
        let at = |x: usize, y: usize| image(y * CUTS[0] + x % CUTS[0]);
        let cell = |i: usize| {
            let (x, y) = (i % CUTS[0], i / CUTS[0]);
            let corners = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
            [[corners[0], corners[1], corners[2]], [corners[1], corners[2], corners[3]]]
        };
        let triangles = (0..CUTS[0] * CUTS[1]).flat_map(cell).collect();
        Self { triangles, middle: image(vertices.len() - 1).position.unwrap() }
    }

    /// Where the sphere's centre is seen.
    pub fn middle(&self) -> [f64; 2] {
        self.middle.to_array()
    }

    /// The distance to the nearest triangle at a place of the screen.
    pub fn distance(&self, x: f64, y: f64) -> Option<f64> {
        let at = DVec2::new(x, y);
        let meets = |[a, b, c]: &[ProjectedPoint; 3]| {
            let [pa, pb, pc] = [a, b, c].map(|vertex| vertex.position.unwrap());
            let area = (pb - pa).perp_dot(pc - pa);
            let weights = [(pb - at).perp_dot(pc - at), (pc - at).perp_dot(pa - at), (pa - at).perp_dot(pb - at)];
            let weights = weights.map(|weight| weight / area);
            let inside = area != 0.0 && weights.into_iter().all(|weight| weight >= 0.0);
            inside.then(|| weights[0] * a.distance + weights[1] * b.distance + weights[2] * c.distance)
        };
        self.triangles.iter().filter_map(meets).reduce(f64::min)
    }
}

const SIZE: [u32; 2] = [160, 90];

/// Distances of vertices at their lensed places cut the disk where the sphere cuts the ray: before it, within it,
/// beyond it, and behind the hole, where higher orders are hidden, too.
#[test]
fn lensed_things_hide_what_lies_beyond_them_along_the_ray() {
    let spheres =
        [(DVec3::new(3.0, -9.0, 2.5), 1.2), (DVec3::new(-7.0, -3.0, 0.2), 1.6), (DVec3::new(1.0, 11.0, 4.0), 3.0)];
    // Everyday each spin in one way: the cut is by distance along the ray, however the ray is found.
    let ways = [(0.0, LensTables::Always), (0.9, LensTables::Never), (0.9, LensTables::Always)];
    for (spin, tables) in ways.into_iter().take(if runs_all() { 3 } else { 2 }) {
        let mut scene = Scene::plain();
        let position = DVec3::new(0.0, -16.0, 3.0);
        scene.hole.spin = spin;
        scene.camera = Camera { position, forward: -position, fov_y: 1.1, ..Camera::plain() };
        let disk = scene.disk.as_mut().unwrap();
        (disk.inner_radius, disk.outer_radius, disk.opacity, disk.edge_softness) = (6.0, 13.0, 1.0, 0.0);
        scene.quality.refines = false;
        scene.quality.lens_tables = tables;
        let meshes = spheres.map(|(centre, radius)| Mesh::new(&scene, SIZE, centre, radius));
        let pixel = |i: u32| [f64::from(i % SIZE[0]) + 0.5, f64::from(i / SIZE[0]) + 0.5];
        let distances = (0..SIZE[0] * SIZE[1]).map(|i| {
            let [x, y] = pixel(i);
            meshes.iter().filter_map(|mesh| mesh.distance(x, y)).fold(f64::INFINITY, f64::min) as f32
        });
        let distances = distances.collect::<Vec<_>>();
        let layout = Layout::packed(PixelFormat::R32F, SIZE[0], SIZE[1]);
        let occluder = Occluder::new(&ImageRef::new(layout, bytemuck::cast_slice(&distances)).unwrap()).unwrap();
        for (name, mut renderer) in both() {
            renderer.scene = scene.clone();
            renderer.set_occluder(Some(Occluder { lensed: true, ..occluder.clone() }));
            let seen = floats(&picture(&mut renderer, PixelFormat::Rgba32F, SIZE, None, true));
            renderer.set_occluder(None);
            let (mut hidden, mut shown, mut off) = (0, 0, 0);
            // Everyday every third pixel: paths take longer than pixels.
            let step = if runs_all() { 1 } else { 3 };
            for i in (0..SIZE[0] * SIZE[1]).step_by(step).filter(|i| distances[*i as usize].is_finite()) {
                let [x, y] = pixel(i);
                let ray = scene.camera_ray(SIZE[0], SIZE[1], None, x, y).unwrap();
                let path = renderer.trace_path(&ray, 4096).unwrap();
                let place = |p: &[f64; 4]| DVec3::new(p[0], p[1], p[2]);
                // The first that the ray meets: a sphere, or the disk.
                let first = path.windows(2).find_map(|pair| {
                    let (from, to) = (place(&pair[0]), place(&pair[1]));
                    let crossing = from + (to - from) * (from.z / (from.z - to.z));
                    let disk = from.z * to.z < 0.0 && (6.0..13.0).contains(&crossing.length());
                    let sphere = spheres.iter().any(|(centre, radius)| (to - *centre).length() < *radius);
                    (disk || sphere).then_some(disk)
                });
                match first {
                    Some(true) => shown += 1,
                    Some(false) => hidden += 1,
                    None => {}
                }
                let alpha = if first == Some(true) { 1.0 } else { 0.0 };
                off += usize::from(seen[4 * i as usize + 3] != alpha);
            }
            println!("{name}, spin {spin}, {tables:?}: {shown} of the disk, {hidden} of things, {off} pixels off");
            assert!(shown * step > 80 && hidden * step > 300, "{name}, spin {spin}: {shown} {hidden}");
            // Pixels on outlines and on edges of the disk may be off.
            assert!(off * 100 < shown + hidden, "{name}, spin {spin}, {tables:?}: {off} of {}", shown + hidden);
        }
    }
}

/// Rays that a GPU traces in single precision, through the places of the screen that points of the plane are seen at,
/// cross the plane there.
#[test]
fn rays_of_gpus_pass_projected_points() {
    let mut renderer = gpu();
    for spin in [0.0, 0.9, -0.998] {
        let mut scene = Scene::plain();
        let position = DVec3::new(9.0, -20.0, 7.0);
        scene.hole.spin = spin;
        scene.camera = Camera { position, forward: -position, projection: Projection::Equirect, ..Camera::plain() };
        renderer.scene = scene.clone();
        for order in 0..=1 {
            let place = |i: u32| {
                let (r, phi) = (4.0 + 0.15 * f64::from(i), 2.4 * f64::from(i));
                DVec3::new(r * phi.cos(), r * phi.sin(), 0.0)
            };
            let points = (0..200).map(place).collect::<Vec<_>>();
            let mut found = vec![Projected::Lost; points.len()];
            scene.projector(SIZE[0], SIZE[1], None, order).unwrap().points(&points, &mut found);
            let ray = |projected: &Projected| match projected {
                Projected::At(image) => {
                    let at = image.position.expect("before the camera");
                    scene.camera_ray(SIZE[0], SIZE[1], None, at.x, at.y).unwrap()
                }
                other => panic!("{other:?}"),
            };
            let rays = found.iter().map(ray).collect::<Vec<_>>();
            let mut hits = vec![Hit::default(); rays.len()];
            renderer.trace_rays(&rays, &mut hits).unwrap();
            let miss = |(hit, point): (&Hit, &DVec3)| {
                let crossings = &hit.crossings[..hit.crossing_count as usize];
                let place = |x: &Crossing| DVec3::new(x.radius * x.azimuth.cos(), x.radius * x.azimuth.sin(), 0.0);
                let misses = crossings.iter().map(|x| place(x).distance(*point) / point.distance(position));
                misses.fold(f64::INFINITY, f64::min)
            };
            let worst = hits.iter().zip(&points).map(miss).fold(0.0, f64::max);
            println!("spin {spin}, order {order}: rays miss by at most {worst:.1e} of the distance");
            // A crossing is farther from the point than the ray where the ray grazes the plane, and errors of single
            // precision grow by e^pi with each half turn.
            assert!(worst < if order == 0 { 1e-4 } else { 1e-3 }, "spin {spin}, order {order}: {worst:e}");
        }
    }
}
