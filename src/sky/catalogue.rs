// SPDX-License-Identifier: MIT OR Apache-2.0
//! The embedded stars, decoded: where they are, how bright, how hot. `data/README.md` describes the bytes and names
//! their source.

use glam::DVec3;

static STARS: &[u8] = include_bytes!("data/stars.bin");

const RECORD_BYTES: usize = 12;
const UNKNOWN_COLOUR: i16 = i16::MIN;
/// B-V of a star whose colour is not known: about the Sun's, and the middle of the catalogue's.
const DEFAULT_COLOUR: f64 = 0.6;
/// Range of B-V in which `temperature` is used: the hottest O stars to the coolest M stars. Redder ones are carbon
/// stars, whose B-V is absorption, not temperature.
const COLOUR_RANGE: (f64, f64) = (-0.4, 2.0);

/// V of the faintest stars of the catalogue, which has all that are brighter.
pub const FAINTEST: f64 = 8.0;

/// A star of the catalogue, or of a random sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Unit vector in sky axes.
    pub direction: DVec3,
    /// V magnitude.
    pub magnitude: f64,
    /// B-V; `DEFAULT_COLOUR` where unknown.
    pub colour: f64,
}

impl Star {
    /// Light received, 1 for V = 0 (Pogson).
    pub fn flux(&self) -> f64 {
        10.0_f64.powf(-0.4 * self.magnitude)
    }

    /// Temperature, K: the star as a blackbody seen through B and V filters (F. J. Ballesteros 2012, EPL 97, 34008, eq.
    /// 14).
    pub fn temperature(&self) -> f64 {
        let colour = 0.92 * self.colour.clamp(COLOUR_RANGE.0, COLOUR_RANGE.1);
        4600.0 * (1.0 / (colour + 1.7) + 1.0 / (colour + 0.62))
    }
}

/// Every star, brightest first.
pub fn stars() -> impl ExactSizeIterator<Item = Star> {
    decode(STARS)
}

/// Whole records only: a cut-off tail is left out.
fn decode(bytes: &[u8]) -> impl ExactSizeIterator<Item = Star> {
    bytes.as_chunks::<RECORD_BYTES>().0.iter().map(|&[a0, a1, a2, a3, d0, d1, d2, d3, m0, m1, c0, c1]| {
        let angle = |units: f64| (units * 1e-4).to_radians();
        let (sin_ra, cos_ra) = angle(u32::from_le_bytes([a0, a1, a2, a3]).into()).sin_cos();
        let (sin_dec, cos_dec) = angle(i32::from_le_bytes([d0, d1, d2, d3]).into()).sin_cos();
        let colour = match i16::from_le_bytes([c0, c1]) {
            UNKNOWN_COLOUR => DEFAULT_COLOUR,
            thousandths => f64::from(thousandths) * 1e-3,
        };
        Star {
            direction: DVec3::new(cos_dec * cos_ra, cos_dec * sin_ra, sin_dec),
            magnitude: f64::from(i16::from_le_bytes([m0, m1])) * 1e-3,
            colour,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn catalogue_reaches_magnitude_8_brightest_first() {
        let all: Vec<Star> = stars().collect();
        assert_eq!(all.len(), 41411);
        assert!(all.windows(2).all(|pair| pair[0].magnitude <= pair[1].magnitude));
        assert!(all.iter().all(|s| (s.direction.length() - 1.0).abs() < 1e-12 && s.magnitude <= FAINTEST));
        assert!(all.iter().all(|s| (3000.0..23000.0).contains(&s.temperature())));
        assert!(all.last().is_some_and(|s| s.magnitude == FAINTEST));
    }

    /// J2000 places, V and B-V of well-known stars (Hoffleit and Warren, Bright Star Catalogue, 5th edition).
    #[test]
    fn well_known_stars_are_where_they_belong() {
        let known = [
            ("Sirius", (6.0 + 45.0 / 60.0 + 8.9 / 3600.0) * 15.0, -(16.0 + 42.0 / 60.0 + 58.0 / 3600.0), -1.46, 0.0),
            ("Vega", (18.0 + 36.0 / 60.0 + 56.3 / 3600.0) * 15.0, 38.0 + 47.0 / 60.0 + 1.0 / 3600.0, 0.03, 0.0),
            ("Betelgeuse", (5.0 + 55.0 / 60.0 + 10.3 / 3600.0) * 15.0, 7.0 + 24.0 / 60.0 + 25.0 / 3600.0, 0.5, 1.85),
            ("Polaris", (2.0 + 31.0 / 60.0 + 48.7 / 3600.0) * 15.0, 89.0 + 15.0 / 60.0 + 51.0 / 3600.0, 2.02, 0.6),
        ];
        for (name, ra, dec, magnitude, colour) in known {
            let (ra, dec) = (f64::to_radians(ra), f64::to_radians(dec));
            let direction = DVec3::new(dec.cos() * ra.cos(), dec.cos() * ra.sin(), dec.sin());
            // Half an arc minute: the catalogues' epochs differ by proper motion.
            let found = stars().find(|s| s.direction.distance(direction) < 1.5e-4 && s.magnitude < 3.0);
            let star = found.unwrap_or_else(|| panic!("{name} is missing"));
            assert!((star.magnitude - magnitude).abs() < 0.1, "{name}: {star:?}");
            assert!((star.colour - colour).abs() < 0.4, "{name}: {star:?}");
        }
    }

    #[test]
    fn temperature_and_flux_follow_their_scales() {
        let star = |magnitude, colour| Star { direction: DVec3::X, magnitude, colour };
        assert!((star(0.0, 0.65).temperature() - 5770.0).abs() < 50.0, "the Sun");
        assert!((star(0.0, 0.0).temperature() - 10125.0).abs() < 1.0, "4600 (1 / 1.7 + 1 / 0.62)");
        assert_eq!(star(0.0, 5.0).temperature(), star(0.0, 2.0).temperature());
        assert!((star(5.0, 0.0).flux() - 0.01).abs() < 1e-15);
    }

    #[test]
    fn any_length_decodes() {
        for length in 0..40 {
            assert_eq!(decode(&STARS[..length]).len(), length / 12);
        }
        let unknown = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80];
        assert_eq!(decode(&unknown).next().map(|s| s.colour), Some(DEFAULT_COLOUR));
    }
}
