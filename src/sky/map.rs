//! Pictures of the whole sky as both tracers read them: an equirectangular pyramid of RGB9E5 texels, filtered so that a texel is as wide on
//! the sky as it is high, everywhere. `filter.rs` reads it. Knows the host's pixel formats, but neither holes nor cameras.
//!
//! Row 0 ends at the north pole of the sky axes, the last row at the south pole. The middle column is right ascension 0, which
//! grows to the left, as on the maps of astronomers: the picture looks as the sky does from inside. With (u, v) in [0, 1) from the top left,
//! RA = 360 deg (1/2 - u), declination = 180 deg (1/2 - v).

use crate::error::{Error, ErrorKind, Result};
use crate::image::{ImageRef, PixelFormat, file::srgb_to_linear};
use parking_lot::Mutex;
use std::f64::consts::PI;

/// Rows that a thread takes at a time, and texels of a level that are worth a thread.
const BAND: usize = 16;
const TEXELS_A_THREAD: usize = 1 << 15;

/// Largest level, texels: larger pictures are reduced to it.
pub const MAX_MAP_SIZE: [u32; 2] = [16384, 8192];

/// A picture of the whole sky.
pub struct SkyMap {
    /// Finest first; each has half the columns and rows of the one before, rounded down, and the last is one texel: the mean.
    levels: Vec<Level>,
}

/// One level of a [`SkyMap`].
pub struct Level {
    pub size: [u32; 2],
    /// Row by row; `pack`.
    pub texels: Vec<u32>,
}

/// What a level is made from: its size, and what writes a row of it as linear Rec. 709 light.
struct Source<'a> {
    size: [u32; 2],
    row: &'a RowReader<'a>,
}

/// Writes the row of this number. Light may be anything: NaN and what is negative count as 0.
pub type RowReader<'a> = dyn Fn(u32, &mut [[f32; 3]]) + Sync + 'a;

impl std::fmt::Debug for SkyMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SkyMap").field("size", &self.levels.first().map(|level| level.size)).finish_non_exhaustive()
    }
}

impl SkyMap {
    /// Of the host's picture, which is read before this returns; alpha does not count. Errors: INVALID_ARGUMENT for R32F; OUT_OF_MEMORY.
    pub fn new(image: &ImageRef<'_>) -> Result<Self> {
        let size = [image.width(), image.height()];
        let eight_bit = |order: [usize; 3]| {
            let decoded: [f32; 256] = std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0));
            Self::of_rows(size, &move |y, out| {
                for (out, pixel) in out.iter_mut().zip(image.row(y).as_chunks::<4>().0) {
                    *out = order.map(|channel| decoded[usize::from(pixel[channel])]);
                }
            })
        };
        match image.format() {
            PixelFormat::Rgba8Srgb => eight_bit([0, 1, 2]),
            PixelFormat::Bgra8Srgb => eight_bit([2, 1, 0]),
            PixelFormat::Rgba16F => Self::of_rows(size, &|y, out| {
                let half = |low: u8, high: u8| half::f16::from_ne_bytes([low, high]).to_f32();
                for (out, [r0, r1, g0, g1, b0, b1, ..]) in out.iter_mut().zip(image.row(y).as_chunks::<8>().0) {
                    *out = [half(*r0, *r1), half(*g0, *g1), half(*b0, *b1)];
                }
            }),
            PixelFormat::Rgba32F => Self::of_rows(size, &|y, out| {
                for (out, pixel) in out.iter_mut().zip(image.row(y).as_chunks::<16>().0) {
                    let channels = pixel.as_chunks::<4>().0;
                    *out = std::array::from_fn(|c| channels.get(c).map_or(0.0, |bytes| f32::from_ne_bytes(*bytes)));
                }
            }),
            PixelFormat::R32F => Err(Error::argument(
                "equirect format is R32F; a sky map has colours: RGBA8_SRGB, BGRA8_SRGB, RGBA16F or RGBA32F",
            )),
        }
    }

    /// Of `size`, not 0, and its rows. Errors: OUT_OF_MEMORY.
    pub fn of_rows(size: [u32; 2], row: &RowReader<'_>) -> Result<Self> {
        let finest = [0, 1].map(|i| size[i].min(MAX_MAP_SIZE[i]));
        let mut levels = vec![Level::new(&Source { size, row }, finest)?];
        while let Some(last) = levels.last().filter(|level| level.size != [1, 1]) {
            let read = |y: u32, out: &mut [[f32; 3]]| {
                out.iter_mut().zip(last.row(y)).for_each(|(out, texel)| *out = unpack(*texel));
            };
            let next = Level::new(&Source { size: last.size, row: &read }, last.size.map(|side| (side / 2).max(1)))?;
            levels.push(next);
        }
        Ok(Self { levels })
    }

    pub fn levels(&self) -> &[Level] {
        &self.levels
    }
}

impl Level {
    /// The source's light, averaged over the solid angle of each texel of `size`, which is at most the source's.
    fn new(source: &Source<'_>, size: [u32; 2]) -> Result<Self> {
        let [width, height] = size.map(|side| side as usize);
        let mut texels = Vec::new();
        texels.try_reserve_exact(width * height).map_err(|_| {
            Error::new(
                ErrorKind::OutOfMemory,
                format!("a sky map of {width} x {height} texels does not fit into memory"),
            )
        })?;
        texels.resize(width * height, 0);
        // Threads of their own: in a pool, one that waits for a map could come to wait for itself.
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        let threads = cores.min(texels.len() / TEXELS_A_THREAD);
        let bands = Mutex::new(texels.chunks_mut(BAND * width).zip((0_u32..).step_by(BAND)));
        let work = || {
            let mut scratch = Scratch::new(source.size[0] as usize, width);
            loop {
                let Some((texels, first)) = bands.lock().next() else { break };
                for (texels, y) in texels.chunks_mut(width).zip(first..) {
                    scratch.fill_row(source, size, y, texels);
                }
            }
        };
        std::thread::scope(|scope| {
            for i in 1..threads {
                let thread = std::thread::Builder::new().name(format!("bhr-sky-{i}"));
                if thread.spawn_scoped(scope, work).is_err() {
                    break;
                }
            }
            work();
        });
        Ok(Self { size, texels })
    }

    /// The texels of row `y`; empty past the last.
    pub fn row(&self, y: u32) -> &[u32] {
        let width = self.size[0] as usize;
        self.texels.get(y as usize * width..(y as usize + 1) * width).unwrap_or(&[])
    }
}

/// What making a row takes.
struct Scratch {
    /// A row of the source.
    read: Vec<[f32; 3]>,
    /// The mean of its rows.
    sum: Vec<[f64; 3]>,
    /// The row, and its sums up to each texel.
    row: Vec<[f64; 3]>,
    up_to: Vec<[f64; 3]>,
}

fn add(sum: &mut [f64; 3], weight: f64, light: [f64; 3]) {
    (0..3).for_each(|c| sum[c] += weight * light[c]);
}

/// The parts of the source that make up item `index` of `count`: of each its index and how much of it, as a share of itself.
fn parts(index: usize, count: usize, source: usize) -> impl Iterator<Item = (usize, f64, f64)> {
    let scale = source as f64 / count as f64;
    let (begin, end) = (index as f64 * scale, (index + 1) as f64 * scale);
    let last = (end.ceil() as usize).min(source);
    (begin as usize..last).map(move |i| (i, begin.max(i as f64), end.min((i + 1) as f64)))
}

impl Scratch {
    fn new(source_width: usize, width: usize) -> Self {
        Self {
            read: vec![[0.0; 3]; source_width],
            sum: vec![[0.0; 3]; source_width],
            row: vec![[0.0; 3]; width],
            up_to: vec![[0.0; 3]; width + 1],
        }
    }

    /// Makes row `y` of a level of `size`.
    fn fill_row(&mut self, source: &Source<'_>, size: [u32; 2], y: u32, texels: &mut [u32]) {
        self.gather(source, size[1], y);
        self.shrink();
        self.blur(blur_width(size, y));
        for (texel, light) in texels.iter_mut().zip(&self.row) {
            *texel = pack(light.map(|v| v as f32));
        }
    }

    /// `sum`: the source's rows under row `y` of `height`, weighted by solid angle.
    fn gather(&mut self, source: &Source<'_>, height: u32, y: u32) {
        self.sum.fill([0.0; 3]);
        let step = PI / f64::from(source.size[1]);
        let mut total = 0.0;
        for (row, begin, end) in parts(y as usize, height as usize, source.size[1] as usize) {
            self.read.fill([0.0; 3]);
            (source.row)(row as u32, &mut self.read);
            // cos(begin) - cos(end), without cancellation.
            let weight = (0.5 * (begin + end) * step).sin() * (0.5 * (end - begin) * step).sin();
            total += weight;
            for (sum, light) in self.sum.iter_mut().zip(&self.read) {
                add(sum, weight, light.map(|v| f64::from(limited(v))));
            }
        }
        self.sum.iter_mut().for_each(|sum| *sum = sum.map(|v| v / total));
    }

    /// `row`: the columns of `sum` under each of its own.
    fn shrink(&mut self) {
        let (width, source) = (self.row.len(), self.sum.len());
        if width == source {
            self.row.copy_from_slice(&self.sum);
            return;
        }
        let share = width as f64 / source as f64;
        for (x, out) in self.row.iter_mut().enumerate() {
            *out = [0.0; 3];
            for (column, begin, end) in parts(x, width, source) {
                add(out, (end - begin) * share, self.sum[column]);
            }
        }
    }

    /// Averages `row` over `texels` of them (1 .. its length) around each, around the sky.
    fn blur(&mut self, texels: f64) {
        let width = self.row.len();
        if texels <= 1.0 {
            return;
        }
        let mut sum = [0.0; 3];
        for (up_to, light) in self.up_to.iter_mut().skip(1).zip(&self.row) {
            add(&mut sum, 1.0, *light);
            *up_to = sum;
        }
        // The sum over [0, x), x in columns, may lie beyond the seam.
        let (row, up_to) = (&self.row, &self.up_to);
        let sum_to = |x: f64| {
            let turns = (x / width as f64).floor();
            let x = x - turns * width as f64;
            let column = (x as usize).min(width - 1);
            let mut part = up_to[column];
            add(&mut part, x - column as f64, row[column]);
            add(&mut part, turns, sum);
            part
        };
        let blurred = |x: usize| {
            let middle = x as f64 + 0.5;
            let (begin, end) = (sum_to(middle - 0.5 * texels), sum_to(middle + 0.5 * texels));
            // Rounding may leave less than nothing.
            std::array::from_fn(|c| ((end[c] - begin[c]) / texels).max(0.0))
        };
        self.row = (0..width).map(blurred).collect();
    }
}

/// Texels along longitude that row `y` of a level is averaged over: as many as make it as wide on the sky as it is high. The rows
/// at the poles, where all longitudes meet, become constant.
fn blur_width([width, height]: [u32; 2], y: u32) -> f64 {
    if y == 0 || y + 1 == height {
        return width.into();
    }
    let colatitude = PI * (f64::from(y) + 0.5) / f64::from(height);
    (f64::from(width) / (2.0 * f64::from(height) * colatitude.sin())).min(width.into())
}

/// Largest number that RGB9E5 holds: 511 / 512 2^16.
const MAX_LIGHT: f32 = 65408.0;

/// What can be stored: NaN and negative light become 0, infinite light the largest.
fn limited(v: f32) -> f32 {
    // As a positive condition: false for NaN.
    if v > 0.0 { v.min(MAX_LIGHT) } else { 0.0 }
}

/// RGB9E5 (EXT_texture_shared_exponent, section 3.8.x.1): three mantissas of 9 bits, red lowest, and one exponent of 5:
/// mantissa 2^(exponent - 24). Rounded to the nearest.
fn pack(rgb: [f32; 3]) -> u32 {
    let rgb = rgb.map(limited);
    let top = rgb[0].max(rgb[1]).max(rgb[2]);
    // floor(log2(top)) + 16, at least 0; multiplied by 2^(24 - exponent) the mantissas come out.
    let exponent = ((top.to_bits() >> 23).max(111) - 111).min(31);
    let rounded = |v: f32, exponent: u32| (v * f32::from_bits((151 - exponent) << 23)).round() as u32;
    let exponent = if rounded(top, exponent) > 511 { exponent + 1 } else { exponent };
    let [r, g, b] = rgb.map(|v| rounded(v, exponent).min(511));
    r | g << 9 | b << 18 | exponent << 27
}

/// Linear Rec. 709 of a texel: exact in f32, as a GPU reads it.
pub fn unpack(texel: u32) -> [f32; 3] {
    // 2^(exponent - 24), from its bits.
    let scale = f32::from_bits(((texel >> 27) + 103) << 23);
    [0, 9, 18].map(|shift| ((texel >> shift) & 511) as f32 * scale)
}
