// SPDX-License-Identifier: MIT OR Apache-2.0
//! One scene on each tracer, by Vulkan and by GL, for a first look after an edit (tests/run fast): disk, turbulence,
//! sky, stars and bloom are in it, and the tracers agree. Pictures are tested in tests/tracers. A missing adapter is a
//! failure.

#[allow(dead_code, reason = "shared with tests that need more of it")]
mod frames;

use bhr::image::PixelFormat;
use bhr::renderer::{Backend, RendererOptions};
use frames::{differing, picture, plain};

const SIZE: [u32; 2] = [96, 54];

/// A spinning hole before the Milky Way, with the disk and everything else of the plain scene but for a thinner disk,
/// so that what is behind it counts.
fn smoke(backend: Backend) -> Vec<u8> {
    let mut renderer = plain(RendererOptions { backend: Some(backend), ..Default::default() });
    assert_eq!(renderer.adapter().backend, backend);
    renderer.scene.hole.spin = 0.7;
    let disk = renderer.scene.disk.as_mut().unwrap();
    (disk.opacity, disk.turbulence) = (0.8, 1.0);
    picture(&mut renderer, PixelFormat::Rgba8Srgb, SIZE, None, false)
}

fn agrees_with_the_cpu(backend: Backend) {
    let (cpu, other) = (smoke(Backend::Cpu), smoke(backend));
    let pixels = (SIZE[0] * SIZE[1]) as usize;
    let differ = differing(&cpu, &other);
    assert!(differ * 200 <= pixels, "{backend:?}: {differ} of {pixels} pixels differ by more than one step");
    let lit = cpu.chunks_exact(4).filter(|p| p[0].max(p[1]).max(p[2]) > 128).count();
    let dark = cpu.chunks_exact(4).filter(|p| p[0].max(p[1]).max(p[2]) < 32).count();
    assert!(lit > pixels / 50 && dark > pixels / 50, "{lit} lit and {dark} dark of {pixels} pixels");
}

#[test]
fn vulkan_agrees_with_the_cpu() {
    agrees_with_the_cpu(Backend::Vulkan);
}

#[test]
fn gl_agrees_with_the_cpu() {
    agrees_with_the_cpu(Backend::Gl);
}
