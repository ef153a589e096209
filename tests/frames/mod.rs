//! Frames for tests: a renderer of each kind, and the bytes of what it renders.

use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::Region;

pub fn cpu() -> Renderer {
    Renderer::new(RendererOptions { backend: Some(Backend::Cpu), ..Default::default() }).unwrap()
}

/// Whatever adapter comes first; without one tests fail.
pub fn gpu() -> Renderer {
    let renderer = Renderer::new(RendererOptions::default()).unwrap();
    assert_ne!(renderer.adapter().backend, Backend::Cpu, "no GPU adapter (lavapipe counts)");
    renderer
}

pub fn both() -> [(&'static str, Renderer); 2] {
    [("cpu", cpu()), ("gpu", gpu())]
}

pub fn picture(
    renderer: &mut Renderer,
    format: PixelFormat,
    size: [u32; 2],
    region: Option<Region>,
    transparent: bool,
) -> Vec<u8> {
    let layout = Layout::packed(format, size[0], size[1]);
    let mut pixels = vec![0; (size[0] * size[1]) as usize * format.bytes_per_pixel()];
    let mut image = ImageMut::new(layout, &mut pixels).unwrap();
    renderer.render(&mut image, transparent, region, &mut |_| true).unwrap();
    pixels
}

pub fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

/// A picture put together from odd tiles.
pub fn tiled(renderer: &mut Renderer, format: PixelFormat, [width, height]: [u32; 2]) -> Vec<u8> {
    let bytes = format.bytes_per_pixel();
    let mut joined = vec![0; (width * height) as usize * bytes];
    // 7 and 40 columns, 1 and 30 rows, and what is left: small and large.
    for (x, w) in [(0, 7), (7, 33), (40, width - 40)] {
        for (y, h) in [(0, 1), (1, 29), (30, height - 30)] {
            let region = Region { full_width: width, full_height: height, x, y };
            let tile = picture(renderer, format, [w, h], Some(region), false);
            for (row, line) in tile.chunks_exact(w as usize * bytes).enumerate() {
                let at = ((y as usize + row) * width as usize + x as usize) * bytes;
                joined[at..at + line.len()].copy_from_slice(line);
            }
        }
    }
    joined
}

/// Pixels of 8-bit pictures that differ by more than one step in some channel.
pub fn differing(a: &[u8], b: &[u8]) -> usize {
    a.chunks_exact(4).zip(b.chunks_exact(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count()
}
