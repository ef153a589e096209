// SPDX-License-Identifier: MIT OR Apache-2.0
//! The bands of radius in which structure is renewed, and the generations that follow each other there: which of them
//! show at a place and a time, how old they are and how strongly they show. Mirrored by `shaders/emit/bands.wgsl`.
//! Knows no pattern and no law of motion but the rates that it is given.
//!
//! Matter at radius r turns by its angular velocity times its age. Were age counted from one instant, differential
//! rotation would wind a pattern up without end. So space is split into bands, equally wide in ln r, in each of which
//! generations of the pattern follow each other, each carried by its own age only.
//!
//! Where two bands meet, and while one generation follows another, both show, weighted by cos and sin: the squares of
//! all weights add up to 1, so that a sum of independent patterns has the same variance everywhere and at any time. A
//! generation is invisible when it comes and goes.

use crate::random::mix;
use arrayvec::ArrayVec;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The width of a band in ln r, and the share of it over which it blends with its neighbours.
pub(crate) const BAND: f64 = 0.3;
pub(crate) const BAND_FADE: f64 = 0.35;
/// `Life::fade` of the disk's turbulence.
pub(crate) const GENERATION_FADE: f64 = 0.35;
/// Bands that an emitter has at most: from r = 1 to its largest radius, and one more at either end for places beside
/// it.
pub(crate) const MOST_BANDS: usize = 50;

/// When a frame shows its emitters. Times in M.
#[derive(Clone, Copy, Debug, Default)]
pub struct When {
    /// The time at which light leaves emitters whose delay is `reference_delay`.
    pub time: f64,
    /// 0 where light is not delayed.
    pub reference_delay: f64,
    /// Whether light is seen as it left, each ray's by its own delay.
    pub delayed: bool,
    /// The time over which the moments of samples are spread, half of it before `time` (`super::moment`).
    pub shutter: f64,
}

/// How long the generations of a band live, M, how far in ln r they are carried per M, and the time in which one fades
/// in, and the one before it out, in times from birth to birth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Life {
    pub time: f64,
    pub drift: f64,
    pub fade: f64,
    /// Whether it begins and ends to fade without a kink.
    pub eased: bool,
}

/// The generations of a band as a frame shows them: small numbers that f32 can hold, however large the scene's time is.
/// Times in M.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Band {
    /// The age of the youngest generation at the reference time.
    pub age: f64,
    /// The time from birth to birth.
    pub spacing: f64,
    /// The number of the youngest generation, counted modulo 2^32.
    pub generation: u32,
    /// The change of ln r that carries the pattern, per M.
    pub drift: f64,
    /// `Life::fade` and `Life::eased`.
    pub fade: f64,
    pub eased: bool,
}

/// The bands of a frame's emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bands {
    pub seed: u32,
    /// The number of the first band, band 0 beginning at r = 1, and how many there are.
    pub first: i32,
    pub count: usize,
    pub bands: [Band; MOST_BANDS],
}

/// The bands that show at N radii close to each other: the number of the first, how many, and the weights of the first
/// and the next at each radius.
#[derive(Clone, Copy, Debug)]
pub struct BandsAt<const N: usize> {
    pub first: i32,
    pub count: usize,
    pub shares: [[f64; N]; 2],
}

/// The generations of a band that live at a time: the age and the number of the youngest, how many there are, and the
/// weights of the youngest and the one before it.
#[derive(Clone, Copy, Debug)]
pub struct Generations {
    pub young: f64,
    pub youngest: u32,
    pub count: usize,
    pub weights: [f64; 2],
}

/// A generation that shows at a place, with its weights at N radii about it.
#[derive(Clone, Copy, Debug)]
pub struct Shown<const N: usize> {
    pub weights: [f64; N],
    /// M.
    pub age: f64,
    pub drift: f64,
    /// `generation_key`.
    pub key: u32,
}

impl Bands {
    /// The bands from one radius to another, with one more on either side, at `time`; `life`: of the band with the
    /// middle ln r.
    pub fn new(ln_r: [f64; 2], seed: u64, time: f64, life: impl Fn(f64) -> Life) -> Self {
        let seed = mix((seed as u32).wrapping_add(mix((seed >> 32) as u32)));
        let [first, last] = ln_r.map(|ln_r| (ln_r / BAND).floor() as i32);
        let (first, count) = (first - 1, ((last - first + 3).max(1) as usize).min(MOST_BANDS));
        let mut bands = [Band::default(); MOST_BANDS];
        for (band, number) in bands.iter_mut().zip(first..).take(count) {
            let Life { time: life, drift, fade, eased } = life(BAND * (f64::from(number) + 0.5));
            let spacing = life / (1.0 + fade);
            // Bands do not all renew themselves at once.
            let begin = f64::from(mix(seed.wrapping_add(mix(number as u32)))) / 4_294_967_296.0;
            let age = (time + begin * spacing).rem_euclid(spacing);
            let births = ((time - age) / spacing + begin).round();
            let generation = births.rem_euclid(4_294_967_296.0) as u32;
            *band = Band { age, spacing, generation, drift, fade, eased };
        }
        Self { seed, first, count, bands }
    }

    /// The generations that show at any of the `ln_r`, `later` than the reference time: those of one band or two.
    pub fn shown<const N: usize>(&self, ln_r: [f64; N], later: f64) -> ArrayVec<Shown<N>, 4> {
        let mut all = ArrayVec::new();
        let BandsAt { first, count, shares } = bands_at(ln_r);
        for (k, number) in (first..).take(count).enumerate() {
            let band = self.band(number);
            let Generations { young, youngest, count, weights } = band.generations(later);
            for (old, weight) in (0..).zip(weights).take(count) {
                // There is room for two generations of two bands.
                let _ = all.try_push(Shown {
                    weights: shares[k].map(|share| share * weight),
                    age: young + f64::from(old) * band.spacing,
                    drift: band.drift,
                    key: generation_key(number, youngest.wrapping_sub(old), self.seed),
                });
            }
        }
        all
    }

    /// Beyond the last band it goes on.
    pub fn band(&self, number: i32) -> Band {
        let index = (number - self.first).clamp(0, self.count.max(1) as i32 - 1);
        self.bands[index as usize]
    }
}

impl Band {
    /// The generations that live `later` than the reference time: one, or two while one follows the other.
    pub fn generations(&self, later: f64) -> Generations {
        let since = self.age + later;
        let births = (since / self.spacing).floor();
        let young = since - births * self.spacing;
        let youngest = self.generation.wrapping_add(births as i32 as u32);
        let grown = young / (self.fade * self.spacing);
        if grown < 1.0 {
            let grown = if self.eased { grown * grown * (3.0 - 2.0 * grown) } else { grown };
            let (new, old) = (FRAC_PI_2 * grown).sin_cos();
            Generations { young, youngest, count: 2, weights: [new, old] }
        } else {
            Generations { young, youngest, count: 1, weights: [1.0, 0.0] }
        }
    }
}

/// The bands that show at N values of ln r, of which the middle one tells the border: one band, or two about it.
pub fn bands_at<const N: usize>(ln_r: [f64; N]) -> BandsAt<N> {
    let border = (ln_r[N / 2] / BAND + 0.5).floor();
    let across = ln_r.map(|ln_r| (ln_r / BAND - border) * (2.0 / BAND_FADE));
    let border = border.clamp(-1e6, 1e6) as i32;
    if across.iter().all(|across| *across >= 1.0) {
        return BandsAt { first: border, count: 1, shares: [[1.0; N], [0.0; N]] };
    }
    if across.iter().all(|across| *across <= -1.0) {
        return BandsAt { first: border - 1, count: 1, shares: [[1.0; N], [0.0; N]] };
    }
    let turns = across.map(|across| FRAC_PI_4 * (across.clamp(-1.0, 1.0) + 1.0));
    BandsAt { first: border - 1, count: 2, shares: [turns.map(f64::cos), turns.map(f64::sin)] }
}

/// The bits of a generation of a band, from which it has its part of the pattern.
pub fn generation_key(band: i32, generation: u32, seed: u32) -> u32 {
    mix((band as u32).wrapping_add(mix(generation.wrapping_add(seed))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bands(time: f64, seed: u64) -> Bands {
        Bands::new([0.5, 3.5], seed, time, |ln_r| Life {
            time: (1.5 * ln_r).exp(),
            drift: 0.25,
            fade: GENERATION_FADE,
            eased: time > 0.0,
        })
    }

    /// The variance of a sum of independent patterns, and so of one that fades into another.
    #[test]
    fn squares_of_weights_add_up_to_one() {
        for time in [0.0, -77.7, 1e6, 1e12] {
            let bands = bands(time, 3);
            let mut most = 0;
            for i in 0..4000 {
                let (ln_r, apart) = (0.4 + f64::from(i) * 8e-4, f64::from(i % 11) * 0.01);
                let shown = bands.shown([ln_r - apart, ln_r, ln_r + apart], f64::from(i % 37) - 20.0);
                most = most.max(shown.len());
                for k in 0..3 {
                    let sum: f64 = shown.iter().map(|s| s.weights[k] * s.weights[k]).sum();
                    assert!((sum - 1.0).abs() < 1e-12, "{time} {i}: {sum}");
                }
            }
            assert_eq!(most, 4, "{time}");
        }
    }

    /// `later` is time: the same generations at the same ages, whichever of the two tells when.
    #[test]
    fn later_is_time() {
        let (early, late) = (bands(1000.0, 8), bands(1040.0, 8));
        for i in 0..300 {
            let ln_r = 0.6 + 0.009 * f64::from(i);
            let [mut a, mut b] = [early.shown([ln_r], 40.0), late.shown([ln_r], 0.0)];
            // At the very end of its life one may be left out by a rounding.
            [&mut a, &mut b].into_iter().for_each(|shown| shown.retain(|s| s.weights[0] > 1e-6));
            assert_eq!(a.len(), b.len(), "{ln_r}");
            for (a, b) in a.iter().zip(&b) {
                assert!(
                    (a.age - b.age).abs() < 1e-9 && (a.weights[0] - b.weights[0]).abs() < 1e-9,
                    "{ln_r}: {a:?} {b:?}"
                );
                assert_eq!((a.key, a.drift), (b.key, 0.25), "{ln_r}");
            }
        }
    }
}
