// SPDX-License-Identifier: MIT OR Apache-2.0
//! The streaks that the disk's turbulence is made of: noise drawn once for a process into a picture that repeats in
//! azimuth and in ln r, filtered over the patch that a pixel sees of it. Mirrored by `shaders/emit/streaks.wgsl`, which
//! reads the same texels. Knows neither orbits nor time.
//!
//! The picture holds g, from which a factor e^(s g) / mean(e^(s g)) on the disk's light is made. Seven octaves of
//! gradient noise (Perlin 2002), drawn out along the orbit and displaced along the radius by coarser noise, add up to
//! it; some are folded, n -> |n|, so that they have creases: dark lanes. Each row has the mean 0, so that nothing of it
//! is a ring, however often orbits wind it up.
//!
//! A pixel shows the mean of e^(s g) over its patch, which the mean of g does not tell. So each texel holds e^g, too.
//! ln mean(e^g) - mean(g) over a patch is what has been filtered away, in terms of light; over the whole picture it is
//! ln M(1), M(s) being the mean of e^(s g) there. For other s it is taken to grow as ln M(s) does ([`Patch`]). So the
//! mean light stays whatever the filter, and at s = 1, where one pattern shows alone, the light of a patch is its mean.

use super::lattice::Between;
use crate::allocate::{collected, filled, with_room};
use crate::error::{Error, Result};
use crate::random::mix;
use half::f16;
use std::f64::consts::SQRT_2;
use std::sync::OnceLock;

/// Texels of the picture in azimuth, where it goes around the disk once, and in ln r.
pub(crate) const STREAK_COLUMNS: usize = 1024;
pub(crate) const STREAK_ROWS: usize = 512;
/// The range of ln r after which the picture repeats.
pub(crate) const STREAK_PERIOD: f64 = 0.5;
/// The number of the last level of the pyramid, of one texel; each is half as wide and high as the one before.
pub(crate) const STREAK_LAST: usize = STREAK_COLUMNS.ilog2() as usize;
/// The standard deviation of g.
const DEVIATION: f32 = 0.75;
/// ln M(s) = s^2 (c0 + c1 s + c2 s^2): c0 is half the variance, the others make it exact at s = 1/2 and 1.
pub(crate) const STREAK_CUMULANTS: [f64; 3] = [0.281_25, 0.021_400, -0.007_146];

/// The longest side of a patch in shorter sides, and so the most taps: a longer one is taken for a wider one. Streaks
/// are far longer than wide, so that a little more blur along them is not seen.
pub(crate) const STREAK_TAPS: f64 = 8.0;
/// A texel of the level of which taps are taken, in shorter sides of the patch, as near as levels come to it: found by
/// trial, with the mean light of patches for the truth. More taps of one level each are nearer to it than fewer ones
/// that are interpolated between levels, which cost as much.
pub(crate) const STREAK_TEXEL: f64 = 0.65;
/// Squared texels. Patches of more, or of unknown size, get the mean of all.
pub(crate) const STREAK_WHOLE: f64 = 1e12;

const OCTAVES: u32 = 7;
/// Cells of the coarsest octave in the picture, along either side; the next octave has twice as many. A cell is
/// twelve times as long as wide.
const CELLS: usize = 3;
/// The amplitude of an octave over that of the one before.
const FAINTER: f32 = 0.72;
/// How far noise is displaced, in cells of the coarsest octave at noise 1.
const DISPLACED: f32 = 1.2;
/// The share of creases in the octaves that have them; the factor and the offset give |n| the variance and mean of n.
const CREASE: f32 = 0.35;
const CREASED: std::ops::Range<u32> = 1..5;
const CREASE_GAIN: f32 = 1.6;
const CREASE_OFFSET: f32 = 0.25;
/// Standard deviations that values stay below.
const BRIGHTEST: f32 = 5.0;

/// The means of g and of e^g over a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    pub mean: f64,
    pub light: f64,
}

impl Patch {
    /// ln of the mean of e^(s g) over the patch, over that of the whole picture; s in 0 .. 1.
    pub fn exponent(&self, s: f64) -> f64 {
        let [c0, c1, c2] = STREAK_CUMULANTS;
        let lost = (self.light.ln() - self.mean) / (c0 + c1 + c2);
        s * self.mean + s * s * (c0 + s * (c1 + s * c2)) * (lost - 1.0)
    }
}

/// The picture and its pyramid.
pub struct Streaks {
    /// g and e^g, rounded to f16, level after level, row by row.
    texels: Vec<[f32; 2]>,
    levels: [Level; STREAK_LAST + 1],
}

#[derive(Clone, Copy, Default)]
struct Level {
    begin: usize,
    columns: usize,
    rows: usize,
}

/// Gradient noise on a lattice that goes around.
struct Noise {
    cells: usize,
    slopes: Vec<[f32; 2]>,
}

impl Noise {
    /// `finer`: twice as many cells so many times.
    fn new(finer: u32, key: u32) -> Result<Self> {
        let cells = CELLS << finer;
        let count = (cells * cells) as u32;
        let part = |bits: u32| bits as f32 / 32767.5 - 1.0;
        let slope = |i: u32| mix(i.wrapping_add(mix(key)));
        let slopes = (0..count).map(slope).map(|h| [part(h & 0xffff), part(h >> 16)]);
        Ok(Self { cells, slopes: collected(slopes, "the disk's streaks")? })
    }

    fn columns(&self) -> Result<Vec<Between>> {
        let width = self.cells as f32 / STREAK_COLUMNS as f32;
        let columns = (0..STREAK_COLUMNS).map(|x| Between::new((x as f32 + 0.5) * width, self.cells));
        collected(columns, "the disk's streaks")
    }

    /// At a column, and a row in periods from 0 to 3.
    fn at(&self, x: &Between, row: f32) -> f32 {
        let y = Between::new(row * self.cells as f32, self.cells);
        let corner = |i: usize, j: usize| {
            let [a, b] = self.slopes[y.sides[j] * self.cells + x.sides[i]];
            a * (x.offset - i as f32) + b * (y.offset - j as f32)
        };
        let low = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * x.share;
        let high = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * x.share;
        low + (high - low) * y.share
    }
}

static SHARED: OnceLock<Streaks> = OnceLock::new();

/// The streaks while they are drawn. Only operations that every machine rounds alike.
pub struct Drawing {
    /// The octaves, and each one's columns.
    noises: Vec<Noise>,
    columns: Vec<Vec<Between>>,
    displacement: [Noise; 2],
    /// The sum of the octaves, row by row.
    sums: Vec<f32>,
}

impl Drawing {
    /// A new drawing; `None`: [`Streaks::shared`] has its picture already. Errors: OUT_OF_MEMORY.
    pub fn begun() -> Result<Option<Self>> {
        if SHARED.get().is_some() {
            return Ok(None);
        }
        let noises = (0..OCTAVES).map(|octave| Noise::new(octave, octave)).collect::<Result<Vec<_>>>()?;
        let columns = noises.iter().map(Noise::columns).collect::<Result<Vec<_>>>()?;
        let displacement = [Noise::new(0, OCTAVES)?, Noise::new(1, OCTAVES + 1)?];
        let sums = with_room(STREAK_COLUMNS * STREAK_ROWS, "the disk's streaks")?;
        Ok(Some(Self { noises, columns, displacement, sums }))
    }

    /// Draws up to `rows` more rows, or, after the last one, finishes the picture. Returns what is left to do; `None`:
    /// it is complete. Errors: OUT_OF_MEMORY.
    pub fn draw(mut self, rows: usize) -> Result<Option<Self>> {
        if SHARED.get().is_some() {
            return Ok(None);
        }
        let first = self.sums.len() / STREAK_COLUMNS;
        if first == STREAK_ROWS {
            let streaks = Streaks::new(&finished(self.sums))?;
            SHARED.get_or_init(|| streaks);
            return Ok(None);
        }
        for y in first..first.saturating_add(rows).min(STREAK_ROWS) {
            self.draw_row(y);
        }
        Ok(Some(self))
    }

    fn draw_row(&mut self, y: usize) {
        let row = 1.0 + (y as f32 + 0.5) / STREAK_ROWS as f32;
        for x in 0..STREAK_COLUMNS {
            let [coarse, fine] = [0, 1].map(|k| self.displacement[k].at(&self.columns[k][x], row));
            let displaced = row + (DISPLACED / CELLS as f32) * (coarse + 0.5 * fine);
            let (mut sum, mut amplitude) = (0.0, 1.0);
            for ((noise, columns), octave) in self.noises.iter().zip(&self.columns).zip(0..) {
                let plain = noise.at(&columns[x], displaced);
                let crease = if CREASED.contains(&octave) { CREASE } else { 0.0 };
                sum += amplitude * (plain + crease * (CREASE_GAIN * plain.abs() - CREASE_OFFSET - plain));
                amplitude *= FAINTER;
            }
            self.sums.push(sum);
        }
    }
}

/// The picture, g row by row, of the sums of its octaves.
fn finished(mut all: Vec<f32>) -> Vec<f32> {
    let deviation = |all: &[f32]| (all.iter().map(|g| g * g).sum::<f32>() / all.len() as f32).sqrt();
    let unit = deviation(&all).recip();
    for row in all.chunks_mut(STREAK_COLUMNS) {
        let bounded = |g: f32| g * unit / (1.0 + (g * unit / BRIGHTEST).powi(2)).sqrt();
        row.iter_mut().for_each(|g| *g = bounded(*g));
        let mean = row.iter().sum::<f32>() / row.len() as f32;
        row.iter_mut().for_each(|g| *g -= mean);
    }
    let scale = DEVIATION / deviation(&all);
    all.iter_mut().for_each(|g| *g *= scale);
    all
}

fn rounded(pair: [f32; 2]) -> [f32; 2] {
    pair.map(|v| f16::from_f32(v).to_f32())
}

impl Streaks {
    /// The streaks of this process, drawn at first use (some 0.1 s). Errors: OUT_OF_MEMORY.
    pub fn shared() -> Result<&'static Self> {
        let mut left = Drawing::begun()?;
        while let Some(drawing) = left {
            left = drawing.draw(STREAK_ROWS)?;
        }
        SHARED.get().ok_or_else(|| Error::internal("the streaks are drawn but missing"))
    }

    fn new(drawn: &[f32]) -> Result<Self> {
        let mut levels = [Level::default(); STREAK_LAST + 1];
        let mut end = 0;
        for (number, level) in levels.iter_mut().enumerate() {
            let [columns, rows] = [STREAK_COLUMNS, STREAK_ROWS].map(|side| (side >> number).max(1));
            *level = Level { begin: end, columns, rows };
            end += columns * rows;
        }
        // Rounded at the end, so that roundings do not add up from level to level.
        let mut texels = with_room(end, "the disk's streaks")?;
        texels.extend(drawn.iter().map(|g| [*g, g.exp()]));
        for pair in levels.windows(2) {
            let [finer, level] = pair else { continue };
            for y in 0..level.rows {
                for x in 0..level.columns {
                    let mut mean = [0.0; 2];
                    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                        let (column, row) = ((2 * x + i) % finer.columns, (2 * y + j) % finer.rows);
                        let texel: [f32; 2] = texels[finer.begin + row * finer.columns + column];
                        (0..2).for_each(|c| mean[c] += 0.25 * texel[c]);
                    }
                    texels.push(mean);
                }
            }
        }
        texels.iter_mut().for_each(|texel| *texel = rounded(*texel));
        Ok(Self { texels, levels })
    }

    /// The levels, the finest first: columns, rows, and texels row by row as f16. Errors: OUT_OF_MEMORY.
    pub fn levels(&self) -> impl Iterator<Item = Result<([u32; 2], Vec<[f16; 2]>)>> {
        self.levels.iter().map(|level| {
            let count = level.columns * level.rows;
            let texels = self.texels.get(level.begin..level.begin + count).unwrap_or(&[]);
            let mut halves = filled(count, [f16::ZERO; 2], "the disk's streaks")?;
            halves.iter_mut().zip(texels).for_each(|(half, texel)| *half = texel.map(f16::from_f32));
            Ok(([level.columns as u32, level.rows as u32], halves))
        })
    }

    /// The patches of a pixel's three parts. The middle one lies about `place`, in periods (azimuth, ln r), the others
    /// the share `apart` of the side `cut` before and behind it; with 0 each is the whole pixel. `cut`, `other`: the
    /// pixel's sides, in texels.
    pub fn patches(&self, place: [f64; 2], apart: f64, cut: [f64; 2], other: [f64; 2]) -> [Patch; 3] {
        let taps = Taps::new(cut.map(|side| (1.0 - 2.0 * apart) * side), other);
        let level = &self.levels[taps.level.min(STREAK_LAST)];
        let sides = [level.columns as f64, level.rows as f64];
        let last = 0.5 * (f64::from(taps.count) - 1.0);
        // In texels of the level, from their centres.
        let first = [0, 1].map(|c| (place[c] - last * taps.step[c]) * sides[c] - 0.5);
        let step = [0, 1].map(|c| taps.step[c] * sides[c]);
        let patch = |first: [f64; 2]| {
            let mut sum = [0.0_f32; 2];
            for i in 0..taps.count {
                let texel = self.bilinear(level, [0, 1].map(|c| first[c] + f64::from(i) * step[c]));
                (0..2).for_each(|c| sum[c] += texel[c]);
            }
            let [mean, light] = sum.map(|v| f64::from(v) / f64::from(taps.count));
            Patch { mean, light }
        };
        if apart <= 0.0 {
            return [patch(first); 3];
        }
        let texels = [STREAK_COLUMNS as f64, STREAK_ROWS as f64];
        let beside = [0, 1].map(|c| apart * cut[c] / texels[c] * sides[c]);
        [-1.0, 0.0, 1.0].map(|part| patch([0, 1].map(|c| first[c] + part * beside[c])))
    }

    /// Between texels of a level, around both sides; `at` in texels from the first one's centre.
    fn bilinear(&self, level: &Level, at: [f64; 2]) -> [f32; 2] {
        let whole = at.map(|x| x as i64 - i64::from(x < 0.0));
        let [right, below] = [0, 1].map(|c| (at[c] - whole[c] as f64) as f32);
        // Sides are powers of two.
        let [columns, rows] = [level.columns - 1, level.rows - 1];
        let (left, top) = (whole[0] as usize & columns, whole[1] as usize & rows);
        let (next, under) = ((left + 1) & columns, (top + 1) & rows);
        let row = |row: usize| level.begin + row * level.columns;
        let [a, b, c, d] =
            [row(top) + left, row(top) + next, row(under) + left, row(under) + next].map(|i| self.texels[i]);
        [0, 1].map(|k| {
            let (above, beneath) = (a[k] + (b[k] - a[k]) * right, c[k] + (d[k] - c[k]) * right);
            above + (beneath - above) * below
        })
    }
}

/// Taps of equal weight along the longer axis of the ellipse that stands for a patch: as many as shorter axes make it,
/// and so far apart that their variance along it is that of the patch.
struct Taps {
    level: usize,
    /// From tap to tap, in periods.
    step: [f64; 2],
    count: u32,
}

impl Taps {
    /// `dx`, `dy`: sides of the patch, in texels.
    fn new(dx: [f64; 2], dy: [f64; 2]) -> Self {
        let stretch2 = dx[0] * dx[0] + dx[1] * dx[1] + dy[0] * dy[0] + dy[1] * dy[1];
        // The condition is positive so that it is false for NaN.
        let known = stretch2 < STREAK_WHOLE;
        if !known {
            return Self { level: STREAK_LAST, step: [0.0; 2], count: 1 };
        }
        // Singular values, and the direction of the larger one's axis by the half-angle formula that does not cancel.
        let cross = dx[0] * dx[1] + dy[0] * dy[1];
        let half_difference = 0.5 * (dx[0] * dx[0] + dy[0] * dy[0] - dx[1] * dx[1] - dy[1] * dy[1]);
        let half_split = (half_difference * half_difference + cross * cross).sqrt();
        // Smaller ones than a texel of the finest level cannot be told apart.
        let finest = 1.0 / STREAK_TEXEL;
        let major = (0.5 * stretch2 + half_split).sqrt().max(finest);
        let minor = ((dx[0] * dy[1] - dx[1] * dy[0]).abs() / major).max(major / STREAK_TAPS).max(finest);
        let (x, y) = match half_difference >= 0.0 {
            true => (half_split + half_difference, cross),
            false => (cross, half_split - half_difference),
        };
        let ratio = major / minor;
        let whole = ratio as u32;
        let count = f64::from(whole + u32::from(ratio > f64::from(whole))).clamp(1.0, STREAK_TAPS);
        // A box has the variance L^2 / 12, so many places a step apart have (n^2 - 1) / 12, and a tap that of a box of
        // one texel of its level and a tent of two, 3 / 12 of its square.
        //
        // The level: the whole number nearest to log2 of the wanted texel is the exponent of sqrt(2) times that, which
        // is at least 1.
        let exponent = (((SQRT_2 * STREAK_TEXEL * minor).to_bits() >> 52) as usize).saturating_sub(1023);
        let level = exponent.min(STREAK_LAST);
        let texel = f64::from(1_u32 << level);
        let apart = ((major * major - 3.0 * texel * texel).max(0.0) / (count * count - 1.0).max(1.0)).sqrt();
        let scale = if count > 1.0 { apart / (x * x + y * y).sqrt().max(1e-30) } else { 0.0 };
        Self { level, step: [x * scale / STREAK_COLUMNS as f64, y * scale / STREAK_ROWS as f64], count: count as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finest() -> impl Iterator<Item = f64> + Clone {
        let streaks = Streaks::shared().unwrap();
        streaks.texels[..STREAK_COLUMNS * STREAK_ROWS].iter().map(|texel| f64::from(texel[0]))
    }

    /// The patch of a pixel that has one part.
    fn patch(streaks: &Streaks, place: [f64; 2], dx: [f64; 2], dy: [f64; 2]) -> Patch {
        let [_, middle, _] = streaks.patches(place, 0.0, dx, dy);
        middle
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        sum / count
    }

    #[test]
    fn numbers_are_those_of_the_picture() {
        let log_mean = |s: f64| mean(finest().map(|g| (s * g).exp())).ln();
        let [whole, half] = [log_mean(1.0), log_mean(0.5)];
        let c0 = STREAK_CUMULANTS[0];
        // c0 + c1 + c2 = whole, c0 + c1 / 2 + c2 / 4 = 4 half.
        let c2 = 2.0 * (whole - c0) - 4.0 * (4.0 * half - c0);
        let c1 = whole - c0 - c2;
        println!("cumulants {c0} {c1} {c2}, least {:?}", finest().fold(f64::MAX, f64::min));
        println!("most {}", finest().fold(f64::MIN, f64::max));
        assert!((mean(finest().map(|g| g * g)) / (2.0 * STREAK_CUMULANTS[0]) - 1.0).abs() < 1e-3);
        for (found, stated) in [c0, c1, c2].into_iter().zip(STREAK_CUMULANTS) {
            assert!((found - stated).abs() < 1e-3, "{found}, not {stated}");
        }
        for s in [0.1, 0.25, 0.7, 0.9] {
            let [c0, c1, c2] = STREAK_CUMULANTS;
            let error = log_mean(s) - s * s * (c0 + s * (c1 + s * c2));
            assert!(error.abs() < 1e-3, "at {s}: {error}");
        }
    }

    #[test]
    fn rows_are_no_rings() {
        let all = finest().collect::<Vec<_>>();
        let means = all.chunks(STREAK_COLUMNS).map(|row| mean(row.iter().copied()).abs());
        assert!(means.fold(0.0, f64::max) < 1e-3);
    }

    /// A patch about nothing is the texel, one that is far too large is the mean of all, and no light is lost on the
    /// way: the mean of what pixels see of the picture is 1, however large they are.
    #[test]
    fn filtering_keeps_the_mean() {
        let streaks = Streaks::shared().unwrap();
        for (x, y) in [(0, 0), (1023, 511), (300, 7)] {
            let place = [(x as f64 + 0.5) / 1024.0 - 3.0, (y as f64 + 0.5) / 512.0 + 2.0];
            let texel = streaks.texels[y * STREAK_COLUMNS + x].map(f64::from);
            let seen = patch(streaks, place, [0.0; 2], [1e-9, 0.0]);
            assert!((seen.mean - texel[0]).abs() < 1e-9 && (seen.light - texel[1]).abs() < 1e-9, "{seen:?} {texel:?}");
        }
        for far in [1e7, 1e30, f64::INFINITY, f64::NAN] {
            let seen = patch(streaks, [0.3, 0.4], [far, 0.0], [0.0, 1.0]);
            assert!(seen.exponent(1.0).abs() < 1e-3, "{far}: {seen:?}");
        }
        for (dx, dy) in
            [([1.0, 0.0], [0.0, 1.0]), ([6.0, 3.0], [-1.0, 4.0]), ([40.0, 0.0], [0.0, 3.0]), ([90.0; 2], [0.0; 2])]
        {
            for s in [0.3, 1.0] {
                let place = |i: u32| f64::from(i) / 211.0;
                let places = (0..211).flat_map(|i| (0..211).map(move |j| [place(i), place(j)]));
                let average = mean(places.map(|place| patch(streaks, place, dx, dy).exponent(s).exp()));
                assert!((average - 1.0).abs() < 0.015, "{dx:?} {dy:?} {s}: {average}");
            }
        }
    }

    /// Against the mean of e^g over the patch itself.
    #[test]
    fn patches_show_their_mean_light() {
        let streaks = Streaks::shared().unwrap();
        let (mut beyond, mut count) = ([0, 0], 0);
        for (dx, dy) in [([3.0, 0.0], [0.0, 3.0]), ([9.0, 6.0], [-1.0, 2.0]), ([20.0, 1.0], [3.0, 8.0])] {
            for i in 0..1500 {
                let place = [f64::from(i) * 0.618_034, f64::from(i) * 0.754_878];
                let share = |k: u32| (f64::from(k) + 0.5) / 16.0 - 0.5;
                let inside = (0..16).flat_map(|k| (0..16).map(move |l| (share(k), share(l)))).map(|(a, b)| {
                    let at = |c: usize, texels: usize| place[c] + (a * dx[c] + b * dy[c]) / texels as f64;
                    let texel =
                        [at(0, STREAK_COLUMNS) * STREAK_COLUMNS as f64, at(1, STREAK_ROWS) * STREAK_ROWS as f64];
                    f64::from(streaks.bilinear(&streaks.levels[0], texel.map(|x| x - 0.5))[0]).exp()
                });
                let truth = mean(inside) / STREAK_CUMULANTS.iter().sum::<f64>().exp();
                let error = (patch(streaks, place, dx, dy).exponent(1.0).exp() / truth - 1.0).abs();
                count += 1;
                [0.05, 0.2].iter().zip(&mut beyond).for_each(|(limit, n)| *n += u32::from(error > *limit));
            }
        }
        println!("{beyond:?} of {count} patches beyond 5 % and 20 %");
        assert!(beyond[1] * 200 < count, "{beyond:?} of {count}");
    }
}
