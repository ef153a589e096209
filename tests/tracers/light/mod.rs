// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether the light is right: of the disk, its colours, its turbulence, the delays and the views, each against an
//! expected value that owes nothing to the tracers. What is a picture is asked of both tracers; the GPU is whatever
//! adapter comes first, and without one the tests fail. This file: what the tests share.

mod colours;
mod delays;
mod disk;
mod emission;
mod fall;
mod orbit;
mod plunge;
mod turbulence;
mod views;

use crate::frames::{Lent, cpu};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::Renderer;
use bhr::scene::{Camera, Hit, Motion, Ray, Region, Sky, View};
use glam::DVec3;

/// Both tracers, their skies black.
fn both() -> [(&'static str, Lent); 2] {
    let mut list = crate::frames::both();
    list.iter_mut().for_each(|(_, renderer)| renderer.scene.sky = Sky::black());
    list
}

/// A static camera that looks at the hole from (r, inclination), azimuth 0, and sees `width` M at the hole's distance
/// across its shorter side.
fn camera(r: f64, inclination_degrees: f64, width: f64) -> Camera {
    let theta = inclination_degrees.to_radians();
    let position = DVec3::new(theta.sin(), 0.0, theta.cos()) * r;
    let up = if inclination_degrees == 0.0 { DVec3::X } else { DVec3::Z };
    let fov_y = 2.0 * (0.5 * width / r).atan();
    Camera { position, forward: -position, up, fov_y, motion: Motion::Static, ..Camera::plain() }
}

fn whole([full_width, full_height]: [u32; 2]) -> Region {
    Region { full_width, full_height, x: 0, y: 0 }
}

/// The bytes of a `size` image, part of the frame that `region` describes.
fn bytes(renderer: &mut Renderer, format: PixelFormat, size: [u32; 2], region: Region) -> Vec<u8> {
    let mut pixels = vec![0; (size[0] * size[1]) as usize * format.bytes_per_pixel()];
    let mut image = ImageMut::new(Layout::packed(format, size[0], size[1]), &mut pixels).unwrap();
    renderer.render(&mut image, false, Some(region), &mut |_| true).unwrap();
    pixels
}

fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()).into()).collect()
}

/// Linear Rec. 709 of every pixel.
fn light(renderer: &mut Renderer, size: [u32; 2], region: Region) -> Vec<[f64; 3]> {
    renderer.scene.view = View::Light;
    let values = floats(&bytes(renderer, PixelFormat::Rgba32F, size, region));
    values.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect()
}

/// A view's value of every pixel; the view is light again afterwards.
fn view(renderer: &mut Renderer, view: View, size: [u32; 2], region: Region) -> Vec<f64> {
    renderer.scene.view = view;
    let values = floats(&bytes(renderer, PixelFormat::R32F, size, region));
    renderer.scene.view = View::Light;
    values
}

/// The hits of the rays through the pixels' centres, by the tracer itself.
fn hits(renderer: &mut Renderer, size: [u32; 2], region: Region) -> Vec<Hit> {
    let mut rays = vec![Ray::default(); (size[0] * size[1]) as usize];
    renderer.scene.camera_rays(size[0], size[1], Some(region), &mut |i, ray| rays[i] = ray).unwrap();
    let mut hits = vec![Hit::default(); rays.len()];
    renderer.trace_rays(&rays, &mut hits).unwrap();
    hits
}

/// Indices of the four neighbours of a pixel that is not at the border; `None` for one that is.
fn neighbours(index: usize, [width, height]: [u32; 2]) -> Option<[usize; 4]> {
    let (w, h) = (width as usize, height as usize);
    let (x, y) = (index % w, index / w);
    (x > 0 && y > 0 && x + 1 < w && y + 1 < h).then(|| [index - 1, index + 1, index - w, index + w])
}

/// Rec. 709.
fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126390059 * rgb[0] + 0.7151686788 * rgb[1] + 0.0721923154 * rgb[2]
}
