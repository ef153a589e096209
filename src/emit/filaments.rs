// SPDX-License-Identifier: MIT OR Apache-2.0
//! The filaments that matter with depth is made of: noise drawn once for a process into a block that repeats in
//! azimuth, in ln r and in height, with a pyramid of coarser blocks. Mirrored by `shaders/emit/filaments.wgsl`, which
//! reads the same texels. Knows neither orbits nor time.
//!
//! Octaves of gradient noise (Perlin 2002), displaced along the radius and the height by coarser noise, add up to g, of
//! mean 0 and variance 1 and about normally distributed, so that matter with density ~ e^(k g) is log-normal, as that
//! of supersonic turbulence is (Vazquez-Semadeni 1994, ApJ 423, 681). Some octaves are folded, n -> -|n|, whose creases
//! are bright sheets. A column around the axis has the mean 0, so that nothing of it is a ring, however often orbits
//! wind it up.
//!
//! Structure finer than the spacing of samples would alias. So a sample is taken at a level of the pyramid, and what
//! the level has lost of the variance is known: the mean of e^(k g) over all places is e^(k^2 v / 2), v being the
//! variance that is left.

use super::lattice::Between;
use crate::allocate::{collected, filled, with_room};
use crate::error::Result;
use crate::random::mix;
use half::f16;
use std::sync::OnceLock;

/// Texels of the block in azimuth, where it goes around once, in ln r and in height.
pub(crate) const FILAMENT_SIDES: [usize; 3] = [256, 128, 64];
/// The range of ln r, and of the height, after which the block repeats. Heights are counted in thicknesses.
pub(crate) const FILAMENT_PERIOD: f64 = 0.6;
pub(crate) const FILAMENT_HEIGHT: f64 = 5.0;
/// The number of the last level of the pyramid; each has half the sides of the one before. The next would be 0.
pub(crate) const FILAMENT_LAST: usize = FILAMENT_SIDES[2].ilog2() as usize;
pub(crate) const FILAMENT_LEVELS: usize = FILAMENT_LAST + 1;
/// The variance of each level.
pub(crate) const FILAMENT_VARIANCES: [f64; FILAMENT_LEVELS] = [0.9588, 0.8577, 0.7187, 0.5436, 0.3137, 0.1052, 0.0230];

/// ln of the mean of e^(x g) is x^2 (1 / 2 + c0 x + c1 x^2): right at x = 1 and 2.
pub(crate) const FILAMENT_CUMULANTS: [f64; 2] = [-0.033_56, -0.005_51];

/// Cells of each octave in the block.
const CELLS: [[usize; 3]; 5] = [[4, 2, 2], [8, 4, 4], [16, 8, 8], [32, 16, 16], [64, 32, 16]];
/// The amplitude of an octave over that of the one before: 2^(-1/3), as that of what turbulence carries along (Obukhov
/// 1949, Izv. Akad. Nauk SSSR, Ser. Geogr. Geofiz. 13, 58; Kolmogorov 1941, Dokl. Akad. Nauk SSSR 30, 301).
const FAINTER: f32 = 0.79;
/// How far noise is displaced along the radius and the height, in periods, at noise 1.
const DISPLACED: [f32; 2] = [0.25, 0.25];
/// The share of creases in the octaves that have them; the factor and the offset give |n| the variance and mean of n.
const CREASE: f32 = 0.35;
const CREASED: std::ops::Range<usize> = 1..4;
const CREASE_GAIN: f32 = 1.6;
const CREASE_OFFSET: f32 = 0.25;
/// Standard deviations that values stay below.
const LARGEST: f32 = 4.0;
/// Values are multiples of 1 / `STEPS`, which f16 holds exactly.
const STEPS: f32 = 256.0;

/// The block and its pyramid.
pub struct Filaments {
    /// g in steps, level after level, layer by layer, row by row.
    texels: Vec<i16>,
    levels: [Level; FILAMENT_LEVELS],
}

#[derive(Clone, Copy, Default)]
struct Level {
    begin: usize,
    sides: [usize; 3],
}

impl Level {
    fn count(&self) -> usize {
        self.sides.iter().product()
    }
}

/// A level for a graphics card: its sides, and its texels layer by layer, row by row.
pub type LevelTexels = ([u32; 3], Vec<f16>);

/// Gradient noise on a lattice that goes around in all directions.
struct Noise {
    cells: [usize; 3],
    slopes: Vec<[f32; 3]>,
}

/// A place in periods, -8 or more, on a lattice of which `count` cells make a period.
fn between(place: f32, count: usize) -> Between {
    Between::new((place + 8.0) * count as f32, count)
}

impl Noise {
    fn new(cells: [usize; 3], key: u32) -> Result<Self> {
        let count = cells.iter().product::<usize>() as u32;
        let part = |bits: u32| (bits & 1023) as f32 / 511.5 - 1.0;
        let slope = |i: u32| mix(i.wrapping_add(mix(key)));
        let slopes = (0..count).map(slope).map(|h| [part(h), part(h >> 10), part(h >> 20)]);
        Ok(Self { cells, slopes: collected(slopes, WHAT)? })
    }

    fn columns(&self) -> Result<Vec<Between>> {
        let width = 1.0 / FILAMENT_SIDES[0] as f32;
        collected((0..FILAMENT_SIDES[0]).map(|x| between((x as f32 + 0.5) * width, self.cells[0])), WHAT)
    }

    /// At a column, and between rows and layers.
    fn at(&self, x: &Between, y: &Between, z: &Between) -> f32 {
        let along = |j: usize, k: usize| {
            let begin = (z.sides[k] * self.cells[1] + y.sides[j]) * self.cells[0];
            let across = [y.offset - j as f32, z.offset - k as f32];
            let corner = |i: usize| {
                let [a, b, c] = self.slopes[begin + x.sides[i]];
                a * (x.offset - i as f32) + b * across[0] + c * across[1]
            };
            let first = corner(0);
            first + (corner(1) - first) * x.share
        };
        let layer = |k: usize| {
            let first = along(0, k);
            first + (along(1, k) - first) * y.share
        };
        let first = layer(0);
        first + (layer(1) - first) * z.share
    }
}

const WHAT: &str = "the filaments of matter with depth";

/// The block: g layer by layer, row by row. Only operations that every machine rounds alike.
fn drawn() -> Result<Vec<f32>> {
    let [width, rows, layers] = FILAMENT_SIDES;
    let noises = CELLS.iter().zip(0..).map(|(cells, key)| Noise::new(*cells, key)).collect::<Result<Vec<_>>>()?;
    let columns = noises.iter().map(Noise::columns).collect::<Result<Vec<_>>>()?;
    let displacing = [Noise::new(CELLS[0], 100)?, Noise::new(CELLS[0], 101)?];
    let mut all = with_room(width * rows * layers, WHAT)?;
    for (z, y) in (0..layers).flat_map(|z| (0..rows).map(move |y| (z, y))) {
        let [row, layer] = [(y as f32 + 0.5) / rows as f32, (z as f32 + 0.5) / layers as f32];
        let [coarse_row, coarse_layer] = [(row, 1), (layer, 2)].map(|(at, side)| between(at, CELLS[0][side]));
        for x in 0..width {
            let [up, out] = [1, 0].map(|k| DISPLACED[k] * displacing[k].at(&columns[0][x], &coarse_row, &coarse_layer));
            let (mut sum, mut amplitude) = (0.0, 1.0);
            for (octave, (noise, columns)) in noises.iter().zip(&columns).enumerate() {
                let [_, row_cells, layer_cells] = noise.cells;
                let across = [between(row + out, row_cells), between(layer + up, layer_cells)];
                let plain = noise.at(&columns[x], &across[0], &across[1]);
                let crease = if CREASED.contains(&octave) { CREASE } else { 0.0 };
                sum += amplitude * (plain + crease * (CREASE_OFFSET - CREASE_GAIN * plain.abs() - plain));
                amplitude *= FAINTER;
            }
            all.push(sum);
        }
    }
    let unit = deviation(&all).recip();
    for around in all.chunks_mut(width) {
        let bounded = |g: f32| g * unit / (1.0 + (g * unit / LARGEST).powi(2)).sqrt();
        around.iter_mut().for_each(|g| *g = bounded(*g));
        let mean = around.iter().sum::<f32>() / width as f32;
        around.iter_mut().for_each(|g| *g -= mean);
    }
    let scale = deviation(&all).recip();
    all.iter_mut().for_each(|g| *g *= scale);
    Ok(all)
}

/// The root of the mean square. Sums of parts: a single one in f32 would lose too much.
fn deviation(all: &[f32]) -> f32 {
    let parts = all.chunks(FILAMENT_SIDES[0]).map(|part| part.iter().map(|g| g * g).sum::<f32>() / part.len() as f32);
    (parts.map(f64::from).sum::<f64>() / (all.len() / FILAMENT_SIDES[0]) as f64).sqrt() as f32
}

impl Filaments {
    /// The filaments of this process, drawn at first use (some 0.3 s). Errors: OUT_OF_MEMORY.
    pub fn shared() -> Result<&'static Self> {
        static SHARED: OnceLock<Filaments> = OnceLock::new();
        match SHARED.get() {
            Some(filaments) => Ok(filaments),
            None => {
                let filaments = Self::new(drawn()?)?;
                Ok(SHARED.get_or_init(|| filaments))
            }
        }
    }

    fn new(drawn: Vec<f32>) -> Result<Self> {
        let mut levels = [Level::default(); FILAMENT_LEVELS];
        let mut end = 0;
        for (number, level) in levels.iter_mut().enumerate() {
            *level = Level { begin: end, sides: FILAMENT_SIDES.map(|side| side >> number) };
            end += level.count();
        }
        let mut texels = with_room(end, WHAT)?;
        let mut finer = drawn;
        for (number, level) in levels.iter().enumerate() {
            if number > 0 {
                finer = coarser(&finer, levels[number - 1].sides)?;
            }
            // Rounded here, so that roundings do not add up from level to level.
            texels.extend(finer.iter().take(level.count()).map(|g| rounded(g * STEPS)));
        }
        Ok(Self { texels, levels })
    }

    /// The levels, the finest first. Errors: OUT_OF_MEMORY.
    pub fn levels(&self) -> impl Iterator<Item = Result<LevelTexels>> {
        self.levels.iter().map(|level| {
            let count = level.count();
            let texels = self.texels.get(level.begin..level.begin + count).unwrap_or(&[]);
            let mut halves = filled(count, f16::ZERO, WHAT)?;
            let exact = |texel: i16| f16::from_f32(f32::from(texel) / STEPS);
            halves.iter_mut().zip(texels).for_each(|(half, texel)| *half = exact(*texel));
            Ok((level.sides.map(|side| side as u32), halves))
        })
    }

    /// g at a place, in periods (azimuth, ln r, height), of a level, which need not be a whole number.
    pub fn value(&self, place: [f64; 3], level: f64) -> f64 {
        let [level, left] = faded(level);
        let whole = level as usize;
        let share = level - whole as f64;
        let fine = self.trilinear(&self.levels[whole], place);
        let value = match share > 0.0 {
            true => fine + (self.trilinear(&self.levels[(whole + 1).min(FILAMENT_LAST)], place) - fine) * share as f32,
            false => fine,
        };
        f64::from(value / STEPS) * left
    }

    /// Adds `scale` g to each of a line of texels around the axis, of which the block's periods have so many; the place
    /// is that of the line's begin in azimuth, and of its middle in ln r and height, 0 or more; of a level, which need
    /// not be a whole number, but has no more texels in azimuth than the line.
    pub fn add_line(&self, line: &mut [f32], scale: f32, place: [f32; 3], level: f32) {
        let [level, left] = faded(level.into());
        let whole = level as usize;
        let share = (level - whole as f64) as f32;
        let scale = scale * left as f32 / STEPS;
        self.add_level(line, scale * (1.0 - share), place, whole);
        if share > 0.0 && whole < FILAMENT_LAST {
            self.add_level(line, scale * share, place, whole + 1);
        }
    }

    fn add_level(&self, line: &mut [f32], scale: f32, [turn, row, layer]: [f32; 3], level: usize) {
        let Level { begin, sides: [columns, rows, layers] } = self.levels[level];
        let between = |place: f32, side: usize| {
            // Two periods more: no place is negative then. Sides are powers of two.
            let at = place * side as f32 - 0.5 + (2 * side) as f32;
            let whole = at as usize;
            ([whole & (side - 1), (whole + 1) & (side - 1)], at - whole as f32)
        };
        let ([above, below], down) = between(row, rows);
        let ([near, far], up) = between(layer, layers);
        let mut around = [0.0_f32; FILAMENT_SIDES[0]];
        for (z, y, weight) in [
            (near, above, (1.0 - up) * (1.0 - down)),
            (near, below, (1.0 - up) * down),
            (far, above, up * (1.0 - down)),
            (far, below, up * down),
        ] {
            let begin = begin + (z * rows + y) * columns;
            let weight = weight * scale;
            for (sum, g) in around.iter_mut().zip(&self.texels[begin..begin + columns]) {
                *sum += weight * f32::from(*g);
            }
        }
        // Texels of the line are `step` of the level's apart.
        let step = columns as f32 / line.len() as f32;
        let first = turn * columns as f32 + 0.5 * step - 0.5 + (2 * columns) as f32;
        let turned = |i: usize| around[i & (columns - 1)];
        if columns == line.len() {
            let whole = first as usize;
            let right = first - whole as f32;
            for (i, texel) in line.iter_mut().enumerate() {
                let a = turned(whole + i);
                *texel += a + (turned(whole + i + 1) - a) * right;
            }
            return;
        }
        for (i, texel) in line.iter_mut().enumerate() {
            let at = first + step * i as f32;
            let whole = at as usize;
            let a = turned(whole);
            *texel += a + (turned(whole + 1) - a) * (at - whole as f32);
        }
    }

    /// Between texels of a level, around all sides.
    fn trilinear(&self, level: &Level, place: [f64; 3]) -> f32 {
        let between = |k: usize| {
            let at = place[k] * level.sides[k] as f64 - 0.5;
            let whole = at as i64 - i64::from(at < 0.0);
            // Sides are powers of two.
            let around = level.sides[k] - 1;
            ([whole as usize & around, (whole as usize).wrapping_add(1) & around], (at - whole as f64) as f32)
        };
        let [(xs, right), (ys, down), (zs, up)] = [0, 1, 2].map(between);
        let row = |y: usize, z: usize| {
            let begin = level.begin + (z * level.sides[1] + y) * level.sides[0];
            let [a, b] = xs.map(|x| f32::from(self.texels[begin + x]));
            a + (b - a) * right
        };
        let [near, far] = zs.map(|z| {
            let [a, b] = ys.map(|y| row(y, z));
            a + (b - a) * down
        });
        near + (far - near) * up
    }
}

/// Rounds to the nearest whole number, and halves away from 0.
fn rounded(x: f32) -> i16 {
    (x + if x < 0.0 { -0.5 } else { 0.5 }) as i16
}

/// The means of eight texels each.
fn coarser(finer: &[f32], [width, rows, layers]: [usize; 3]) -> Result<Vec<f32>> {
    let mut all = with_room(width * rows * layers / 8, WHAT)?;
    for z in (0..layers).step_by(2) {
        for y in (0..rows).step_by(2) {
            for x in (0..width).step_by(2) {
                let corner = |i: usize| finer[((z + (i >> 2)) * rows + y + (i >> 1 & 1)) * width + x + (i & 1)];
                all.push(0.125 * (0..8).map(corner).sum::<f32>());
            }
        }
    }
    Ok(all)
}

/// The variance of the values of a level, which need not be a whole number. A coarser texel is the mean of finer ones,
/// so that the covariance of two levels is about the variance of the coarser one.
pub fn filament_variance(level: f64) -> f64 {
    let [level, left] = faded(level);
    let whole = level as usize;
    let (share, rest) = (level - whole as f64, 1.0 - (level - whole as f64));
    let coarse = FILAMENT_VARIANCES[(whole + 1).min(FILAMENT_LAST)];
    left * left * (rest * rest * FILAMENT_VARIANCES[whole] + share * (2.0 - share) * coarse)
}

/// The variance of each level and of the next one, 0 beyond the last, as shaders have them.
pub(crate) fn level_variances() -> [[f64; 2]; FILAMENT_LEVELS] {
    let variance = |level: usize| FILAMENT_VARIANCES.get(level).copied().unwrap_or(0.0);
    std::array::from_fn(|level| [variance(level), variance(level + 1)])
}

/// ln of the mean of e^(k g) over a level, where k g has the standard deviation `x`: half of its square if g were
/// normally distributed; the other terms are measured.
pub fn filament_log_mean(x: f64) -> f64 {
    let [c3, c4] = FILAMENT_CUMULANTS;
    x * x * (0.5 + x * (c3 + x * c4))
}

/// A level of the pyramid, and the share of it that is left: coarser than the last one it fades out.
fn faded(level: f64) -> [f64; 2] {
    [level.clamp(0.0, FILAMENT_LAST as f64), (1.0 + FILAMENT_LAST as f64 - level).clamp(0.0, 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        sum / count
    }

    /// Values of a level at places all over the block, as low-discrepancy sequences have them (Roberts 2018).
    fn values(level: f64) -> Vec<f64> {
        let filaments = Filaments::shared().unwrap();
        let place = |i: u32| [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|step| f64::from(i) * step);
        (0..400_000).map(|i| filaments.value(place(i), level)).collect()
    }

    #[test]
    fn numbers_are_those_of_the_block() {
        let finest = values(0.0);
        let power = |k: i32| mean(finest.iter().map(|g| g.powi(k)));
        println!("moments {:?}", [1, 2, 3, 4].map(power));
        let variances = [0, 1, 2, 3, 4, 5, 6].map(|level| mean(values(f64::from(level)).iter().map(|g| g * g)));
        let lost = |k: f64| mean(finest.iter().map(|g| (k * g).exp())).ln();
        // x^2 (1 / 2 + c0 x + c1 x^2) at k = 1 and 2.
        let [x, y] = [1.0, 2.0].map(|k| k * variances[0].sqrt());
        let [a, b] = [(lost(1.0) / (x * x) - 0.5) / x, (lost(2.0) / (y * y) - 0.5) / y];
        let c1 = (b - a) / (y - x);
        println!("variances {variances:.4?}, cumulants {:.5} {c1:.5}", a - c1 * x);
        for (found, stated) in variances.into_iter().zip(FILAMENT_VARIANCES) {
            assert!((found - stated).abs() < 2e-3, "{found}, not {stated}");
        }
        for k in [0.3, 0.5, 1.0, 1.5, 2.0, 2.5] {
            let error = lost(k) - filament_log_mean(k * filament_variance(0.0).sqrt());
            assert!(error.abs() < 0.01 * k * k, "at {k}: {error}");
        }
        // Between levels, and beyond the last one. The variance there is an estimate (`filament_variance`).
        for level in [0.5, 1.3, 2.5, 3.7, 4.5, 5.5, 6.5, 7.0, 90.0] {
            let seen = values(level);
            let [found, stated] = [mean(seen.iter().map(|g| g * g)), filament_variance(level)];
            assert!((found - stated).abs() < 0.035, "at level {level}: {found}, not {stated}");
            let found = mean(seen.iter().map(|g| (1.3 * g).exp())).ln() - filament_log_mean(1.3 * stated.sqrt());
            assert!(found.abs() < 0.05, "at level {level}: {found}");
        }
    }

    /// Every machine draws the same filaments: compared by the sum of all texels, each with bits that its place moves.
    #[test]
    fn texels_are_always_the_same() {
        let again = Filaments::new(drawn().unwrap()).unwrap();
        let shared = Filaments::shared().unwrap();
        assert!(again.texels == shared.texels);
        let sum = shared.texels.iter().zip(0_u32..).fold(0_u32, |sum, (g, i)| sum.wrapping_add(mix(i ^ *g as u32)));
        assert_eq!(sum, 0x61ef_821a, "{sum:#x}");
    }

    #[test]
    fn columns_around_the_axis_are_no_rings() {
        let shared = Filaments::shared().unwrap();
        let rings = shared.texels[..FILAMENT_SIDES.iter().product()].chunks(FILAMENT_SIDES[0]);
        let worst = rings.map(|ring| mean(ring.iter().map(|g| f64::from(*g))).abs()).fold(0.0, f64::max);
        assert!(worst < 0.2, "{worst} steps");
    }

    /// The block goes around along all sides, without a seam: no step from place to place is larger there.
    #[test]
    fn sides_meet() {
        let shared = Filaments::shared().unwrap();
        for (side, level) in [0, 1, 2].into_iter().flat_map(|side| [(side, 0.0), (side, 3.4), (side, 5.0)]) {
            let mut most = [0.0_f64; 2];
            for i in 0..4000 {
                let mut place = [0.618, 0.755, 0.57].map(|step| f64::from(i) * step);
                for (most, at) in most.iter_mut().zip([-0.5e-4, 0.3 + 0.7 * f64::from(i) / 4000.0]) {
                    let mut value = |at: f64| {
                        place[side] = at;
                        shared.value(place, level)
                    };
                    *most = most.max((value(at + 1e-4) - value(at)).abs());
                }
            }
            assert!(most[0] < 1.1 * most[1] && most[0] > 0.0, "side {side}, level {level}: {most:?}");
            let place = [0.3, -0.2, 4.1];
            let mut around = place;
            around[side] += 5.0;
            assert!((shared.value(place, level) - shared.value(around, level)).abs() < 1e-6);
        }
    }

    /// Graphics cards get exactly the texels that the CPU reads.
    #[test]
    fn levels_are_exact() {
        let shared = Filaments::shared().unwrap();
        let mut all = shared.texels.iter();
        let mut bytes = 0;
        for (number, level) in shared.levels().enumerate() {
            let (sides, texels) = level.unwrap();
            assert_eq!(sides.map(|side| side as usize), FILAMENT_SIDES.map(|side| side >> number));
            bytes += 2 * texels.len();
            assert!(texels.iter().all(|half| half.to_f32() * STEPS == f32::from(*all.next().unwrap())));
        }
        assert!(all.next().is_none() && bytes < 5 << 20, "{bytes} bytes");
    }
}
