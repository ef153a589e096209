// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of the whole sky as both tracers read them: an equirectangular pyramid of RGB9E5 texels, filtered so that
//! a texel is as wide on the sky as it is high, everywhere. `filter.rs` reads it. Knows the host's pixel formats, but
//! neither holes nor cameras.
//!
//! Row 0 ends at the north pole of the sky axes, the last row at the south pole. The middle column is right ascension
//! 0, which grows to the left, as on the maps of astronomers: the picture looks as the sky does from inside. With (u,
//! v) in [0, 1) from the top left, RA = 360 deg (1/2 - u), declination = 180 deg (1/2 - v).

use crate::allocate::{THREAD_ROOM, check_room, filled};
use crate::error::{Error, Result};
use crate::image::rgb9e5::{limited, pack, unpack};
use crate::image::{ImageRef, PixelFormat, file::srgb_to_linear};
use crate::thread_state::begin_own_thread;
use parking_lot::Mutex;
use std::f64::consts::PI;

/// Rows that a thread takes at a time, and texels of a level that are worth a thread.
const BAND: usize = 16;
const TEXELS_A_THREAD: usize = 1 << 15;
/// Columns of the rows that all threads together keep, at about 100 bytes each.
const MOST_COLUMNS: usize = 1 << 22;

/// Largest level, texels: larger pictures are reduced to it.
pub const MAX_MAP_SIZE: [u32; 2] = [16384, 8192];
/// Rows that any map may have; beyond, at most four times its columns, since texels are as wide as high at least.
const TALL: u32 = 1024;

/// A picture of the whole sky.
pub struct SkyMap {
    /// The levels, the finest first, at least as wide as high. Each has half the columns and rows of the one before,
    /// rounded down, and the last is one texel: the mean.
    levels: Vec<Level>,
}

/// One level of a [`SkyMap`].
pub struct Level {
    pub size: [u32; 2],
    /// The texels row by row, as `pack` makes them.
    pub texels: Vec<u32>,
}

/// The source of a level: its size, and the function that writes a row of it as linear Rec. 709 light.
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
    /// The map of the host's picture, which is read before this returns; alpha does not count. Errors: INVALID_ARGUMENT
    /// for R32F; OUT_OF_MEMORY.
    pub fn new(image: &ImageRef<'_>) -> Result<Self> {
        let mut growing = GrowingMap::new([image.width(), image.height()])?;
        while !growing.grow_from(image, u32::MAX)? {}
        Ok(growing.done())
    }

    /// The map of a picture of `size`, not 0, and its rows. Errors: OUT_OF_MEMORY.
    pub fn of_rows(size: [u32; 2], row: &RowReader<'_>) -> Result<Self> {
        let mut growing = GrowingMap::new(size)?;
        while !growing.grow(row, u32::MAX)? {}
        Ok(growing.done())
    }

    /// A map of levels as [`Self::levels`] has them.
    pub(super) fn from_levels(levels: Vec<Level>) -> Self {
        Self { levels }
    }

    pub fn levels(&self) -> &[Level] {
        &self.levels
    }
}

/// A map that is being made, some rows at a time.
pub struct GrowingMap {
    /// The picture's size.
    size: [u32; 2],
    /// The levels so far.
    levels: Vec<Level>,
    /// Rows of the last one that are made.
    rows: u32,
}

impl GrowingMap {
    /// The map of a picture of `size`, not 0, without a row so far. Errors: OUT_OF_MEMORY.
    pub fn new(size: [u32; 2]) -> Result<Self> {
        Ok(Self { size, levels: vec![Level::empty(finest_size(size))?], rows: 0 })
    }

    /// Makes up to `count` more rows of a level; `row` reads the picture's, the same in each call. Returns whether the
    /// map is complete. Errors: OUT_OF_MEMORY.
    pub fn grow(&mut self, row: &RowReader<'_>, count: u32) -> Result<bool> {
        let Some((level, finer)) = self.levels.split_last_mut() else { return Ok(true) };
        let end = self.rows.saturating_add(count).min(level.size[1]);
        match finer.last() {
            None => level.fill(&Source { size: self.size, row }, self.rows..end)?,
            Some(finer) => {
                let read = |y: u32, out: &mut [[f32; 3]]| {
                    out.iter_mut().zip(finer.row(y)).for_each(|(out, texel)| *out = unpack(*texel));
                };
                level.fill(&Source { size: finer.size, row: &read }, self.rows..end)?;
            }
        }
        self.rows = end;
        let size = level.size;
        if end < size[1] || size == [1, 1] {
            return Ok(end == size[1]);
        }
        self.levels.push(Level::empty(size.map(|side| (side / 2).max(1)))?);
        self.rows = 0;
        Ok(false)
    }

    /// [`Self::grow`] by rows of the host's picture, the same in each call. Errors: as [`SkyMap::new`].
    pub fn grow_from(&mut self, image: &ImageRef<'_>, count: u32) -> Result<bool> {
        let mut eight_bit = |order: [usize; 3]| {
            let decoded: [f32; 256] = std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0));
            let row = |y: u32, out: &mut [[f32; 3]]| {
                for (out, pixel) in out.iter_mut().zip(image.row(y).as_chunks::<4>().0) {
                    *out = order.map(|channel| decoded[usize::from(pixel[channel])]);
                }
            };
            self.grow(&row, count)
        };
        match image.format() {
            PixelFormat::Rgba8Srgb => eight_bit([0, 1, 2]),
            PixelFormat::Bgra8Srgb => eight_bit([2, 1, 0]),
            PixelFormat::Rgba16F => self.grow(
                &|y, out| {
                    let half = |low: u8, high: u8| half::f16::from_ne_bytes([low, high]).to_f32();
                    for (out, [r0, r1, g0, g1, b0, b1, ..]) in out.iter_mut().zip(image.row(y).as_chunks::<8>().0) {
                        *out = [half(*r0, *r1), half(*g0, *g1), half(*b0, *b1)];
                    }
                },
                count,
            ),
            PixelFormat::Rgba32F => self.grow(
                &|y, out| {
                    for (out, pixel) in out.iter_mut().zip(image.row(y).as_chunks::<16>().0) {
                        let channels = pixel.as_chunks::<4>().0;
                        *out = std::array::from_fn(|c| channels.get(c).map_or(0.0, |bytes| f32::from_ne_bytes(*bytes)));
                    }
                },
                count,
            ),
            format => Err(Error::argument(format!(
                "equirect format is {format}; a sky map has colours: RGBA8_SRGB, BGRA8_SRGB, RGBA16F or RGBA32F"
            ))),
        }
    }

    /// The map, once it is complete.
    pub fn done(self) -> SkyMap {
        SkyMap { levels: self.levels }
    }
}

/// The size of the finest level of a picture of `size`, not 0.
pub(super) fn finest_size(size: [u32; 2]) -> [u32; 2] {
    let tall = size[0].saturating_mul(4).max(TALL);
    let height = size[1].min(MAX_MAP_SIZE[1]).min(tall);
    [size[0].clamp(height, MAX_MAP_SIZE[0]), height]
}

impl Level {
    fn empty(size: [u32; 2]) -> Result<Self> {
        Ok(Self { size, texels: filled(size[0] as usize * size[1] as usize, 0, "the texels of a sky map")? })
    }

    /// Some rows of the source's light, averaged over the solid angle of each texel.
    fn fill(&mut self, source: &Source<'_>, rows: std::ops::Range<u32>) -> Result<()> {
        let (size, width) = (self.size, self.size[0] as usize);
        let texels = &mut self.texels[rows.start as usize * width..rows.end as usize * width];
        let threads = threads_for(texels.len(), source.size[0] as usize);
        let bands = Mutex::new(texels.chunks_mut(BAND * width).zip((rows.start..).step_by(BAND)));
        on_threads(threads, &|| {
            let mut scratch = Scratch::new(source.size[0] as usize, width)?;
            loop {
                let Some((texels, first)) = bands.lock().next() else { return Ok(()) };
                for (texels, y) in texels.chunks_mut(width).zip(first..) {
                    let row = scratch.row_of(&mut |y, out| (source.row)(y, out), source.size[1], size, y);
                    texels.iter_mut().zip(row).for_each(|(texel, light)| *texel = pack(light.map(|v| v as f32)));
                }
            }
        })
    }

    /// The texels of row `y`; empty past the last.
    pub fn row(&self, y: u32) -> &[u32] {
        let width = self.size[0] as usize;
        self.texels.get(y as usize * width..(y as usize + 1) * width).unwrap_or(&[])
    }
}

/// How many threads so many texels of a level are worth, at most one a core, and no more than may have the memory for
/// rows of so many columns.
pub(super) fn threads_for(texels: usize, columns: usize) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    cores.min(texels / TEXELS_A_THREAD).min(MOST_COLUMNS / columns.max(1))
}

/// Runs `work` on this thread and beside it on others, so many in all: each takes parts of the whole until none is
/// left. A thread that fails must do so before it takes a part, and this one does the rest. Threads are of their own:
/// in a pool, one that waits for a map could come to wait for itself. Errors: those of `work` on this thread.
pub(super) fn on_threads(threads: usize, work: &(dyn Fn() -> Result<()> + Sync)) -> Result<()> {
    let own = || {
        begin_own_thread();
        drop(work());
    };
    std::thread::scope(|scope| {
        for i in 1..threads {
            let thread = std::thread::Builder::new().name(format!("bhr-sky-{i}"));
            // Without memory for a thread, or without a thread, there are fewer: this one is enough.
            let room = check_room(THREAD_ROOM, "a thread that makes a sky map");
            if room.is_err() || thread.spawn_scoped(scope, own).is_err() {
                break;
            }
        }
        work()
    })
}

/// The memory that making a row takes.
pub(super) struct Scratch {
    /// A row of the source.
    read: Vec<[f32; 3]>,
    /// The mean of its rows.
    sum: Vec<[f64; 3]>,
    /// The row, and its sums up to each texel.
    row: Vec<[f64; 3]>,
    up_to: Vec<[f64; 3]>,
    /// The row that is being made.
    blurred: Vec<[f64; 3]>,
}

fn add(sum: &mut [f64; 3], weight: f64, light: [f64; 3]) {
    (0..3).for_each(|c| sum[c] += weight * light[c]);
}

/// The parts of the source that make up item `index` of `count`: the index of each, and how much of it, as a share of
/// itself.
fn parts(index: usize, count: usize, source: usize) -> impl Iterator<Item = (usize, f64, f64)> {
    let scale = source as f64 / count as f64;
    let (begin, end) = (index as f64 * scale, (index + 1) as f64 * scale);
    let last = (end.ceil() as usize).min(source);
    (begin as usize..last).map(move |i| (i, begin.max(i as f64), end.min((i + 1) as f64)))
}

impl Scratch {
    /// For rows of `width` texels, from rows of a source. Errors: OUT_OF_MEMORY.
    pub(super) fn new(source_width: usize, width: usize) -> Result<Self> {
        let what = "rows of a sky map";
        Ok(Self {
            read: filled(source_width, [0.0; 3], what)?,
            sum: filled(source_width, [0.0; 3], what)?,
            row: filled(width, [0.0; 3], what)?,
            up_to: filled(width + 1, [0.0; 3], what)?,
            blurred: filled(width, [0.0; 3], what)?,
        })
    }

    /// The light of row `y` of a level of `size`, from a source of so many rows that `read` reads.
    pub(super) fn row_of(
        &mut self,
        read: &mut dyn FnMut(u32, &mut [[f32; 3]]),
        rows: u32,
        size: [u32; 2],
        y: u32,
    ) -> &[[f64; 3]] {
        self.gather(read, rows, size[1], y);
        self.shrink();
        self.blur(blur_width(size, y));
        &self.row
    }

    /// `sum`: the source's rows under row `y` of `height`, weighted by solid angle.
    fn gather(&mut self, read: &mut dyn FnMut(u32, &mut [[f32; 3]]), rows: u32, height: u32, y: u32) {
        self.sum.fill([0.0; 3]);
        let step = PI / f64::from(rows);
        let mut total = 0.0;
        for (row, begin, end) in parts(y as usize, height as usize, rows as usize) {
            self.read.fill([0.0; 3]);
            read(row as u32, &mut self.read);
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
        if texels >= width as f64 {
            self.row.fill(sum.map(|v| v / width as f64));
            return;
        }
        // The sum from column 0 to `share` of column x, which may lie one turn away.
        let (row, up_to) = (&self.row, &self.up_to);
        let sum_to = |x: isize, share: f64| {
            let (turn, column) = match usize::try_from(x) {
                Ok(x) if x < width => (0.0, x),
                Ok(x) => (1.0, x - width),
                Err(_) => (-1.0, x.wrapping_add_unsigned(width) as usize),
            };
            // The indices are in bounds, as no more than a turn is averaged; a row is not longer than its sums.
            let (Some(up_to), Some(light)) = (up_to.get(column), row.get(column)) else { return sum };
            std::array::from_fn::<f64, 3, _>(|c| up_to[c] + share * light[c] + turn * sum[c])
        };
        let [begin, end] = [0.5 - 0.5 * texels, 0.5 + 0.5 * texels].map(|at| (at.floor() as isize, at - at.floor()));
        let blurred = |x: usize| {
            let from = sum_to(begin.0.wrapping_add_unsigned(x), begin.1);
            let to = sum_to(end.0.wrapping_add_unsigned(x), end.1);
            // Rounding may leave less than nothing.
            std::array::from_fn(|c| ((to[c] - from[c]) / texels).max(0.0))
        };
        self.blurred.iter_mut().enumerate().for_each(|(x, out)| *out = blurred(x));
        std::mem::swap(&mut self.row, &mut self.blurred);
    }
}

/// Texels along longitude that row `y` of a level is averaged over: as many as make it as wide on the sky as it is
/// high. The rows at the poles, where all longitudes meet, become constant.
pub(super) fn blur_width([width, height]: [u32; 2], y: u32) -> f64 {
    if y == 0 || y + 1 == height {
        return width.into();
    }
    let colatitude = PI * (f64::from(y) + 0.5) / f64::from(height);
    (f64::from(width) / (2.0 * f64::from(height) * colatitude.sin())).min(width.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::image::Layout;

    const FORMATS: [PixelFormat; 4] =
        [PixelFormat::Rgba8Srgb, PixelFormat::Bgra8Srgb, PixelFormat::Rgba16F, PixelFormat::Rgba32F];

    /// Light that differs in every channel, by column and row.
    fn pattern(x: u32, y: u32) -> [f32; 3] {
        let v = |k: u32| ((x * 37 + y * 101 + k * 59) % 97) as f32 / 97.0;
        [0.1 + v(0), v(1) * 3.0 + 0.2, v(2) + 0.3]
    }

    fn of_pattern(size: [u32; 2]) -> SkyMap {
        SkyMap::of_rows(size, &|y, out| (0..).zip(out).for_each(|(x, out)| *out = pattern(x, y))).unwrap()
    }

    /// The light of a level times solid angle, over 4 pi.
    fn mean(level: &Level) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let step = PI / f64::from(level.size[1]);
        for y in 0..level.size[1] {
            let weight = ((f64::from(y) * step).cos() - (f64::from(y + 1) * step).cos()) / 2.0;
            for texel in level.row(y) {
                add(&mut sum, weight / f64::from(level.size[0]), unpack(*texel).map(f64::from));
            }
        }
        sum
    }

    #[test]
    fn a_map_that_grows_is_the_one_made_at_once() {
        let size = [67, 31];
        let row = |y: u32, out: &mut [[f32; 3]]| (0..).zip(out).for_each(|(x, out)| *out = pattern(x, y));
        let mut growing = GrowingMap::new(size).unwrap();
        let mut calls = 1;
        while !growing.grow(&row, 5).unwrap() {
            calls += 1;
        }
        // 31, 15, 7, 3, 1 and 1 rows, and 1 of one texel.
        assert_eq!(calls, 7 + 3 + 2 + 4);
        let (made, at_once) = (growing.done(), of_pattern(size));
        assert_eq!(made.levels.len(), at_once.levels.len());
        for (a, b) in made.levels.iter().zip(&at_once.levels) {
            assert!(a.size == b.size && a.texels == b.texels, "{:?}", a.size);
        }
    }

    #[test]
    fn levels_halve_down_to_one_texel_and_keep_the_mean() {
        for size in [[1, 1], [2, 1], [1, 7], [64, 32], [37, 53], [300, 11]] {
            let map = of_pattern(size);
            let levels = map.levels();
            assert_eq!(levels[0].size, [size[0].max(size[1]), size[1]]);
            assert!(levels.windows(2).all(|pair| pair[1].size == pair[0].size.map(|side| (side / 2).max(1))));
            assert_eq!(levels.last().unwrap().size, [1, 1]);
            let wanted = mean(&levels[0]);
            for level in levels {
                let found = mean(level);
                for c in 0..3 {
                    assert!(
                        (found[c] - wanted[c]).abs() < 3e-3 * wanted[1],
                        "{size:?} {:?}: {found:?} {wanted:?}",
                        level.size
                    );
                }
            }
        }
    }

    /// The equator's rows of a map twice as wide as high are the picture's, to a texel that is hardly wider than high.
    #[test]
    fn rows_are_as_wide_as_high_and_constant_at_the_poles() {
        let size = [64, 32];
        let spike = |x: u32, row: u32| {
            SkyMap::of_rows(size, &move |y, out| out[x as usize] = [f32::from(u8::from(y == row)); 3]).unwrap()
        };
        for row in [0, 31] {
            let map = spike(40, row);
            let texels = map.levels()[0].row(row);
            assert!(texels.iter().all(|texel| *texel == texels[0] && *texel != 0), "row {row}");
        }
        for row in [1, 5, 15, 16, 30] {
            // Across the seam too.
            for x in [0, 20, 63] {
                let map = spike(x, row);
                let values = map.levels()[0].row(row).iter().map(|t| f64::from(unpack(*t)[0])).collect::<Vec<_>>();
                let sum = values.iter().sum::<f64>();
                assert!((sum - 1.0).abs() < 0.02, "row {row} x {x}: {sum}");
                let width = sum / values[x as usize];
                let wanted = 1.0 / (PI * (f64::from(row) + 0.5) / 32.0).sin();
                assert!((width / wanted - 1.0).abs() < 0.02, "row {row}: {width}, wanted {wanted}");
            }
        }
    }

    /// Every format says the same; alpha and what lies between rows do not matter; bottom-up images neither.
    #[test]
    fn formats_and_strides() {
        let codes = |x: u32, y: u32| [(x * 50 + y) as u8, (y * 60) as u8, 200 - (x * 30) as u8];
        let mut maps = Vec::new();
        for format in FORMATS {
            for stride in [0_i64, 80, -96] {
                let (width, height) = (5, 4);
                let step = if stride == 0 { 5 * format.bytes_per_pixel() } else { stride.unsigned_abs() as usize };
                let mut block = vec![0xff; 4 * step];
                for y in 0..height {
                    for x in 0..width {
                        let rgb = codes(x, y);
                        let linear = rgb.map(|code| srgb_to_linear(f32::from(code) / 255.0));
                        let bytes = match format {
                            PixelFormat::Rgba8Srgb => vec![rgb[0], rgb[1], rgb[2], 7],
                            PixelFormat::Bgra8Srgb => vec![rgb[2], rgb[1], rgb[0], 9],
                            PixelFormat::Rgba16F => linear
                                .iter()
                                .chain(&[0.25])
                                .flat_map(|v| half::f16::from_f32(*v).to_ne_bytes())
                                .collect(),
                            _ => linear.iter().chain(&[f32::NAN]).flat_map(|v| v.to_ne_bytes()).collect(),
                        };
                        let line = if stride < 0 { height - 1 - y } else { y } as usize;
                        block[line * step + x as usize * bytes.len()..][..bytes.len()].copy_from_slice(&bytes);
                    }
                }
                if (stride.unsigned_abs() as usize) < 5 * format.bytes_per_pixel() && stride != 0 {
                    continue;
                }
                let image = ImageRef::new(Layout { format, width, height, row_stride: stride }, &block).unwrap();
                maps.push(SkyMap::new(&image).unwrap());
            }
        }
        for map in &maps {
            for (a, b) in map.levels()[0].texels.iter().zip(&maps[0].levels()[0].texels) {
                let (a, b) = (unpack(*a), unpack(*b));
                let top = b[0].max(b[1]).max(b[2]);
                // Halves have 11 bits.
                assert!((0..3).all(|c| (a[c] - b[c]).abs() <= top / 250.0), "{a:?} {b:?}");
            }
        }
        let block = [0; 16];
        let values = ImageRef::new(Layout::packed(PixelFormat::R32F, 2, 2), &block).unwrap();
        let error = SkyMap::new(&values).unwrap_err();
        assert!(error.kind == ErrorKind::InvalidArgument && error.message.contains("R32F"));
    }

    #[test]
    fn content_of_any_kind_is_finite_light() {
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, 1e-40, 0.0] {
            let map = SkyMap::of_rows([31, 17], &|_, out| out.fill([odd, 1.0, odd])).unwrap();
            for level in map.levels() {
                for texel in &level.texels {
                    let [r, g, b] = unpack(*texel);
                    let wanted = limited(odd.max(0.0)) * f32::from(u8::from(odd > 1.0));
                    assert!(
                        (r / wanted.max(1e-9) - f32::from(u8::from(wanted > 0.0))).abs() < 1e-2 && r == b,
                        "{odd}: {r}"
                    );
                    assert!((g - 1.0).abs() < if odd > 1.0 { 64.1 } else { 2e-3 }, "{odd}: {g}");
                }
            }
        }
    }

    /// Larger pictures than a map may be are averaged, not picked from.
    #[test]
    fn large_pictures_are_reduced() {
        let size = [MAX_MAP_SIZE[0] * 2 + 2, 3];
        let map =
            SkyMap::of_rows(size, &|_, out| (0..).zip(out).for_each(|(x, out)| *out = [(x % 2) as f32; 3])).unwrap();
        assert_eq!(map.levels()[0].size, [MAX_MAP_SIZE[0], 3]);
        assert!(map.levels()[0].row(1).iter().all(|texel| (unpack(*texel)[0] - 0.5).abs() < 2e-3));
        let mut level = Level::empty([3, 2]).unwrap();
        level.fill(&Source { size: [7, 5], row: &|y, out| out.fill([y as f32; 3]) }, 0..2).unwrap();
        let edge = |y: f64| (PI * y / 5.0).cos();
        let upper = (1.0 * (edge(1.0) - edge(2.0)) + 2.0 * (edge(2.0) - edge(2.5))) / (1.0 - edge(2.5));
        assert!((f64::from(unpack(level.row(0)[1])[0]) / upper - 1.0).abs() < 2e-3);
    }
}
