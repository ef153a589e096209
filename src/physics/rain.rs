// SPDX-License-Identifier: MIT OR Apache-2.0
//! Doran's chart of a spinning hole beside Boyer and Lindquist's: by how much their azimuths and their times differ at
//! a radius. Doran's are regular at both horizons for everything that falls in. Knows no motion.
//!
//! Doran 2000 (Phys. Rev. D 61, 067503, eq. 1 - 5): with T the time of observers who fall from rest at infinity,
//!
//! ```text
//! d(ph_Doran - ph) = 2 a r dr / (Delta sqrt(2 r (r^2 + a^2)))      d(T - t) = sqrt(2 r (r^2 + a^2)) dr / Delta
//! ```
//!
//! outside. The azimuths agree at infinity. Without spin T is the time of Painleve 1921 and Gullstrand 1922.

use super::orbit::{horizon_inner, horizon_outer};
use super::quadrature::gauss_legendre;
use glam::DVec2;
use std::f64::consts::PI;

/// The greatest width of a panel of the quadrature in s (`offsets`), which leaves 1e-13 of the integrals.
const PANEL: f64 = 1.0 / 32.0;

/// How far apart the two charts are at a place outside the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offsets {
    /// Doran's azimuth less Boyer and Lindquist's, rad; 0 at infinity.
    pub azimuth: f64,
    /// Doran's time less Boyer and Lindquist's, M: T - t - 2 sqrt(2 r) is 0 at infinity.
    pub time: f64,
}

/// The offsets at 1/r = `u`, 0 < u < 1/r+, for |a| <= 1. They diverge at the horizon; NaN inside.
///
/// With v = sqrt(u), D = 1 - 2 u + a^2 u^2 and q = sqrt(1 + a^2 u^2)
///
/// ```text
/// ph_Doran - ph = -integral 2 sqrt(2) a v^2 / (q D) dv
/// T - t = 2 sqrt(2) / v - 2 sqrt(2) integral (2 - a^2 u + a^2 u / (1 + q)) / D dv
/// ```
///
/// from 0 to v. In s, v = v+ (1 - e^-s), the horizon is at infinity: there the integrands are even, and for a = 1,
/// where D has a double root, they grow as e^s.
pub fn offsets(a: f64, u: f64) -> Offsets {
    let (r_plus, r_minus) = (horizon_outer(a), horizon_inner(a));
    let (v, v_plus) = (u.sqrt(), (1.0 / r_plus).sqrt());
    let (a2, ratio) = (a * a, r_minus / r_plus);
    // r+ - r- without the difference, for the other root of D.
    let apart = 2.0 * ((1.0 - a) * (1.0 + a)).sqrt() / r_plus;
    let rate = |s: f64| {
        let left = (-s).exp();
        let u = (v_plus * (1.0 - left)).powi(2);
        let q = (1.0 + a2 * u * u).sqrt();
        // 1 - r+ u = left (2 - left); `left` goes into dv.
        let scale = v_plus / ((2.0 - left) * (apart + ratio * left * (2.0 - left)));
        DVec2::new(a * u / q, 2.0 - a2 * u + a2 * u / (1.0 + q)) * scale
    };
    let end = -(1.0 - v / v_plus).ln();
    if !(end > 0.0 && end.is_finite()) {
        return Offsets { azimuth: f64::NAN, time: f64::NAN };
    }
    let panels = (end / PANEL).ceil();
    let width = end / panels;
    let mut sum = DVec2::ZERO;
    // At most 37 / PANEL of them: v and v+ are doubles.
    for i in 0..panels as u32 {
        sum += gauss_legendre(|x| rate((f64::from(i) + x) * width)) * width;
    }
    let root = 8.0_f64.sqrt();
    Offsets { azimuth: -root * sum.x, time: root / v - root * sum.y }
}

/// Kerr's azimuth (Kerr 1963), d(ph_Kerr) = d(ph) + a dr / Delta, less Boyer and Lindquist's at 1/r = `u` outside the
/// horizon, for |a| < 1; 0 at infinity. Like Doran's it is regular at both horizons for everything that falls in.
pub fn kerr_offset(a: f64, u: f64) -> f64 {
    let (r_plus, r_minus) = (horizon_outer(a), horizon_inner(a));
    a / (r_plus - r_minus) * ((1.0 - r_plus * u) / (1.0 - r_minus * u)).ln()
}

/// Doran's azimuth less Kerr's at 1/r = `u` >= 0, on either side of the horizons: with w = sqrt(2 u) and
/// q = sqrt(1 + a^2 u^2) the integral of a / (q (q + w)) over u. 0 at infinity.
///
/// Being a function of the radius alone, it leads from Kerr's azimuth, which rays are traced to without roots, to
/// Doran's.
pub fn doran_turn(a: f64, u: f64) -> f64 {
    let v = u.max(0.0).sqrt();
    // In v = sqrt(u), with poles at |v| = 1 / sqrt(|a|).
    let panels = (32.0 * v).ceil().clamp(1.0, 4096.0);
    let width = v / panels;
    let rate = |v: f64| {
        let q = (1.0 + (a * v * v).powi(2)).sqrt();
        2.0 * a * v / (q * (q + 2.0_f64.sqrt() * v))
    };
    (0..panels as u32).map(|i| width * gauss_legendre(|x| rate((f64::from(i) + x) * width))).sum()
}

/// Terms of the polynomials of `OffsetSeries`.
pub const OFFSET_TERMS: usize = 24;

/// The slope of `Offsets::azimuth` by r at the radius `r` outside the horizon.
pub fn azimuth_slope(a: f64, r: f64) -> f64 {
    2.0 * a * r / ((r - horizon_outer(a)) * (r - horizon_inner(a)) * (2.0 * r * (r * r + a * a)).sqrt())
}

/// Largest |a| of `OffsetSeries`: beyond it the poles of D come too near to each other.
pub const MOST_SERIES_SPIN: f64 = 0.9999;

/// `offsets` of a hole of spin |a| <= 0.9999 for frames, which ask for them at many places: with poles of D apart
///
/// ```text
/// 1 / D = (r+ / (1 - r+ u) - r- / (1 - r- u)) / (r+ - r-)
/// ```
///
/// the integrals over v of g / D, g = a u / q and 2 - a^2 u + a^2 u / (1 + q), are
///
/// ```text
/// (sqrt(r+) g(1/r+) artanh(sqrt(r+) v) - sqrt(r-) g(1/r-) artanh(sqrt(r-) v)) / (r+ - r-) + P(v)
/// ```
///
/// where P is smooth up to the horizon: a series of Chebyshev polynomials, one for the azimuth (x) and one for the
/// time (y). The error is 1e-11 up to |a| = 0.9999.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetSeries {
    r_minus: f64,
    /// sqrt(r+), sqrt(r-).
    roots: [f64; 2],
    /// The factors of artanh(sqrt(r+) v) and artanh(sqrt(r-) v).
    pub poles: [DVec2; 2],
    /// The coefficients of P in 2 v / v+ - 1.
    pub terms: [DVec2; OFFSET_TERMS],
}

impl OffsetSeries {
    pub fn new(a: f64) -> Self {
        let (r_plus, r_minus) = (horizon_outer(a), horizon_inner(a));
        let roots = [r_plus.sqrt(), r_minus.sqrt()];
        let (a2, apart) = (a * a, 2.0 * ((1.0 - a) * (1.0 + a)).sqrt());
        let g = |u: f64| {
            let q = (1.0 + a2 * u * u).sqrt();
            DVec2::new(a * u / q, 2.0 - a2 * u + a2 * u / (1.0 + q))
        };
        let at_outer = g(1.0 / r_plus);
        // a / r- = r+ / a.
        let root = a.hypot(r_plus);
        let at_inner = DVec2::new(r_plus.copysign(a) / root, 2.0 - r_plus + r_plus * a.abs() / (a.abs() + root));
        let rest = |u: f64| {
            let value = g(u);
            ((value - at_outer) * (r_plus / (1.0 - r_plus * u)) - (value - at_inner) * (r_minus / (1.0 - r_minus * u)))
                / apart
        };
        let node = |i: usize| (i as f64 + 0.5) * PI / OFFSET_TERMS as f64;
        let at_nodes: [DVec2; OFFSET_TERMS] = std::array::from_fn(|i| {
            let v = 0.5 * (1.0 + node(i).cos()) / roots[0];
            rest(v * v)
        });
        // The interpolant of P' at the Chebyshev nodes, integrated term by term: T_k gives T_(k+1) / (2 k + 2) and
        // -T_(k-1) / (2 k - 2).
        let slopes: [DVec2; OFFSET_TERMS] = std::array::from_fn(|k| {
            let sum = (0..OFFSET_TERMS).fold(DVec2::ZERO, |sum, i| sum + at_nodes[i] * (k as f64 * node(i)).cos());
            sum * (2.0 / OFFSET_TERMS as f64)
        });
        let slope = |k: usize| slopes.get(k).copied().unwrap_or_default();
        let half_width = 0.5 / roots[0];
        let mut terms: [DVec2; OFFSET_TERMS] = std::array::from_fn(|k| match k {
            0 => DVec2::ZERO,
            _ => (slope(k - 1) - slope(k + 1)) * (half_width / (2.0 * k as f64)),
        });
        // P(0) = 0, where T_k is 1 and -1 in turns.
        terms[0] =
            (1..OFFSET_TERMS).fold(DVec2::ZERO, |sum, k| if k % 2 == 0 { sum - terms[k] } else { sum + terms[k] });
        Self { r_minus, roots, poles: [at_outer * (roots[0] / apart), at_inner * (-roots[1] / apart)], terms }
    }

    /// The offsets at 1/r = `u`. `outer`: 1 - r+ u > 0, which callers beside the horizon know better than `u` tells.
    pub fn at(&self, u: f64, outer: f64) -> Offsets {
        let v = u.sqrt();
        let [outer_root, inner_root] = self.roots;
        // artanh(x) = ln((1 + x)^2 / (1 - x^2)) / 2.
        let artanh = |root: f64, rest: f64| 0.5 * ((1.0 + root * v).powi(2) / rest).ln();
        let logs =
            self.poles[0] * artanh(outer_root, outer) + self.poles[1] * artanh(inner_root, 1.0 - self.r_minus * u);
        // Clenshaw 1955.
        let x = 2.0 * v * outer_root - 1.0;
        let (mut next, mut after) = (DVec2::ZERO, DVec2::ZERO);
        for term in self.terms.iter().skip(1).rev() {
            (next, after) = (*term + next * (2.0 * x) - after, next);
        }
        let sum = logs + self.terms[0] + next * x - after;
        let root = 8.0_f64.sqrt();
        Offsets { azimuth: -root * sum.x, time: root / v - root * sum.y }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_the_integrals() {
        let mut worst: f64 = 0.0;
        for a in [0.0, 1e-9, 0.1, -0.5, 0.9, -0.998, 0.9999, -0.9999_f64] {
            let (series, r_plus) = (OffsetSeries::new(a), horizon_outer(a));
            for r in [1.0 + 1e-9, 1.0001, 1.01, 1.3, 2.0, 4.0, 30.0, 1e4, 1e9].map(|x| x * r_plus) {
                let (found, expected) = (series.at(1.0 / r, (r - r_plus) / r), offsets(a, 1.0 / r));
                let size = expected.azimuth.abs() + 1.0;
                let error = ((found.azimuth - expected.azimuth) / size).abs();
                let late = ((found.time - expected.time) / expected.time.abs().max(1.0)).abs();
                worst = worst.max(error.max(late) / (1.0 + 1e-5 * r_plus / (r - r_plus)));
            }
        }
        println!("series of offsets: {worst:.1e}");
        assert!(worst < 1e-11, "{worst:.1e}");
    }

    /// Without spin H has a closed form (`geodesic::rain_offset`, here by Martel & Poisson 2001, eq. 2.5).
    #[test]
    fn time_without_spin_is_painleves() {
        for r in [2.0 + 1e-9, 2.001, 2.5, 7.0, 100.0, 1e6_f64] {
            let (root, two) = (r.sqrt(), 2.0_f64.sqrt());
            let expected = 2.0 * two * root + 2.0 * ((root - two) / (root + two)).ln();
            let found = offsets(0.0, 1.0 / r);
            let error = (found.time - expected).abs() / expected.abs().max(1.0);
            // Beside the horizon 1 / r tells r - 2 to 2e-16.
            assert!(error < 1e-12 + 2e-16 / (r - 2.0) && found.azimuth == 0.0, "{r}: {found:?} {expected}");
        }
    }

    /// The slopes by r are the ones of the definition, at every spin.
    #[test]
    fn slopes_are_dorans() {
        for a in [-1.0, -0.7, 0.2, 0.9, 0.9999, 1.0_f64] {
            let r_plus = horizon_outer(a);
            for r in [1.001 * r_plus, 1.1 * r_plus, 3.0, 12.0, 400.0] {
                let h = 1e-3 * (r - r_plus);
                let difference = |pick: fn(Offsets) -> f64| {
                    let at = |k: f64| pick(offsets(a, 1.0 / (r + k * h)));
                    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
                };
                let delta = (r - r_plus) * (r - horizon_inner(a));
                let root = (2.0 * r * (r * r + a * a)).sqrt();
                let (turn, time) = (2.0 * a * r / (delta * root), root / delta);
                let (found_turn, found_time) = (difference(|o| o.azimuth), difference(|o| o.time));
                assert!((found_turn - turn).abs() < 1e-8 * turn.abs().max(1e-3), "{a} {r}: {found_turn} {turn}");
                assert!((found_time / time - 1.0).abs() < 1e-8, "{a} {r}: {found_time} {time}");
            }
        }
    }

    /// From Boyer and Lindquist's azimuth to Doran's, at once and by way of Kerr's; inside too its slope is that of
    /// `doran_turn`.
    #[test]
    fn kerrs_azimuth_lies_between() {
        for a in [-0.9999, -0.5, 1e-3, 0.3, 0.9, 0.998_f64] {
            let r_plus = horizon_outer(a);
            for r in [1.001 * r_plus, 1.5 * r_plus, 3.0, 30.0, 1e6] {
                let (direct, by_kerr) = (offsets(a, 1.0 / r).azimuth, kerr_offset(a, 1.0 / r) + doran_turn(a, 1.0 / r));
                let size = 1.0 + kerr_offset(a, 1.0 / r).abs() / (1.0 - a.abs());
                assert!((direct - by_kerr).abs() < 1e-12 * size, "{a} {r}: {direct} {by_kerr}");
            }
            // Without spin the inner horizon is too far in for differences.
            for u in [1.0 / r_plus, (0.9 / horizon_inner(a)).min(30.0)] {
                let (h, q) = (1e-3 * u, 1.0_f64.hypot(a * u));
                let at = |k: f64| doran_turn(a, u + k * h);
                let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
                let expected = a / (q * (q + (2.0 * u).sqrt()));
                assert!((slope / expected - 1.0).abs() < 1e-7, "{a} {u}: {slope} {expected}");
            }
        }
    }

    #[test]
    fn azimuths_agree_at_infinity_and_inside_there_are_none() {
        let far = offsets(0.9, 1e-9);
        assert!(far.azimuth < 0.0 && far.azimuth > -1e-12 && (far.time - 8e9_f64.sqrt()).abs() < 1e-3, "{far:?}");
        assert!(offsets(0.9, 1.0).azimuth.is_nan() && offsets(0.9, 1.0 / horizon_outer(0.9)).time.is_nan());
    }
}
