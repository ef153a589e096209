// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames that are added up: the weighted mean of their light, developed once. Knows neither scenes nor tracers.

use crate::allocate::{self, THREAD_ROOM, filled};
use crate::error::{Error, ErrorKind, PARTLY_WRITTEN, Result, out_of_range};
use crate::film::whole::develop_whole;
use crate::image::memory::Layout;
use crate::image::{ImageMut, Lut, PixelFormat};
use crate::parallel::prelude::*;
use crate::parallel::{ThreadPool, ThreadPoolBuilder};
use crate::scene::Film;
use crate::thread_state::begin_own_thread;
use crate::tracer::Tile;

/// The weights that frames may have.
const LEAST_WEIGHT: f64 = 1e-6;
const MOST_WEIGHT: f64 = 1e6;
/// The most frames of one accumulation, so that their sum in single precision stays good to 1e-3 of a step.
const MOST_FRAMES: u32 = 65536;
/// The name of this memory in out-of-memory errors.
const LIGHT: &str = "the light of accumulated frames";

/// Frames of one size that are being added up.
pub struct Accumulation {
    pub size: [u32; 2],
    pub transparent: bool,
    /// Light times weight, and the sum of the weights.
    sum: Vec<[f32; 4]>,
    weight: f64,
    frames: u32,
    /// The light of the frame that is to be added.
    next: Vec<[f32; 4]>,
    pool: ThreadPool,
}

impl Accumulation {
    /// `threads`: of development; 0: one for each core. Errors: INVALID_ARGUMENT for a size beyond images',
    /// OUT_OF_MEMORY.
    pub fn new(size @ [width, height]: [u32; 2], transparent: bool, threads: u32) -> Result<Self> {
        Layout::packed(PixelFormat::Rgba32F, width, height).check()?;
        let pixels = width as usize * height as usize;
        let cores = || std::thread::available_parallelism().map_or(1, |n| n.get());
        let threads = if threads > 0 { threads as usize } else { cores() };
        allocate::check_room(threads * THREAD_ROOM + 2 * pixels * size_of::<[f32; 4]>(), LIGHT)?;
        let builder = ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("bhr-film-{i}"));
        let pool = builder.start_handler(|_| begin_own_thread()).build();
        let pool = pool.map_err(|e| Error::new(ErrorKind::OutOfMemory, format!("could not start threads: {e}")))?;
        // Once all of them run, they have what threads take at their start, which is not ours to refuse.
        pool.broadcast(|_| ());
        let black = || filled(pixels, [0.0; 4], LIGHT);
        let (sum, next) = (black()?, black()?);
        Ok(Self { size, transparent, sum, weight: 0.0, frames: 0, next, pool })
    }

    /// Whether a frame of this weight can be added. Errors: INVALID_ARGUMENT for the weight, INVALID_STATE after too
    /// many frames.
    pub fn check(&self, weight: f64) -> Result<()> {
        if !(LEAST_WEIGHT..=MOST_WEIGHT).contains(&weight) {
            return Err(out_of_range("weight", weight, LEAST_WEIGHT, MOST_WEIGHT));
        }
        if self.frames == MOST_FRAMES {
            return Err(Error::state(format!("{MOST_FRAMES} frames are accumulated; more cannot be")));
        }
        Ok(())
    }

    /// Takes a tile of the next frame, pixels of RGBA32F. Errors: INTERNAL for one beyond the frame.
    pub fn take(&mut self, tile: Tile, pixels: &[u8], row_bytes: usize) -> Result<()> {
        let width = self.size[0] as usize;
        for (row, bytes) in pixels.chunks(row_bytes).take(tile.height as usize).enumerate() {
            let begin = (tile.y as usize + row) * width + tile.x as usize;
            let out = self.next.get_mut(begin..begin + tile.width as usize);
            let out = out.ok_or_else(|| Error::internal("a tile beyond its frame"))?;
            for (out, bytes) in out.iter_mut().zip(bytes.as_chunks::<16>().0) {
                *out = bytemuck::pod_read_unaligned(bytes);
            }
        }
        Ok(())
    }

    /// Adds the frame whose tiles have all been taken.
    pub fn add(&mut self, weight: f64) {
        let Self { sum, next, pool, .. } = self;
        let factor = weight as f32;
        pool.install(|| {
            sum.par_iter_mut().zip(&*next).with_min_len(4096).for_each(|(sum, light)| {
                sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += factor * light);
            });
        });
        self.weight += weight;
        self.frames += 1;
    }

    /// Develops the mean of the frames that were added, by a film with a LUT, into `target`; the stops that auto
    /// exposure added.
    ///
    /// Errors: INVALID_STATE where no frame was added; INVALID_ARGUMENT for a target of another size or transparency,
    /// or of R32F; OUT_OF_MEMORY.
    pub fn develop(
        &mut self,
        film: (&Film, Option<&Lut>),
        target: &mut ImageMut<'_>,
        transparent: bool,
    ) -> Result<f64> {
        let (size, format) = ([target.width(), target.height()], target.format());
        if self.frames == 0 {
            return Err(Error::state("no frame is accumulated; bhr_accumulate adds one"));
        }
        if size != self.size {
            let ([width, height], [w, h]) = (size, self.size);
            return Err(Error::argument(format!(
                "the target is {width} x {height}; the frames were begun as {w} x {h}"
            )));
        }
        if transparent != self.transparent {
            let (asked, begun) = if transparent { ("", "out") } else { ("out", "") };
            return Err(Error::argument(format!(
                "the target is with{asked} BHR_IMAGE_TRANSPARENT, and the frames were begun with{begun}"
            )));
        }
        if format == PixelFormat::R32F {
            return Err(Error::argument("format R32F holds views other than LIGHT, and light is what is accumulated"));
        }
        let Self { sum, next, pool, weight, .. } = self;
        let share = (1.0 / *weight) as f32;
        let developed = pool.install(|| {
            next.par_iter_mut().zip(&*sum).with_min_len(4096).for_each(|(mean, sum)| *mean = sum.map(|v| v * share));
            let row_bytes = size[0] as usize * format.bytes_per_pixel();
            develop_whole(film, (format, transparent), size, next, &mut |y, pixels| {
                target.write_tile(0, y, size[0], (pixels.len() / row_bytes) as u32, pixels, row_bytes)
            })
        });
        developed.map_err(|mut error| {
            if target.is_touched() {
                error.message += PARTLY_WRITTEN;
            }
            error
        })
    }
}
