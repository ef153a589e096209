// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sky map that lies in a target on the GPU against the same map in memory, whose pyramid the CPU makes: with levels
//! as a sampler takes them, and as kernels read them. The map is a picture that bhr renders into the target.

use crate::frames::{gpu, picture};
use crate::random::runs_all;
use bhr::gpu::{TargetOrigin, TargetShape};
use bhr::image::{ImageRef, PixelFormat, memory::Layout};
use bhr::renderer::{HostSync, Submits};
use bhr::scene::{Camera, Disk, Projection, Scene, Sky};
use bhr::sky::SkyMap;
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 100];

/// A disk and stars before black, all round: bright edges, fine points and nothing.
fn map_scene() -> Scene {
    let mut scene = Scene::plain();
    scene.camera = Camera { projection: Projection::Equirect, ..Camera::plain() };
    scene.disk = Some(Disk::default());
    scene.quality.refines = false;
    scene
}

/// Columns and rows, no sampler, and rows so far apart that no device's kernel binds 300 of them at once: 128 MiB are
/// bound by lavapipe, 256 MiB elsewhere.
const LARGE: ([u32; 2], bool, u64) = ([600, 300], false, (1 << 20) + 4);

#[test]
fn levels_made_on_the_gpu_are_those_of_the_cpu() {
    let small = [([256, 128], false, 16 * 256), ([301, 150], false, 16 * 301 + 4), ([256, 128], true, 16 * 256)];
    for (map_size, sampler, row_stride) in small.into_iter().chain([([301, 150], true, 16 * 301), LARGE]) {
        let mut renderer = gpu();
        renderer.scene = map_scene();
        let [width, height] = map_size;
        let format = PixelFormat::Rgba32F;
        let shape = TargetShape { image: false, format, size: map_size, row_stride, layout: 0, handle: 0 };
        let target = renderer.create_target(shape, false, TargetOrigin::New).unwrap();
        let sync = HostSync { waits: &[], signals: &[] };
        let job = renderer.render_target(&target, None, &sync, Submits::Now).unwrap();
        job.wait(None, &mut |_| true).unwrap().unwrap();
        let pixels = picture(&mut renderer, format, map_size, None, false);
        let image = ImageRef::new(Layout::packed(format, width, height), &pixels).unwrap();

        let mut scene = Scene::plain();
        scene.sky.flags = Sky::MAP;
        scene.quality.map_sampler = Some(sampler);
        renderer.scene = scene.clone();
        renderer.scene.sky_map = Some(Arc::new(SkyMap::new(&image).unwrap().into()));
        let expected = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        renderer.scene = scene.clone();
        let without = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        renderer.set_sky_target(&target, false).unwrap();
        let found = picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false);
        let apart = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(apart(&found, &expected) <= 1, "{map_size:?} {sampler}: {} steps apart", apart(&found, &expected));
        assert!(apart(&found, &without) > 50, "{map_size:?} {sampler}: the map is not seen");
    }
}

/// A picture of the surroundings as a cube is the same sky as one all round by the same camera; but for edges, which
/// the two pictures hold in other texels. Rows far apart are in `tests/run all` only: the map all round of
/// `levels_made_on_the_gpu_are_those_of_the_cpu` has them everyday.
#[test]
fn a_cube_is_the_sky_that_a_camera_sees() {
    let cubes = [(128, false, 16 * 768), (128, true, 16 * 768 + 4), (300, false, LARGE.2)];
    for (side, sampler, row_stride) in cubes.into_iter().take(if runs_all() { 3 } else { 2 }) {
        let mut renderer = gpu();
        renderer.scene = map_scene();
        renderer.scene.camera.projection = Projection::Cube;
        let format = PixelFormat::Rgba32F;
        let size = [6 * side, side];
        let shape = TargetShape { image: false, format, size, row_stride, layout: 0, handle: 0 };
        let target = renderer.create_target(shape, false, TargetOrigin::New).unwrap();
        let sync = HostSync { waits: &[], signals: &[] };
        let job = renderer.render_target(&target, None, &sync, Submits::Now).unwrap();
        job.wait(None, &mut |_| true).unwrap().unwrap();
        renderer.scene.camera.projection = Projection::Equirect;
        let pixels = picture(&mut renderer, format, [4 * side, 2 * side], None, false);
        let image = ImageRef::new(Layout::packed(format, 4 * side, 2 * side), &pixels).unwrap();

        let mut scene = Scene::plain();
        scene.sky.flags = Sky::MAP;
        scene.quality.map_sampler = Some(sampler);
        scene.disk = None;
        scene.camera.projection = Projection::Equirect;
        renderer.scene = scene.clone();
        renderer.scene.sky_map = Some(Arc::new(SkyMap::new(&image).unwrap().into()));
        let shown = [400, 200];
        let expected = picture(&mut renderer, PixelFormat::Rgba8Srgb, shown, None, false);
        renderer.scene = scene;
        renderer.set_sky_target(&target, true).unwrap();
        let found = picture(&mut renderer, PixelFormat::Rgba8Srgb, shown, None, false);
        let apart = || expected.iter().zip(&found).map(|(a, b)| a.abs_diff(*b));
        let bright = expected.iter().enumerate().filter(|(i, value)| i % 4 != 3 && **value > 60).count();
        let mean = apart().map(f64::from).sum::<f64>() / expected.len() as f64;
        let far = apart().filter(|steps| *steps > 16).count() as f64 / expected.len() as f64;
        assert!(bright > 2000, "{sampler}: only {bright} channels are bright");
        assert!(mean < 0.5 && far < 0.01, "{sampler}: {mean} steps apart in the mean, {far} of them far");
    }
}
