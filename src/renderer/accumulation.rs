// SPDX-License-Identifier: MIT OR Apache-2.0
//! Accumulated frames: the weighted mean of the light of several frames, developed once. The host changes the scene
//! between them: time and camera for motion blur, the camera's place for depth of field. Knows no tracers.

use super::Renderer;
use crate::allocate::{self, THREAD_ROOM, filled};
use crate::error::{Error, ErrorKind, PARTLY_WRITTEN, Result, out_of_range};
use crate::film::whole::develop_whole;
use crate::image::memory::Layout;
use crate::image::{ImageMut, PixelFormat};
use crate::thread_state::begin_own_thread;
use crate::tracer::{FrameRequest, FrameStats, Progress, Tile};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::time::Instant;

/// The weights that frames may have.
const LEAST_WEIGHT: f64 = 1e-6;
const MOST_WEIGHT: f64 = 1e6;
/// The most frames of one accumulation, so that their sum in single precision stays good to 1e-3 of a step.
const MOST_FRAMES: u32 = 65536;

/// Frames that are being added up.
pub(super) struct Accumulation {
    size: [u32; 2],
    transparent: bool,
    /// Light times weight, and the sum of the weights.
    sum: Vec<[f32; 4]>,
    weight: f64,
    frames: u32,
    /// The light of the frame that is being added.
    next: Vec<[f32; 4]>,
    pool: ThreadPool,
}

impl Renderer {
    /// Begins to add frames of `size` up, in place of those that were added before. Errors: INVALID_ARGUMENT for a size
    /// beyond images', OUT_OF_MEMORY.
    pub fn begin_accumulation(&mut self, size @ [width, height]: [u32; 2], transparent: bool) -> Result<()> {
        Layout::packed(PixelFormat::Rgba32F, width, height).check()?;
        let pixels = width as usize * height as usize;
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        const MEMORY: &str = "the light of accumulated frames";
        allocate::check_room(threads * THREAD_ROOM + 2 * pixels * size_of::<[f32; 4]>(), MEMORY)?;
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("bhr-film-{i}"));
        let pool = builder.start_handler(|_| begin_own_thread()).build();
        let pool = pool.map_err(|e| Error::new(ErrorKind::OutOfMemory, format!("could not start threads: {e}")))?;
        // Once all of them run, they have what threads take at their start, which is not ours to refuse.
        pool.broadcast(|_| ());
        let black = || filled(pixels, [0.0; 4], MEMORY);
        let (sum, next) = (black()?, black()?);
        self.accumulation = Some(Accumulation { size, transparent, sum, weight: 0.0, frames: 0, next, pool });
        Ok(())
    }

    /// Forgets the frames that were added.
    pub fn drop_accumulation(&mut self) {
        self.accumulation = None;
    }

    /// Renders the scene as it is, a whole frame, and adds its light times `weight`. After an error nothing is added.
    ///
    /// Errors: INVALID_STATE where nothing was begun, or too much was added; INVALID_ARGUMENT for a weight out of
    /// range; as [`Self::render`].
    pub fn accumulate(&mut self, weight: f64, progress: &mut Progress<'_>) -> Result<()> {
        let start = Instant::now();
        if !(LEAST_WEIGHT..=MOST_WEIGHT).contains(&weight) {
            return Err(out_of_range("weight", weight, LEAST_WEIGHT, MOST_WEIGHT));
        }
        let begun = self.begun()?;
        if begun.frames == MOST_FRAMES {
            return Err(Error::state(format!("{MOST_FRAMES} frames are accumulated; more cannot be")));
        }
        let (size, transparent) = (begun.size, begun.transparent);
        let request = self.request(PixelFormat::Rgba32F, size, transparent, None)?;
        let mut next = std::mem::take(&mut self.begun_mut()?.next);
        let rendered = self.render_light(&request, &mut next, progress);
        let begun = self.begun_mut()?;
        begun.next = next;
        let stats = rendered?;
        let Accumulation { sum, next, pool, .. } = begun;
        let weight_f32 = weight as f32;
        pool.install(|| {
            sum.par_iter_mut().zip(&*next).with_min_len(4096).for_each(|(sum, light)| {
                sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += weight_f32 * light);
            });
        });
        begun.weight += weight;
        begun.frames += 1;
        self.stats.publish(stats, start.elapsed());
        Ok(())
    }

    /// Renders the scene's light into `light`. Errors: as [`Self::render`].
    fn render_light(
        &mut self,
        request: &FrameRequest,
        light: &mut [[f32; 4]],
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let scene = self.behind(&request.region, [request.width, request.height])?;
        let width = request.width as usize;
        let mut sink = |tile: Tile, pixels: &[u8], row_bytes: usize| {
            for (row, bytes) in pixels.chunks(row_bytes).take(tile.height as usize).enumerate() {
                let begin = (tile.y as usize + row) * width + tile.x as usize;
                let out = light.get_mut(begin..begin + tile.width as usize);
                let out = out.ok_or_else(|| Error::internal("a tile beyond its frame"))?;
                for (out, bytes) in out.iter_mut().zip(bytes.as_chunks::<16>().0) {
                    *out = bytemuck::pod_read_unaligned(bytes);
                }
            }
            Ok(())
        };
        self.tracer.lock().render(&scene, request, &mut sink, progress)
    }

    /// Develops the mean of the frames that were added, by the film as it is, into `target`, and forgets them. After an
    /// error they are kept.
    ///
    /// Errors: INVALID_STATE where no frame was added; INVALID_ARGUMENT for a target of another size or transparency,
    /// or of R32F; OUT_OF_MEMORY.
    pub fn end_accumulation(&mut self, target: &mut ImageMut<'_>, transparent: bool) -> Result<()> {
        let start = Instant::now();
        let begun = self.begun()?;
        let (size, format) = ([target.width(), target.height()], target.format());
        if begun.frames == 0 {
            return Err(Error::state("no frame is accumulated; bhr_accumulate adds one"));
        }
        if size != begun.size {
            let ([width, height], [w, h]) = (size, begun.size);
            return Err(Error::argument(format!(
                "the target is {width} x {height}; the frames were begun as {w} x {h}"
            )));
        }
        if transparent != begun.transparent {
            let (asked, begun) = if transparent { ("", "out") } else { ("out", "") };
            return Err(Error::argument(format!(
                "the target is with{asked} BHR_IMAGE_TRANSPARENT, and the frames were begun with{begun}"
            )));
        }
        if format == PixelFormat::R32F {
            return Err(Error::argument("format R32F holds views other than LIGHT, and light is what is accumulated"));
        }
        let (film, lut) = (self.scene.film, self.scene.shown_lut().cloned());
        let begun = self.begun_mut()?;
        let Accumulation { sum, next, pool, weight, .. } = begun;
        let share = (1.0 / *weight) as f32;
        let developed = pool.install(|| {
            next.par_iter_mut().zip(&*sum).with_min_len(4096).for_each(|(mean, sum)| *mean = sum.map(|v| v * share));
            let row_bytes = size[0] as usize * format.bytes_per_pixel();
            develop_whole((&film, lut.as_deref()), (format, transparent), size, next, &mut |y, pixels| {
                target.write_tile(0, y, size[0], (pixels.len() / row_bytes) as u32, pixels, row_bytes)
            })
        });
        let auto_ev = developed.map_err(|mut error| {
            if target.is_touched() {
                error.message += PARTLY_WRITTEN;
            }
            error
        })?;
        self.accumulation = None;
        self.stats.publish(FrameStats { auto_ev, ..FrameStats::default() }, start.elapsed());
        Ok(())
    }

    fn begun(&self) -> Result<&Accumulation> {
        self.accumulation.as_ref().ok_or_else(not_begun)
    }

    fn begun_mut(&mut self) -> Result<&mut Accumulation> {
        self.accumulation.as_mut().ok_or_else(not_begun)
    }
}

fn not_begun() -> Error {
    Error::state("no frames are being accumulated; bhr_begin_accumulation begins")
}
