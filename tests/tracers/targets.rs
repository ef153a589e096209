// SPDX-License-Identifier: MIT OR Apache-2.0
//! Buffers that a host shares are written by the very kernels that write images in memory, whichever way those go, so
//! that their bytes are the same on hardware too. The buffers are the host's own pages, which a Vulkan device takes.

use crate::frames::plain;
use bhr::gpu::{HOST_POINTER, MemoryInfo, TargetOrigin, TargetShape};
use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, HostSync, Renderer, RendererOptions, Submits};
use bhr::scene::{LensTables, View};

const SIZE: [u32; 2] = [101, 67];
/// Whole pages of any system, and room for the largest buffer.
const PAGES: usize = 1 << 20;
const UNTOUCHED: u8 = 0x5a;

#[repr(align(65536))]
struct Pages([u8; PAGES]);

fn image(renderer: &mut Renderer, format: PixelFormat) -> Vec<u8> {
    let layout = Layout::packed(format, SIZE[0], SIZE[1]);
    let mut pixels = vec![0; SIZE[0] as usize * SIZE[1] as usize * format.bytes_per_pixel()];
    renderer.render(&mut ImageMut::new(layout, &mut pixels).unwrap(), false, None, &mut |_| true).unwrap();
    pixels
}

/// The pages after a frame into rows that are `row_stride` bytes apart.
fn shared(renderer: &mut Renderer, format: PixelFormat, row_stride: u64) -> Box<Pages> {
    let mut pages = Box::new(Pages([UNTOUCHED; PAGES]));
    let shape = TargetShape { image: false, format, size: SIZE, row_stride, layout: 0, handle: HOST_POINTER };
    let memory = MemoryInfo { allocation_size: PAGES as u64, ..MemoryInfo::default() };
    let origin = TargetOrigin::Pointer((&raw mut *pages).cast(), memory);
    let target = renderer.create_target(shape, false, origin).unwrap();
    let sync = HostSync { waits: &[], signals: &[] };
    let job = renderer.render_target(&target, None, &sync, Submits::Now).unwrap();
    job.wait(None, &mut |_| true).unwrap().unwrap();
    target.end("the test has its pixels");
    pages
}

#[test]
#[ignore = "in tests/run all; everyday: outputs in tests/interop, which are as frames in the host's memory"]
fn buffers_are_written_by_the_kernels_of_images() {
    let mut renderer = plain(RendererOptions { backend: Some(Backend::Vulkan), ..Default::default() });
    renderer.scene.quality.anticipates = Some(false);
    renderer.scene.hole.spin = 0.9;
    let light = [PixelFormat::Rgba8Srgb, PixelFormat::Bgra8Srgb, PixelFormat::Rgba16F, PixelFormat::Rgba32F];
    for (tables, samples, bloom) in
        [(LensTables::Always, 1, 0.0), (LensTables::Never, 3, 0.0), (LensTables::Never, 1, 0.3)]
    {
        renderer.scene.quality.lens_tables = tables;
        renderer.scene.quality.samples_per_pixel = samples;
        renderer.scene.film.bloom = bloom;
        for (format, view) in
            light.map(|format| (format, View::Light)).into_iter().chain([(PixelFormat::R32F, View::Order)])
        {
            renderer.scene.view = view;
            for mapped in [false, true] {
                renderer.scene.quality.mapped_pixels = Some(mapped);
                let what = format!("{format}, {tables:?}, {samples} samples, bloom {bloom}, mapped {mapped}");
                let expected = image(&mut renderer, format);
                let row = SIZE[0] as usize * format.bytes_per_pixel();
                assert!(expected.iter().any(|byte| *byte != expected[0]), "{what}: nothing is shown");
                let made = renderer.settled_waits().unwrap();
                for stride in [row, row + 52] {
                    let pages = shared(&mut renderer, format, stride as u64);
                    let used = stride * (SIZE[1] as usize - 1) + row;
                    for (y, expected) in expected.chunks_exact(row).enumerate() {
                        let line = &pages.0[y * stride..];
                        assert_eq!(&line[..row], expected, "{what}: row {y}");
                        let between = if y + 1 < SIZE[1] as usize { &line[row..stride] } else { &[] };
                        assert!(between.iter().all(|byte| *byte == UNTOUCHED), "{what}: after row {y}");
                    }
                    assert!(pages.0[used..].iter().all(|byte| *byte == UNTOUCHED), "{what}: beyond the last row");
                }
                let now = renderer.settled_waits().unwrap();
                assert_eq!((now.waits, now.late), (made.waits, made.late), "{what}: a kernel of the buffer's own");
            }
        }
    }
}
