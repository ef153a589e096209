// SPDX-License-Identifier: MIT OR Apache-2.0
//! The part of a frame that an image holds.

use super::Projection;
use crate::emit::moment::Shutter;
use crate::error::{Error, Result};

/// The image is this part of a larger frame of `full_width` x `full_height` pixels: its top-left pixel is (x, y).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    pub full_width: u32,
    pub full_height: u32,
    pub x: u32,
    pub y: u32,
}

impl Region {
    /// Largest frame side: f32 still tells pixels apart.
    pub const MAX_FRAME_SIDE: u32 = 1 << 20;

    /// Errors: a zero or too large frame, an origin outside it.
    pub fn check(&self) -> Result<()> {
        let max = Self::MAX_FRAME_SIDE;
        if self.full_width == 0 || self.full_height == 0 || self.full_width > max || self.full_height > max {
            return Err(Error::argument(format!(
                "region frame is {} x {}; each side must lie in [1, {max}]",
                self.full_width, self.full_height
            )));
        }
        if self.x >= self.full_width || self.y >= self.full_height {
            return Err(Error::argument(format!(
                "region begins at ({}, {}), outside its {} x {} frame",
                self.x, self.y, self.full_width, self.full_height
            )));
        }
        Ok(())
    }
}

impl Region {
    /// Errors: as `check`, or a `width` x `height` image at (x, y) that reaches outside the frame.
    pub fn check_image(&self, width: u32, height: u32) -> Result<()> {
        self.check()?;
        let overrun = |name: &str, begin: u32, size: u32, full: u32| {
            if u64::from(begin) + u64::from(size) <= u64::from(full) {
                return Ok(());
            }
            Err(Error::argument(format!("region {name} {begin} + image size {size} exceeds the frame's {full}")))
        };
        overrun("x", self.x, width, self.full_width)?;
        overrun("y", self.y, height, self.full_height)
    }
}

/// The place in its pixel, 0 .. 1 each way, of sample `index` of `count`: the centre for one sample, else drawn by the
/// filter that a picture is reconstructed with, so that all samples weigh the same (importance sampling of the filter:
/// M. Ernst, M. Stamminger, G. Greiner, IEEE Ray Tracing 2006). It is the same for every pixel and machine.
///
/// The filter is the quadratic B-spline, 3 pixels wide, sigma 1/2. A box, which a pixel is, lets through 30 % of what
/// repeats every 4/3 pixels, which then shows as a pattern 4 pixels long; the spline lets through 3 %, and 26 % of the
/// finest detail that pixels can show (box: 64 %). Filters that keep more of it have negative lobes, which make dark
/// rings around stars and the photon ring. CUBE uses the box, because another part of the sky begins across a border of
/// its faces.
fn sample_offset(index: u32, count: u32, projection: Projection) -> [f64; 2] {
    let place = lattice(index, count);
    if projection == Projection::Cube { place } else { place.map(|share| 0.5 + spline_quantile(share)) }
}

/// The place of a sample in its pixel, and the time at which it sees matter less that of the frame, M. While a shutter
/// is open the samples differ in time alone, and all go through the middle of the pixel: light is filtered there, and
/// samples that differ in place, too, would mix noise of place into the blur.
pub fn sample_of(index: u32, count: u32, projection: Projection, shutter: Shutter) -> ([f64; 2], f64) {
    match shutter.is_open() {
        true => ([0.5; 2], shutter.moment(index, count)),
        false => (sample_offset(index, count, projection), 0.0),
    }
}

/// `count` places in a unit square, spread evenly for any count: even steps in x and steps of the golden ratio, modulo
/// 1, in y.
pub fn lattice(index: u32, count: u32) -> [f64; 2] {
    let (i, n) = (f64::from(index), f64::from(count));
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    // Point symmetric: the mean lies at the pixel's centre exactly.
    let turn = 0.5 - golden * (n - 1.0) / 2.0;
    [(i + 0.5) / n, (i * golden + turn).rem_euclid(1.0)]
}

/// The x up to which the integral of the quadratic B-spline from -3/2 on is `share`, 0 .. 1.
fn spline_quantile(share: f64) -> f64 {
    let from_middle = share - 0.5;
    if from_middle.abs() > 1.0 / 3.0 {
        // (3/2 - |x|)^3 / 6 is beyond x.
        let beyond = 0.5 - from_middle.abs();
        return (1.5 - (6.0 * beyond).max(0.0).cbrt()).copysign(from_middle);
    }
    // 3/4 x - x^3 / 3, which x = sqrt(3) sin(phi) makes sqrt(3)/4 sin(3 phi).
    3.0_f64.sqrt() * ((4.0 / 3.0_f64.sqrt() * from_middle).asin() / 3.0).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offsets(count: u32) -> Vec<[f64; 2]> {
        (0..count).map(|i| sample_offset(i, count, Projection::Perspective)).collect()
    }

    #[test]
    fn one_sample_lies_at_the_centre() {
        assert_eq!(sample_offset(0, 1, Projection::Perspective), [0.5, 0.5]);
    }

    #[test]
    fn samples_are_centred_and_have_the_spline_s_spread() {
        for count in 2..=256 {
            for c in 0..2 {
                let at = offsets(count).iter().map(|o| o[c] - 0.5).collect::<Vec<_>>();
                let mean = at.iter().sum::<f64>() / f64::from(count);
                let variance = at.iter().map(|v| v * v).sum::<f64>() / f64::from(count);
                assert!(mean.abs() < 1e-9, "{count}: mean {mean}");
                assert!(at.iter().all(|v| v.abs() < 1.5), "{count}: {at:?}");
                // A few samples lack the tails.
                let off = 1.5 / f64::from(count);
                assert!((variance - 0.25).abs() < off, "{count}: variance {variance} in {c}");
            }
        }
    }

    /// The share of samples before x is the spline's integral.
    #[test]
    fn samples_are_distributed_as_the_spline() {
        let integral = |x: f64| match x.abs() {
            y if y >= 1.5 => f64::from(x > 0.0),
            y if y > 0.5 => (0.5 + (0.5 - (1.5 - y).powi(3) / 6.0).copysign(x)).clamp(0.0, 1.0),
            _ => 0.5 + 0.75 * x - x.powi(3) / 3.0,
        };
        for c in 0..2 {
            let offsets = offsets(256);
            for i in -16..=16 {
                let x = f64::from(i) / 10.0;
                let before = offsets.iter().filter(|o| o[c] - 0.5 < x).count() as f64 / 256.0;
                assert!((before - integral(x)).abs() < 0.01, "{before} of the samples before {x}: {}", integral(x));
            }
        }
        for i in 0..=1000 {
            let share = f64::from(i) / 1000.0;
            assert!((integral(spline_quantile(share)) - share).abs() < 1e-12, "{share}");
        }
    }

    /// A straight edge through the pixel at any angle and place: what samples see of it comes near what the filter
    /// does, and the nearer the more they are.
    #[test]
    fn edges_converge() {
        let exact = offsets_of_a_grid(512);
        let error = |count: u32| {
            let mut worst = 0.0_f64;
            for (angle, place) in
                (0..24).flat_map(|a| (-10..=10).map(move |p| (f64::from(a) * 0.13, f64::from(p) * 0.1)))
            {
                let seen = |at: &[[f64; 2]]| {
                    let below = at.iter().filter(|o| (o[0] - 0.5) * angle.cos() + (o[1] - 0.5) * angle.sin() < place);
                    below.count() as f64 / at.len() as f64
                };
                worst = worst.max((seen(&offsets(count)) - seen(&exact)).abs());
            }
            worst
        };
        let errors = [4, 16, 64, 256].map(error);
        println!("{errors:?}");
        assert!(errors[0] < 0.3 && errors[1] < 0.12 && errors[2] < 0.05 && errors[3] < 0.02, "{errors:?}");
    }

    /// The filter by a grid of `side` x `side`.
    fn offsets_of_a_grid(side: u32) -> Vec<[f64; 2]> {
        let at = |i: u32| 0.5 + spline_quantile((f64::from(i) + 0.5) / f64::from(side));
        (0..side).flat_map(|y| (0..side).map(move |x| [at(x), at(y)])).collect()
    }
}
