// SPDX-License-Identifier: MIT OR Apache-2.0
//! A random sky that is like the real one in what can be counted: how many stars of each magnitude, how they crowd
//! towards the Milky Way, and which colours they have. The same stars for the same seed on every machine.

use super::catalogue::{self, Star};
use super::galaxy::{GALACTIC_CENTRE, GALACTIC_EAST, GALACTIC_POLE, crowded_sine};
use crate::allocate::collected;
use crate::error::Result;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// The number of stars in a field; the faintest of them have V = 11.07.
pub const PROCEDURAL_STARS: u32 = 1_000_000;

/// Stars of the whole sky that are not fainter than V = 0, 1, 2 ..: to 8 the embedded catalogue's, then by Allen 1973,
/// Astrophysical Quantities, 3rd edition, section 117.
const COUNTS: [f64; 13] =
    [4.0, 15.0, 49.0, 177.0, 519.0, 1627.0, 5044.0, 15544.0, 41411.0, 121_000.0, 340_000.0, 927_000.0, 2_460_000.0];
/// V of the brightest star there may be: Sirius.
const BRIGHTEST: f64 = -1.46;
/// Share of the stars that crowd towards the Milky Way (`galaxy::crowding`), for stars as bright as the catalogue's,
/// measured there; beyond it all do, which makes them 4 times as dense in the plane as at the poles (Allen: 3.5 to 5
/// for V 8 to 11).
const CROWDING_OF_BRIGHT: f64 = 0.7;

/// The catalogue's colours by magnitude.
struct Colours(Vec<Star>);

impl Colours {
    /// B-V of a star of the catalogue about as bright: of those within a twentieth of the number of brighter ones, and
    /// 200; for stars fainter than the catalogue's of its faintest.
    fn like(&self, magnitude: f64, random: &mut Pcg32) -> f64 {
        let rank = self.0.partition_point(|star| star.magnitude < magnitude);
        let reach = 200.max(rank / 20);
        let nearby = self.0.get(rank.saturating_sub(reach)..self.0.len().min(rank + reach)).unwrap_or(&[]);
        let chosen = (unit(random) * nearby.len() as f64) as usize;
        nearby.get(chosen).map_or(0.0, |star| star.colour)
    }
}

/// The stars of a field, in no order. Errors: OUT_OF_MEMORY.
pub fn stars(seed: u64) -> Result<impl Iterator<Item = Star>> {
    let colours = Colours(collected(catalogue::stars(), "the catalogue's stars")?);
    let mut random = Pcg32::seed_from_u64(seed);
    Ok((0..PROCEDURAL_STARS).map(move |_| {
        let magnitude = magnitude(f64::from(PROCEDURAL_STARS) * unit(&mut random));
        let colour = colours.like(magnitude, &mut random);
        Star { direction: direction(magnitude, &mut random), magnitude, colour }
    }))
}

/// A random number in [0, 1), a multiple of 2^-53.
fn unit(random: &mut Pcg32) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// V of the star that `brighter` stars of the sky outshine, log N going straight between the counts. In thousandths,
/// as in the catalogue: what the last bits of a machine's logarithm are then does not matter.
fn magnitude(brighter: f64) -> f64 {
    let bin = COUNTS.iter().skip(1).take_while(|&&count| count < brighter).count().min(COUNTS.len() - 2);
    let (low, high) = (COUNTS[bin], COUNTS[bin + 1]);
    let exact = bin as f64 + (brighter / low).ln() / (high / low).ln();
    (1e3 * exact.max(BRIGHTEST)).round() * 1e-3
}

/// A random direction, by operations that every machine rounds alike.
fn direction(magnitude: f64, random: &mut Pcg32) -> glam::DVec3 {
    let crowds = magnitude > catalogue::FAINTEST || unit(random) < CROWDING_OF_BRIGHT;
    // The share of stars nearer to the plane, with its side of the plane for a sign.
    let share = 2.0 * unit(random) - 1.0;
    let sine = if crowds { crowded_sine(share.abs()).copysign(share) } else { share };
    // Longitude: a point of the unit disk (Marsaglia 1972).
    let (x, y, square) = loop {
        let (x, y) = (2.0 * unit(random) - 1.0, 2.0 * unit(random) - 1.0);
        let square = x * x + y * y;
        if square > 0.0 && square < 1.0 {
            break (x, y, square);
        }
    };
    let along = ((1.0 - sine * sine) / square).sqrt();
    ((GALACTIC_CENTRE * x + GALACTIC_EAST * y) * along + GALACTIC_POLE * sine).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sky::galaxy::crowding;

    #[test]
    fn counts_follow_the_real_sky() {
        let field: Vec<Star> = stars(7).expect("stars").collect();
        assert_eq!(field.len(), PROCEDURAL_STARS as usize);
        assert!(field.iter().all(|star| (star.direction.length() - 1.0).abs() < 1e-12));
        for (v, count) in (0..).zip(COUNTS).take(12) {
            let found = field.iter().filter(|star| star.magnitude <= f64::from(v)).count() as f64;
            // Four standard deviations; magnitudes are rounded to a thousandth.
            assert!((found - count).abs() < 4.0 * count.sqrt() + 2e-3 * count, "{found} stars to V = {v}, not {count}");
        }
        assert!(field.iter().all(|star| (BRIGHTEST..11.1).contains(&star.magnitude)));
        // The embedded counts are the catalogue's.
        let real: Vec<Star> = catalogue::stars().collect();
        for (v, count) in (0..).zip(COUNTS).take(9) {
            assert_eq!(real.iter().filter(|star| star.magnitude <= f64::from(v)).count() as f64, count, "V = {v}");
        }
    }

    #[test]
    fn colours_and_crowding_are_the_catalogues() {
        let field: Vec<Star> = stars(8).expect("stars").filter(|star| star.magnitude <= catalogue::FAINTEST).collect();
        let real: Vec<Star> = catalogue::stars().collect();
        assert!((crowding(&real) - CROWDING_OF_BRIGHT).abs() < 0.03, "{}", crowding(&real));
        assert!((crowding(&field) - CROWDING_OF_BRIGHT).abs() < 0.06, "{}", crowding(&field));
        for (low, high) in [(3.0, 5.0), (5.0, 6.5), (6.5, 7.5), (7.5, 8.0)] {
            let quartiles = |stars: &[Star]| {
                let within = stars.iter().filter(|star| (low..high).contains(&star.magnitude));
                let mut colours = within.map(|star| star.colour).collect::<Vec<_>>();
                colours.sort_by(f64::total_cmp);
                [1, 2, 3].map(|quarter| colours[quarter * colours.len() / 4])
            };
            for (found, real) in quartiles(&field).iter().zip(quartiles(&real)) {
                assert!((found - real).abs() < 0.08, "V {low} .. {high}: B-V {found}, not {real}");
            }
        }
        let faint: Vec<Star> = stars(8).expect("stars").filter(|star| star.magnitude > catalogue::FAINTEST).collect();
        assert!(crowding(&faint) > 0.97, "{}", crowding(&faint));
        // (1.975 / 1.025)^2 between the middles of these ranges.
        let height = |low: f64, high: f64| {
            let sine = |star: &&Star| (low..high).contains(&star.direction.dot(GALACTIC_POLE).abs());
            faint.iter().filter(sine).count() as f64
        };
        assert!(
            (height(0.0, 0.05) / height(0.95, 1.0) - 3.71).abs() < 0.1,
            "{} {}",
            height(0.0, 0.05),
            height(0.95, 1.0)
        );
    }

    /// The numbers themselves, so that another machine or version that makes other stars is found out.
    #[test]
    fn a_seed_means_the_same_stars_everywhere() {
        let first = |seed| stars(seed).expect("stars").next().expect("a star");
        assert_eq!(first(1), first(1));
        assert_ne!(first(1).direction, first(2).direction);
        assert_ne!(first(0).direction, first(u64::MAX).direction);
        let sum = stars(1).expect("stars").take(1000).fold(0_i64, |sum, star| {
            sum + (star.magnitude * 1e3).round() as i64
                + (star.colour * 1e3).round() as i64
                + (star.direction.x * 1e6) as i64
        });
        assert_eq!(sum, 26_696_065);
    }
}
