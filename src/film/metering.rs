// SPDX-License-Identifier: MIT OR Apache-2.0
//! Metering: measures a frame's exposed light on the finest grid of its bloom, glare included, and changes it by what
//! it finds. Auto exposure brings a percentile of the luminance to a target by one factor for the frame. Local tone
//! mapping, `highlights` and `shadows`, brings bright parts down and dark ones up, and leaves their structure. In f32,
//! as `shaders/metering`, which has the same functions; `src/gpu/frame/passes/metering.rs` runs them. Knows nothing of
//! how light was made, or of pixels.
//!
//! Stops are log2 of the luminance (Y of Rec. 709), counted from 2^-16 on; darker cells are left out. Auto exposure
//! goes by a histogram with 8 bins a stop. Local tone mapping splits log luminance into a base, smooth but for edges,
//! and what is left, as F. Durand and J. Dorsey do (SIGGRAPH 2002), and changes the base alone. The base is a bilateral
//! filter's, on a grid of blocks and stops (the bilateral grid: J. Chen, S. Paris, F. Durand, SIGGRAPH 2007): cells are
//! counted by block and stop, and their own stops summed; both are smoothed across five blocks and three stops, and
//! read between the nearest eight. Where all light near a pixel is of one stop, the base is that, exactly. So light of
//! very different luminance, as on both sides of the shadow's edge, does not mix, and no halo appears there.

use super::bloom::{Bloom, BloomAccumulator, Glare};
use super::colour_map::luminance;
use super::grade::LEAST_BASE;
use super::tone_map::MAX_SCENE_LIGHT;
use crate::allocate::{collected, filled};
use crate::error::Result;
use crate::parallel::prelude::*;
use crate::scene::Film;

/// log2 of the least luminance that is measured, negative.
pub(crate) const METER_DARKEST: f32 = 16.0;
/// Bins of the histogram, and how many of them are a stop.
pub(crate) const METER_BINS: usize = 256;
pub(crate) const METER_BINS_PER_STOP: f32 = 8.0;
/// Stops that blocks tell apart: the last is 2^15 and all above.
pub(crate) const BLOCK_STOPS: usize = 32;
/// The stop that sums of stops are counted from, for the half floats of the GPU.
pub(crate) const BLOCK_MIDDLE: f32 = 16.0;
/// The parts of a cell that blocks count, shared between the two nearest stops.
pub(crate) const CELL_PARTS: f32 = 256.0;
/// The weight of a block that is full of cells of one stop.
pub(crate) const BLOCK_WEIGHT: f32 = 64.0;
/// The weight of a pixel itself in its base, where no cell near it has its stop.
pub(crate) const OWN_WEIGHT: f32 = 1e-3;
/// The shares of a block and its neighbours along a side, and of a stop and its neighbours.
pub(crate) const BLOCK_SHARES: [f32; 3] = [6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
pub(crate) const STOP_SHARES: [f32; 2] = [0.5, 0.25];
/// log2 of middle grey, 0.18, about which highlights and shadows are told apart.
pub(crate) const GREY_STOP: f32 = -2.473_931_2;
/// Blocks of a frame's height, and of its width, at most.
const BLOCK_ROWS: u32 = 48;
const BLOCK_COLUMNS: u32 = 160;

/// The name of this memory in out-of-memory errors.
const BLOCKS: &str = "the blocks that light is measured in";

/// How a frame is metered: the uniform `meter` of the shaders.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MeterParams {
    /// The size of the finest grid, in cells; of the blocks, in blocks; and cells along a block's side.
    pub cells: [u32; 2],
    pub blocks: [u32; 2],
    pub side: u32,
    /// Factors on a cell's own light, and on what its glare adds.
    pub own: f32,
    pub above: f32,
    /// The share of the way to the target, 0 .. 1.
    pub strength: f32,
    /// 0 .. 1.
    pub percentile: f32,
    /// log2 of the luminance that the percentile is brought to.
    pub aim: f32,
    /// The limits of what is added, in stops.
    pub least: f32,
    pub most: f32,
    /// The share of the way from the last frame's exposure, 0 .. 1.
    pub adaptation: f32,
    /// The shares of their distance from middle grey that bright and dark bases lose.
    pub highlights: f32,
    pub shadows: f32,
    /// Blocks along a side of a pixel.
    pub per_pixel: f32,
}

impl MeterParams {
    /// `None`: the film does not ask for it. `film` has passed its check.
    pub fn new(film: &Film, bloom: &Bloom) -> Option<Self> {
        let level = bloom.levels.first().filter(|_| film.is_metered())?;
        let [columns, rows] = level.size;
        let side = rows.div_ceil(BLOCK_ROWS).max(columns.div_ceil(BLOCK_COLUMNS)).max(1);
        let auto = &film.auto_exposure;
        let on = auto.strength > 0.0;
        Some(Self {
            cells: level.size,
            blocks: level.size.map(|cells| cells.div_ceil(side)),
            side,
            own: bloom.direct,
            above: bloom.weight_above(0),
            strength: auto.strength as f32,
            percentile: (auto.percentile / 100.0) as f32,
            aim: auto.target.log2() as f32,
            least: if on { auto.least_ev as f32 } else { 0.0 },
            most: if on { auto.most_ev as f32 } else { 0.0 },
            adaptation: if on { auto.adaptation as f32 } else { 1.0 },
            highlights: film.highlights as f32,
            shadows: film.shadows as f32,
            per_pixel: 1.0 / (bloom.factor as f32 * side as f32),
        })
    }

    /// Whether light is changed by its surroundings, and not by the exposure alone.
    pub fn is_local(&self) -> bool {
        self.highlights > 0.0 || self.shadows > 0.0
    }

    /// The stops to add, where the percentile is `stop` (`None`: the frame is black) and `before` were added to the
    /// last frame (`None`: there was none).
    fn exposure_stops(&self, stop: Option<f32>, before: Option<f32>) -> f32 {
        // At once: a picture depends on its scene alone.
        let before = before.filter(|_| self.adaptation < 1.0);
        let Some(stop) = stop else { return before.unwrap_or(0.0) };
        let wanted = wanted_stops(self, stop);
        // No -0.
        before.map_or(wanted, |before| before + self.adaptation * (wanted - before)) + 0.0
    }
}

/// The stops that bring the percentile, at `stop`, to its target.
pub(crate) fn wanted_stops(meter: &MeterParams, stop: f32) -> f32 {
    (meter.strength * (meter.aim + METER_DARKEST - stop)).max(meter.least).min(meter.most)
}

/// The stop of a light, below 0 where it is not measured.
pub(crate) fn stop_of(light: [f32; 3]) -> f32 {
    luminance(light).max(LEAST_BASE).log2() + METER_DARKEST
}

/// How far `stops` is above 0, rounded off within a stop.
pub(crate) fn smooth_above(stops: f32) -> f32 {
    let near = stops.clamp(-1.0, 1.0) + 1.0;
    0.25 * near * near + (stops - 1.0).max(0.0)
}

/// The stops that a base `stops` above middle grey is changed by.
pub(crate) fn local_stops(meter: &MeterParams, stops: f32) -> f32 {
    meter.shadows * smooth_above(-stops) - meter.highlights * smooth_above(stops)
}

/// The stop of a histogram below which `percentile` of its cells are; `None`: it is empty.
fn percentile_stop(counts: &[u32], percentile: f32) -> Option<f32> {
    let total = counts.iter().sum::<u32>();
    let wanted = (percentile * total as f32).max(0.5);
    let mut before = 0;
    for (bin, count) in counts.iter().enumerate() {
        if wanted <= (before + count) as f32 && *count > 0 {
            return Some((bin as f32 + (wanted - before as f32) / *count as f32) / METER_BINS_PER_STOP);
        }
        before += count;
    }
    None
}

/// The cells of a block by stop, in parts of a cell: how many, and the sum of how far theirs are above that stop; and
/// what becomes of them once they are smoothed: weight, and weight times stop.
type Counts = [[i32; 2]; BLOCK_STOPS];
type Smoothed = [[f32; 2]; BLOCK_STOPS];

/// A frame that has been measured.
pub struct Metered {
    params: MeterParams,
    /// The stops that auto exposure adds.
    pub stops: f32,
    /// Empty where no light is changed by its surroundings.
    blocks: Vec<Smoothed>,
}

impl Metered {
    /// `light`: the exposed light of a cell of the finest grid with its glare, by its number; `before`: the stops that
    /// the last frame got. On the current pool. Errors: OUT_OF_MEMORY.
    pub fn new(params: MeterParams, before: Option<f32>, light: impl Fn(usize) -> [f32; 3] + Sync) -> Result<Self> {
        let [columns, rows] = params.blocks.map(|side| side as usize);
        let (counts, histogram) =
            (filled(columns * rows, [[0; 2]; BLOCK_STOPS], BLOCKS)?, filled(METER_BINS, 0, BLOCKS)?);
        let mut measured = Measured { counts, histogram };
        let side = params.side as usize;
        let parts = measured.counts.par_iter_mut().enumerate().map(|(number, counts)| {
            let mut histogram = [0_u32; METER_BINS];
            let corner = [number % columns * side, number / columns * side];
            let [right, bottom] = [0, 1].map(|i| (corner[i] + side).min(params.cells[i] as usize));
            for y in corner[1]..bottom {
                for x in corner[0]..right {
                    count(counts, &mut histogram, stop_of(light(y * params.cells[0] as usize + x)));
                }
            }
            histogram
        });
        let sum = |mut a: [u32; METER_BINS], b: [u32; METER_BINS]| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let histogram = parts.reduce_with(sum).unwrap_or([0; METER_BINS]);
        measured.histogram.copy_from_slice(&histogram);
        let stop = percentile_stop(&measured.histogram, params.percentile);
        let blocks = if params.is_local() { measured.smoothed(&params)? } else { Vec::new() };
        Ok(Self { params, stops: params.exposure_stops(stop, before), blocks })
    }

    /// The light of pixel (x, y) of the frame as it is developed; alpha as it was.
    pub fn over(&self, [r, g, b, a]: [f32; 4], x: u32, y: u32) -> [f32; 4] {
        let own = stop_of([r, g, b]);
        let local = if self.blocks.is_empty() {
            0.0
        } else {
            let grey = GREY_STOP + METER_DARKEST - self.stops;
            local_stops(&self.params, self.base(own, x, y) - grey)
        };
        let factor = (self.stops + local).exp2();
        let [r, g, b] = [r, g, b].map(|v| (v * factor).min(MAX_SCENE_LIGHT));
        [r, g, b, a]
    }

    /// The stop of the base at a pixel whose own is `own`.
    fn base(&self, own: f32, x: u32, y: u32) -> f32 {
        let [columns, rows] = self.params.blocks.map(|side| side as usize);
        let stop = own.max(0.0).min(BLOCK_STOPS as f32 - 1.0);
        let place = |i: u32| (i as f32 + 0.5) * self.params.per_pixel - 0.5;
        let (x, y, z) = (between(place(x), columns), between(place(y), rows), between(stop, BLOCK_STOPS));
        let mut sum = [0.0; 2];
        for (row, down) in y {
            for (column, across) in x {
                for (k, along) in z {
                    let [weight, stops] = self.blocks[row * columns + column][k];
                    sum[0] += down * across * along * weight;
                    sum[1] += down * across * along * stops;
                }
            }
        }
        (sum[1] + OWN_WEIGHT * (stop - BLOCK_MIDDLE)) / (sum[0] + OWN_WEIGHT) + BLOCK_MIDDLE
    }
}

/// The light of a frame that has all of it: with its glare, and as it was metered.
pub struct SpreadLight<'a> {
    glare: Glare<'a>,
    metered: Option<Metered>,
}

impl<'a> SpreadLight<'a> {
    /// Once all of a frame's light is in. `meter`: how it is measured, if it is; `before`: as for [`Metered::new`]. On
    /// the current pool. Errors: OUT_OF_MEMORY.
    pub fn new(all: BloomAccumulator<'a>, meter: Option<MeterParams>, before: Option<f32>) -> Result<Self> {
        let cells = meter.map(|_| all.cells()).transpose()?;
        let glare = all.spread()?;
        let metered = meter.zip(cells).map(|(meter, cells)| {
            let own = |number: usize| cells.get(number).copied().unwrap_or_default();
            Metered::new(meter, before, |number| glare.over_cell(own(number), number))
        });
        let metered = metered.transpose()?;
        Ok(Self { glare, metered })
    }

    /// The stops that auto exposure adds; `None`: the frame is not metered.
    pub fn stops(&self) -> Option<f32> {
        self.metered.as_ref().map(|metered| metered.stops)
    }

    /// Pixel (x, y) as it is developed, of its own exposed light; alpha as it was.
    pub fn over(&self, light: [f32; 4], x: u32, y: u32) -> [f32; 4] {
        let light = self.glare.over(light, x, y);
        self.metered.as_ref().map_or(light, |metered| metered.over(light, x, y))
    }
}

/// The two of `count` places between which `place` lies, with their shares; at the ends both are the same.
fn between(place: f32, count: usize) -> [(usize, f32); 2] {
    let place = place.max(0.0).min(count as f32 - 1.0);
    let first = place as usize;
    let share = place - first as f32;
    [(first, 1.0 - share), ((first + 1).min(count - 1), share)]
}

/// Counts a cell.
fn count(counts: &mut Counts, histogram: &mut [u32; METER_BINS], stop: f32) {
    if stop < 0.0 {
        return;
    }
    histogram[((stop * METER_BINS_PER_STOP) as usize).min(METER_BINS - 1)] += 1;
    let place = stop.min(BLOCK_STOPS as f32 - 1.0);
    let first = place as usize;
    let share = place - first as f32;
    let second = (share * CELL_PARTS + 0.5) as i32;
    // Share 1 - s lies s above the first stop, share s lies 1 - s below the second.
    let moment = (share * (1.0 - share) * CELL_PARTS + 0.5) as i32;
    let beyond = (first + 1).min(BLOCK_STOPS - 1);
    counts[first][0] += CELL_PARTS as i32 - second;
    counts[first][1] += moment;
    counts[beyond][0] += second;
    counts[beyond][1] -= moment;
}

struct Measured {
    counts: Vec<Counts>,
    histogram: Vec<u32>,
}

impl Measured {
    /// Errors: OUT_OF_MEMORY.
    fn smoothed(&self, params: &MeterParams) -> Result<Vec<Smoothed>> {
        let [columns, rows] = params.blocks.map(|side| side as i32);
        let scale = BLOCK_WEIGHT / (CELL_PARTS * (params.side * params.side) as f32);
        let mut blocks = collected(self.counts.iter().map(|_| [[0.0; 2]; BLOCK_STOPS]), BLOCKS)?;
        blocks.par_iter_mut().enumerate().for_each(|(number, out)| {
            let (x, y) = (number as i32 % columns, number as i32 / columns);
            let mut sums = [[0.0; 2]; BLOCK_STOPS];
            for (row, dy) in (y - 2..=y + 2).zip(-2_i32..) {
                for (column, dx) in (x - 2..=x + 2).zip(-2_i32..) {
                    let share = BLOCK_SHARES[dy.unsigned_abs() as usize] * BLOCK_SHARES[dx.unsigned_abs() as usize];
                    let inside = (0..rows).contains(&row) && (0..columns).contains(&column);
                    if let Some(counts) = self.counts.get((row * columns + column) as usize).filter(|_| inside) {
                        for (sum, count) in sums.iter_mut().zip(counts) {
                            (0..2).for_each(|i| sum[i] += share * count[i] as f32);
                        }
                    }
                }
            }
            for (k, out) in out.iter_mut().enumerate() {
                for (step, share) in [(-1, STOP_SHARES[1]), (0, STOP_SHARES[0]), (1, STOP_SHARES[1])] {
                    let stop = k as i32 + step;
                    let beside = usize::try_from(stop).ok().and_then(|stop| sums.get(stop));
                    let [weight, above] = beside.copied().unwrap_or_default();
                    out[0] += scale * share * weight;
                    out[1] += scale * share * (weight * (stop as f32 - BLOCK_MIDDLE) + above);
                }
            }
        });
        Ok(blocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::AutoExposure;

    fn film(auto_exposure: AutoExposure, highlights: f64, shadows: f64) -> Film {
        Film { bloom: 0.0, auto_exposure, highlights, shadows, ..Film::plain() }
    }

    fn params(film: &Film, frame: [u32; 2]) -> MeterParams {
        let bloom = Bloom::of(film, frame).expect("grids");
        MeterParams::new(film, &bloom).expect("a metered film")
    }

    /// A frame of one light: its luminance comes to the target, whatever the percentile.
    #[test]
    fn even_light_comes_to_the_target() {
        for (light, percentile, target) in [(0.01, 50.0, 0.18), (7.3, 1.0, 0.5), (900.0, 100.0, 1.0), (2e-4, 0.0, 0.3)]
        {
            let limits = AutoExposure { least_ev: -20.0, most_ev: 20.0, ..AutoExposure::default() };
            let auto = AutoExposure { strength: 1.0, percentile, target, ..limits };
            let params = params(&film(auto, 0.0, 0.0), [320, 180]);
            let metered = Metered::new(params, None, |_| [light; 3]).expect("memory");
            let shown = metered.over([light, light, light, 0.5], 10, 10);
            // An eighth of a stop is the width of a bin.
            let off = (f64::from(shown[0]) / target).log2();
            assert!(off.abs() <= 0.126 && shown[3] == 0.5, "{light}: {off} stops off");
        }
    }

    /// Percentiles of luminance that is even in its logarithm, against their closed form.
    #[test]
    fn percentiles_are_those_of_the_light() {
        let frame = [640, 400];
        for percentile in [1.0, 25.0, 50.0, 90.0, 99.0] {
            let auto = AutoExposure { strength: 1.0, percentile, target: 1.0, ..AutoExposure::default() };
            let params = params(&film(auto, 0.0, 0.0), frame);
            let count = params.cells[0] * params.cells[1];
            let stop = |i: usize| 12.0 * (i as f32 + 0.5) / count as f32 - 8.0;
            let metered = Metered::new(params, None, |i| [stop(i).exp2(); 3]).expect("memory");
            let exact = 8.0 - 12.0 * percentile as f32 / 100.0;
            assert!((metered.stops - exact.clamp(-8.0, 8.0)).abs() < 1e-2, "{percentile}: {}", metered.stops);
        }
    }

    #[test]
    fn black_cells_do_not_count_and_limits_hold() {
        let auto = AutoExposure { strength: 1.0, percentile: 50.0, target: 1.0, ..AutoExposure::default() };
        let lit = |i: usize| if i.is_multiple_of(10) { [4.0; 3] } else { [0.0; 3] };
        let mostly_black = Metered::new(params(&film(auto, 0.0, 0.0), [64, 64]), None, lit).expect("memory");
        assert!((mostly_black.stops + 2.0).abs() < 0.126, "{}", mostly_black.stops);
        let limited = AutoExposure { least_ev: -1.5, most_ev: -0.5, ..auto };
        let params = params(&film(limited, 0.0, 0.0), [64, 64]);
        assert_eq!(Metered::new(params, None, lit).expect("memory").stops, -1.5);
        assert_eq!(Metered::new(params, None, |_| [1e-3; 3]).expect("memory").stops, -0.5);
        assert_eq!(Metered::new(params, None, |_| [0.0; 3]).expect("memory").stops, 0.0);
        assert_eq!(Metered::new(params, Some(-1.0), |_| [0.0; 3]).expect("memory").stops, 0.0);
        let slow = MeterParams { adaptation: 0.5, ..params };
        assert_eq!(Metered::new(slow, Some(-1.0), |_| [0.0; 3]).expect("memory").stops, -1.0);
        assert!(Metered::new(params, None, |_| [f32::NAN; 3]).expect("memory").stops.is_finite());
    }

    /// Frames come nearer by the same share each, and a strength of a half goes half of the way.
    #[test]
    fn exposure_adapts_by_shares() {
        let auto =
            AutoExposure { strength: 0.5, percentile: 50.0, target: 1.0, adaptation: 0.25, ..Default::default() };
        let params = params(&film(auto, 0.0, 0.0), [64, 64]);
        let light = |_| [16.0_f32; 3];
        let at_once = Metered::new(params, None, light).expect("memory").stops;
        assert!((at_once + 2.0).abs() < 0.07, "{at_once}");
        let mut stops = 0.0;
        for frame in 1..20 {
            stops = Metered::new(params, Some(stops), light).expect("memory").stops;
            assert!((stops - at_once * (1.0 - 0.75_f32.powi(frame))).abs() < 1e-5, "{frame}: {stops}");
        }
    }

    /// Bright disk beside dark sky with a fine structure on both: the base changes, the structure stays, and neither
    /// side's edge brightens or darkens towards the other.
    #[test]
    fn structure_stays_and_edges_have_no_halo() {
        let frame = [960, 540];
        let params = params(&film(AutoExposure::default(), 0.5, 0.5), frame);
        let ripple = |x: u32, y: u32| 1.0 + 0.2 * ((x / 2 + y / 2) % 2) as f32;
        let side = |x: u32| if x < 480 { 64.0 } else { 0.002 };
        let width = params.cells[0] as usize;
        let of_cell =
            |i: usize| [side(2 * (i % width) as u32) * ripple(2 * (i % width) as u32, 2 * (i / width) as u32); 3];
        let metered = Metered::new(params, None, of_cell).expect("memory");
        let at = |x: u32, y: u32| {
            let light = side(x) * ripple(x, y);
            metered.over([light, light, light, 1.0], x, y)[0]
        };
        for (far, near) in [(100_u32, 460..476_u32), (860, 480..496)] {
            let wanted = (at(far, 270) + at(far + 2, 270)) / 2.0;
            for x in near.step_by(4).skip(1) {
                let mean = (at(x, 270) + at(x + 2, 270)) / 2.0;
                assert!((mean / wanted - 1.0).abs() < 0.01, "{x}: {mean}, far from the edge {wanted}");
            }
            let contrast = (at(far, 270) / at(far + 2, 270)).log2().abs();
            assert!((contrast - 1.2_f32.log2()).abs() < 0.02, "contrast of {contrast} stops");
        }
        let span = (at(100, 270) / at(860, 270)).log2();
        let before = (64.0_f32 / 0.002).log2();
        assert!((span - before / 2.0).abs() < 0.5, "{before} stops became {span}");
        assert_eq!(metered.over([0.0, 0.0, 0.0, 1.0], 700, 100), [0.0, 0.0, 0.0, 1.0]);
    }

    /// In light that grows steadily by a stop in a third of the frame, what is shown grows steadily, too.
    #[test]
    fn smooth_light_gets_no_bands() {
        let params = params(&film(AutoExposure::default(), 1.0, 1.0), [960, 540]);
        let light = |x: u32| (9.0 * (x as f32 + 0.5) / 960.0 - 6.0).exp2();
        let width = params.cells[0] as usize;
        let metered = Metered::new(params, None, |i| [light(2 * (i % width) as u32 + 1); 3]).expect("memory");
        let shown = |x: u32| metered.over([light(x), light(x), light(x), 1.0], x, 270)[0].log2();
        let knee = |x: u32| (light(x).log2() - GREY_STOP).abs() < 1.5;
        let all = (60..900).filter(|x| !knee(*x)).map(shown).collect::<Vec<_>>();
        let (least, most) = all.iter().fold((f32::MAX, f32::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!(most - least < 0.02, "a flat picture varies by {} stops", most - least);
    }

    #[test]
    fn the_knee_is_smooth() {
        for (stops, above) in [(-3.0, 0.0), (-1.0, 0.0), (0.0, 0.25), (1.0, 1.0), (5.0, 5.0)] {
            assert_eq!(smooth_above(stops), above);
        }
        let slope = |at: f32| (smooth_above(at + 1e-3) - smooth_above(at - 1e-3)) / 2e-3;
        for at in [-1.0, 1.0] {
            assert!((slope(at + 5e-3) - slope(at - 5e-3)).abs() < 0.01, "a kink at {at}");
        }
        assert!((GREY_STOP - 0.18_f32.log2()).abs() < 1e-6);
    }
}
