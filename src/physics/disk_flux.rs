// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flux of a geometrically thin, optically thick disk on circular geodesics (Page & Thorne 1974), and the
//! temperature profile that the tracers look up. Knows orbits only.

use super::orbit::isco;

/// f(r) of F = (3 Mdot / 8 pi M^2) f, per face, matter towards +ph; 0 at and inside the ISCO. (Page & Thorne 1974, eq.
/// 15n.) The sqrt(3)/3 of some reprints of the spin-0 form is wrong; it is sqrt(3)/2, the a = 0 value of this.
pub fn page_thorne(a: f64, r: f64) -> f64 {
    let (x, x0) = (r.sqrt(), isco(a).sqrt());
    if x <= x0 || x.is_nan() {
        return 0.0;
    }
    let t = a.acos() / 3.0;
    let third = std::f64::consts::FRAC_PI_3;
    // Roots of x^3 - 3 x + 2 a.
    let roots = [2.0 * (t - third).cos(), 2.0 * (t + third).cos(), -2.0 * t.cos()];
    let mut sum = x - x0 - 1.5 * a * (x / x0).ln();
    for i in 0..3 {
        let (xi, xj, xk) = (roots[i], roots[(i + 1) % 3], roots[(i + 2) % 3]);
        // At a = 0 the middle root is 0 and its term has the limit 0.
        if i == 1 && a == 0.0 {
            continue;
        }
        let weight = 3.0 * (xi - a).powi(2) / (xi * (xi - xj) * (xi - xk));
        sum -= weight * ((x - x0) / (x0 - xi)).ln_1p();
    }
    sum / (x.powi(4) * (x.powi(3) - 3.0 * x + 2.0 * a))
}

/// The radius of the profile's maximum and f there: golden-section search; the profile has one maximum.
pub fn page_thorne_maximum(a: f64) -> (f64, f64) {
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (isco(a), 4.0 * isco(a));
    for _ in 0..80 {
        let (x1, x2) = (high - ratio * (high - low), low + ratio * (high - low));
        if page_thorne(a, x1) < page_thorne(a, x2) { low = x1 } else { high = x2 }
    }
    let r = 0.5 * (low + high);
    (r, page_thorne(a, r))
}

/// The flux of plunging matter, in the maximum of the Page-Thorne flux: inside the hottest ring the flux falls to this
/// and stays there, through the ISCO to the horizon.
///
/// The value is a choice, not a solution. The Page-Thorne flux is 0 at the ISCO because no stress may act there; with
/// some stress matter shines there, too (Agol & Krolik 2000, ApJ 528, 161). Matter that falls with the heat it has
/// cools down to half the ISCO's radius and heats up again farther in (Mummery & Balbus 2023, MNRAS 521, 2439), which a
/// flux that stays the same sums up.
pub const PLUNGE_FLUX: f64 = 0.5;

/// T(r) / T_max = (f / f_max)^(1/4), tabulated in f64: near the ISCO f32 could not evaluate f.
///
/// Entry i holds T / T_max (r / r_isco)^(3/4) at x = i / (N - 1), x^2 = 1 - sqrt(r_isco / r): smooth from the ISCO,
/// where T starts linearly in x, to infinity, where T falls as r^(-3/4) times a series in 1 / sqrt(r).
#[derive(Clone, Debug)]
pub struct TemperatureProfile {
    pub isco: f64,
    entries: Vec<f64>,
}

impl TemperatureProfile {
    pub const SIZE: usize = 2048;

    /// `a` as the matter meets it: the hole's spin for prograde, its negative for retrograde matter.
    pub fn new(a: f64) -> Self {
        let isco = isco(a);
        let f_max = page_thorne_maximum(a).1;
        let last = (Self::SIZE - 1) as f64;
        let entry = |i: usize| {
            let x = i as f64 / last;
            let root = 1.0 - x * x;
            // A large radius stands for infinity, where x^4 would overflow nothing yet.
            let r = (isco / (root * root)).min(1e30);
            (page_thorne(a, r) / f_max).max(0.0).powf(0.25) * (r / isco).powf(0.75)
        };
        Self { isco, entries: (0..Self::SIZE).map(entry).collect() }
    }

    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// T / T_max at `r` (linear interpolation: 3e-6 relative, below T_max / 10 of that); 0 at and inside the ISCO.
    pub fn at(&self, r: f64) -> f64 {
        if r <= self.isco {
            return 0.0;
        }
        let root = (self.isco / r).sqrt();
        let x = (1.0 - root).sqrt() * (Self::SIZE - 1) as f64;
        let i = (x as usize).min(Self::SIZE - 2);
        let (y0, y1) = (self.entries[i], self.entries[i + 1]);
        (y0 + (y1 - y0) * (x - i as f64)) * root * root.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of docs/numerics.md: a, r_max, f_max, checked against the defining integral to 2e-28.
    #[test]
    fn maximum_for_seven_spins() {
        let table = [
            (-0.9, 14.08021828, 3.490434547e-5),
            (0.0, 9.55092808, 1.145894732e-4),
            (0.5, 6.61508761, 3.57262661e-4),
            (0.9, 3.441843362, 2.841915083e-3),
            (0.998, 1.581184581, 4.005816024e-2),
            (0.999, 1.47443429, 5.161236615e-2),
            (0.9999, 1.255567719, 9.352581436e-2),
        ];
        for (a, r, f) in table {
            let (r_max, f_max) = page_thorne_maximum(a);
            assert!((r_max / r - 1.0).abs() < 1e-7, "a {a}: r_max {r_max}");
            assert!((f_max / f - 1.0).abs() < 1e-9, "a {a}: f_max {f_max}");
        }
    }

    #[test]
    fn profile_interpolates_the_formula() {
        for a in [-0.998, 0.0, 0.9, 0.998, 0.9999] {
            let profile = TemperatureProfile::new(a);
            let f_max = page_thorne_maximum(a).1;
            for i in 1..400 {
                let r = isco(a) * (1.0 + 1e-3 * f64::from(i * i) / 4.0);
                let exact = (page_thorne(a, r) / f_max).powf(0.25);
                assert!(
                    (profile.at(r) - exact).abs() < 3e-6 * exact.max(0.1),
                    "a {a} r {r}: {} {exact}",
                    profile.at(r)
                );
            }
        }
        assert_eq!(TemperatureProfile::new(0.5).at(1.0), 0.0);
    }
}
