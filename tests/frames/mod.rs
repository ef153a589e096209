// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames for tests: a renderer of each kind, and the bytes of what it renders. Renderers on the GPU are lent from a
//! pool, as each of them compiles its kernels, which takes lavapipe longer than most tests' frames.

use bhr::image::{ImageMut, PixelFormat, memory::Layout};
use bhr::renderer::{Backend, Renderer, RendererOptions};
use bhr::scene::{Region, Scene};
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// Renderers on the GPU that no test has now.
static POOL: Mutex<Vec<Renderer>> = Mutex::new(Vec::new());

/// A renderer that a test has to itself, with the plain scene. One on the GPU is the next test's after that, and
/// keeps its kernels and tables; unless the test fails, or asked for a new one.
pub struct Lent {
    renderer: Option<Renderer>,
    again: bool,
}

impl Deref for Lent {
    type Target = Renderer;

    fn deref(&self) -> &Renderer {
        self.renderer.as_ref().expect("until it is dropped")
    }
}

impl DerefMut for Lent {
    fn deref_mut(&mut self) -> &mut Renderer {
        self.renderer.as_mut().expect("until it is dropped")
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        let Some(mut renderer) = self.renderer.take() else { return };
        if self.again && !std::thread::panicking() {
            renderer.scene = Scene::plain();
            POOL.lock().unwrap_or_else(PoisonError::into_inner).push(renderer);
        }
    }
}

/// A renderer with the plain scene, whatever the default one is.
pub fn plain(options: RendererOptions) -> Renderer {
    let mut renderer = Renderer::new(options).unwrap();
    renderer.scene = Scene::plain();
    renderer
}

pub fn cpu() -> Lent {
    let options = RendererOptions { backend: Some(Backend::Cpu), ..Default::default() };
    Lent { renderer: Some(plain(options)), again: false }
}

/// On whatever adapter comes first; without one tests fail.
pub fn gpu() -> Lent {
    let idle = POOL.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let mut lent = idle.map_or_else(new_gpu, |renderer| Lent { renderer: Some(renderer), again: true });
    lent.again = true;
    lent
}

/// A GPU renderer, never used before nor after: for what a renderer holds, or for how several compare.
pub fn new_gpu() -> Lent {
    let renderer = plain(RendererOptions::default());
    assert_ne!(renderer.adapter().backend, Backend::Cpu, "no GPU adapter (lavapipe counts)");
    Lent { renderer: Some(renderer), again: false }
}

pub fn both() -> [(&'static str, Lent); 2] {
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
