// SPDX-License-Identifier: MIT OR Apache-2.0
//! The matter that a ray passes between two crossings of the plane, summed up: the light that it sends to the observer
//! and the share of the light from behind that it lets through. Knows no kind of matter.

use crate::physics::geodesic::State;
use crate::physics::trace::{CROSSINGS_KEPT, Part};
use arrayvec::ArrayVec;

/// A stretch of a ray, from the observer's end of it to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The light that leaves the observer's end of the stretch, linear Rec. 709 as the camera measures it.
    pub light: [f64; 3],
    /// The share of the light from behind that passes, 0 .. 1.
    pub through: f64,
}

/// A stretch with nothing in it.
impl Default for Medium {
    fn default() -> Self {
        Self { light: [0.0; 3], through: 1.0 }
    }
}

impl Medium {
    /// Adds matter behind what is there already. `emitted` is the light that it would send if it absorbed none, `depth`
    /// its optical depth. Emission and absorption are taken as even within it, so that exp(-depth) of the light behind
    /// passes, and of its own light the mean of exp(-x depth) over x in 0 .. 1. (Rybicki & Lightman 1979, eq. 1.30.)
    pub fn add(&mut self, emitted: [f64; 3], depth: f64) {
        // At smaller depths the quotient would be mostly rounding error.
        let own = if depth > 1e-5 { -(-depth).exp_m1() / depth } else { 1.0 - 0.5 * depth };
        (0..3).for_each(|c| self.light[c] += self.through * own * emitted[c]);
        self.through *= (-depth).exp();
    }

    /// Adds the matter along a part of a ray. `matter` gives emission and absorption at a state, per unit of affine
    /// length (`Part::length`). The part is cut into pieces over which 1/r changes little, each summed by three-point
    /// Gauss-Legendre quadrature (Abramowitz & Stegun 1964, table 25.4).
    pub fn add_part(&mut self, part: &Part<'_>, matter: impl Fn(&State) -> ([f64; 3], f64)) {
        let pieces = pieces(part.at(0.0).u, part.at(1.0).u);
        let size = 1.0 / f64::from(pieces);
        let offset = 0.6_f64.sqrt() / 2.0;
        for piece in 0..pieces {
            for (x, weight) in [(0.5 - offset, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + offset, 5.0 / 18.0)] {
                let there = part.at((f64::from(piece) + x) * size);
                // No matter is past infinity (u <= 0), where the last step of a ray may end, nor within the horizon.
                if there.u > 0.0 && there.u < 1.0 / part.constants.r_plus {
                    let (emission, absorption) = matter(&there);
                    let length = weight * size * part.length(&there);
                    self.add(emission.map(|e| e * length), absorption * length);
                }
            }
        }
    }
}

/// The most pieces that a part is cut into.
pub(crate) const MOST_PIECES: u32 = 24;
/// The greatest change of ln u over a piece, unless that needs more than `MOST_PIECES`.
pub(crate) const PIECE: f64 = 0.15;

/// The number of pieces for the part of a ray from 1/r = `u` to 1/r = `v`. An end more than a hundred times farther out
/// than the other counts as a hundred times farther, because ln u has no value at infinity.
pub(crate) fn pieces(u: f64, v: f64) -> u32 {
    let least = 0.01 * u.max(v).max(f64::MIN_POSITIVE);
    let change = (u.max(least) / v.max(least)).ln().abs();
    (change / PIECE).ceil().clamp(1.0, f64::from(MOST_PIECES)) as u32
}

/// The medium before each kept crossing of a ray, then the one behind the last.
pub type Media = ArrayVec<Medium, { CROSSINGS_KEPT + 1 }>;

#[cfg(test)]
mod tests {
    use super::*;

    /// Even matter in front of light: I = I0 e^-t + S (1 - e^-t), however it is cut into pieces.
    #[test]
    fn even_matter_follows_the_transfer_equation() {
        for depth in [0.0, 1e-9, 1e-4, 0.3, 5.0, 100.0] {
            let source = 2.0;
            for pieces in [1, 7] {
                let mut medium = Medium::default();
                let part = depth / f64::from(pieces);
                (0..pieces).for_each(|_| medium.add([source * part; 3], part));
                let expected = source * -f64::exp_m1(-depth);
                assert!((medium.light[1] - expected).abs() <= 1e-12 * expected, "{depth}: {medium:?}");
                assert!((medium.through - f64::exp(-depth)).abs() < 1e-14);
            }
        }
    }
}
