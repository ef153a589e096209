// SPDX-License-Identifier: MIT OR Apache-2.0
//! The Kerr metric in Boyer-Lindquist coordinates (t, r, th, ph), signature - + + +, its inverse, its Christoffel
//! symbols, and the conversion between Boyer-Lindquist and chart coordinates. Knows nothing of geodesics.
//!
//! Kerr 1963; Boyer & Lindquist 1967; Bardeen, Press & Teukolsky 1972, eq. 2.1 - 2.4. Schwarzschild is a = 0.

use super::orbit::{horizon_inner, horizon_outer};
use glam::DVec3;

/// A 4 x 4 tensor, `[row][column] = [a][b]`.
pub type Tensor2 = [[f64; 4]; 4];
/// Gamma^a_bc as `[a][b][c]`.
pub type Tensor3 = [[[f64; 4]; 4]; 4];

/// The spacetime of a hole of unit mass and spin `a`.
#[derive(Clone, Copy, Debug)]
pub struct Kerr {
    pub a: f64,
}

/// The functions of (r, th) that all components are made of. `sin`, `cos` are of th.
struct Parts {
    sin: f64,
    cos: f64,
    /// Sigma = r^2 + a^2 cos^2 th.
    sigma: f64,
    /// Delta = r^2 - 2 r + a^2 = (r - r+)(r - r-).
    delta: f64,
    /// A = (r^2 + a^2)^2 - Delta a^2 sin^2 th.
    big_a: f64,
}

impl Kerr {
    fn parts(&self, r: f64, theta: f64) -> Parts {
        let (sin, cos) = theta.sin_cos();
        let a2 = self.a * self.a;
        let delta = (r - horizon_outer(self.a)) * (r - horizon_inner(self.a));
        let sum = r * r + a2;
        Parts { sin, cos, sigma: r * r + a2 * cos * cos, delta, big_a: sum * sum - delta * a2 * sin * sin }
    }

    /// g_ab. Infinite g_rr on the horizon.
    pub fn metric(&self, r: f64, theta: f64) -> Tensor2 {
        let p = self.parts(r, theta);
        let s2 = p.sin * p.sin;
        let drag = -2.0 * self.a * r * s2 / p.sigma;
        [
            [-(1.0 - 2.0 * r / p.sigma), 0.0, 0.0, drag],
            [0.0, p.sigma / p.delta, 0.0, 0.0],
            [0.0, 0.0, p.sigma, 0.0],
            [drag, 0.0, 0.0, p.big_a * s2 / p.sigma],
        ]
    }

    /// Gamma^a_bc in closed form (Mueller & Grave 2010, Catalogue of Spacetimes, Kerr in Boyer-Lindquist coordinates;
    /// checked against derivatives of `metric`). Infinite on the horizon and on the axis.
    pub fn christoffel(&self, r: f64, theta: f64) -> Tensor3 {
        let p = self.parts(r, theta);
        let (a, a2, r2) = (self.a, self.a * self.a, r * r);
        let (s, c, s2, c2) = (p.sin, p.cos, p.sin * p.sin, p.cos * p.cos);
        let (sg, sg2, sg3, d) = (p.sigma, p.sigma * p.sigma, p.sigma.powi(3), p.delta);
        let near = r2 - a2 * c2;
        let sum = r2 + a2;
        let (t, rr, th, ph) = (0, 1, 2, 3);
        let mut gamma = [[[0.0; 4]; 4]; 4];
        let mut set = |up: usize, b: usize, c: usize, value: f64| {
            gamma[up][b][c] = value;
            gamma[up][c][b] = value;
        };
        set(t, t, rr, sum * near / (sg2 * d));
        set(t, t, th, -2.0 * a2 * r * s * c / sg2);
        set(t, rr, ph, a * s2 * (a2 * c2 * (a2 - r2) - r2 * (a2 + 3.0 * r2)) / (sg2 * d));
        set(t, th, ph, 2.0 * a2 * a * r * s2 * s * c / sg2);
        set(rr, t, t, d * near / sg3);
        set(rr, t, ph, -d * a * s2 * near / sg3);
        set(rr, rr, rr, (r * a2 * s2 - near) / (sg * d));
        set(rr, rr, th, -a2 * s * c / sg);
        set(rr, th, th, -r * d / sg);
        set(rr, ph, ph, d * s2 * (a2 * s2 * near - r * sg2) / sg3);
        set(th, t, t, -2.0 * a2 * r * s * c / sg3);
        set(th, t, ph, 2.0 * a * r * sum * s * c / sg3);
        set(th, rr, rr, a2 * s * c / (sg * d));
        set(th, rr, th, r / sg);
        set(th, th, th, -a2 * s * c / sg);
        set(th, ph, ph, -s * c * (p.big_a * sg + 2.0 * sum * a2 * r * s2) / sg3);
        set(ph, t, rr, a * near / (sg2 * d));
        set(ph, t, th, -2.0 * a * r * c / (s * sg2));
        set(ph, rr, ph, (r * sg2 + a2 * a2 * s2 * c2 - r2 * (sg + sum)) / (sg2 * d));
        set(ph, th, ph, c / s * (1.0 + 2.0 * a2 * r * s2 / sg2));
        gamma
    }
}

/// (r, th, ph) of a chart position; ph in (-pi, pi], 0 on the axis.
pub fn boyer_lindquist(position: DVec3) -> (f64, f64, f64) {
    let rho = position.x.hypot(position.y);
    let azimuth = if rho == 0.0 { 0.0 } else { position.y.atan2(position.x) };
    (rho.hypot(position.z), rho.atan2(position.z), azimuth)
}

/// The chart position of (r, th, ph); for tests.
#[cfg(test)]
pub fn chart(r: f64, theta: f64, phi: f64) -> DVec3 {
    let (s, c) = theta.sin_cos();
    DVec3::new(r * s * phi.cos(), r * s * phi.sin(), r * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Kerr {
        /// g^ab. Infinite on the horizon and, in g^phph, on the axis.
        pub fn inverse(&self, r: f64, theta: f64) -> Tensor2 {
            let p = self.parts(r, theta);
            let sd = p.sigma * p.delta;
            let drag = -2.0 * self.a * r / sd;
            let s2 = p.sin * p.sin;
            [
                [-p.big_a / sd, 0.0, 0.0, drag],
                [0.0, p.delta / p.sigma, 0.0, 0.0],
                [0.0, 0.0, 1.0 / p.sigma, 0.0],
                [drag, 0.0, 0.0, (p.delta - self.a * self.a * s2) / (sd * s2)],
            ]
        }
    }

    const PLACES: [(f64, f64, f64); 5] =
        [(0.0, 3.0, 1.0), (0.5, 2.5, 0.4), (0.9, 10.0, 2.5), (-0.998, 1.5, 1.5), (0.7, 0.9, 0.8)];

    #[test]
    fn inverse_times_metric_is_one() {
        for (a, r, theta) in PLACES {
            let k = Kerr { a };
            let (g, inv) = (k.metric(r, theta), k.inverse(r, theta));
            for (i, row) in g.iter().enumerate() {
                for j in 0..4 {
                    let sum: f64 = row.iter().zip(&inv).map(|(g, inv)| g * inv[j]).sum();
                    assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-12, "a {a} r {r}: [{i}][{j}] = {sum}");
                }
            }
        }
    }

    #[test]
    fn schwarzschild_is_the_textbook_one() {
        let (r, theta) = (7.0_f64, 1.1_f64);
        let g = Kerr { a: 0.0 }.metric(r, theta);
        let f = 1.0 - 2.0 / r;
        let diagonal = [-f, 1.0 / f, r * r, (r * theta.sin()).powi(2)];
        for (i, d) in diagonal.iter().enumerate() {
            assert!((g[i][i] / d - 1.0).abs() < 1e-14);
        }
    }

    /// Gamma^a_bc = g^ad (d_b g_dc + d_c g_db - d_d g_bc) / 2 with central differences of fourth order.
    #[test]
    fn christoffel_agrees_with_derivatives_of_the_metric() {
        for (a, r, theta) in PLACES {
            let k = Kerr { a };
            let h = 1e-3;
            let slope = |f: &dyn Fn(f64) -> Tensor2| -> Tensor2 {
                let (p1, m1, p2, m2) = (f(h), f(-h), f(2.0 * h), f(-2.0 * h));
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| (8.0 * (p1[i][j] - m1[i][j]) - (p2[i][j] - m2[i][j])) / (12.0 * h))
                })
            };
            let zero = [[0.0; 4]; 4];
            let dg = [zero, slope(&|e| k.metric(r + e, theta)), slope(&|e| k.metric(r, theta + e)), zero];
            let inv = k.inverse(r, theta);
            let gamma = k.christoffel(r, theta);
            for up in 0..4 {
                for b in 0..4 {
                    for c in 0..4 {
                        let expect: f64 =
                            (0..4).map(|d| 0.5 * inv[up][d] * (dg[b][d][c] + dg[c][d][b] - dg[d][b][c])).sum();
                        let got = gamma[up][b][c];
                        let scale = 1.0 + expect.abs();
                        assert!((got - expect).abs() < 2e-7 * scale, "a {a} [{up}][{b}][{c}]: {got} against {expect}");
                    }
                }
            }
        }
    }

    #[test]
    fn conversions_are_inverse_and_axis_has_azimuth_zero() {
        let p = DVec3::new(-3.0, 4.0, -2.0);
        let (r, th, ph) = boyer_lindquist(p);
        assert!((chart(r, th, ph) - p).length() < 1e-14);
        assert_eq!(boyer_lindquist(DVec3::new(0.0, 0.0, -5.0)), (5.0, std::f64::consts::PI, 0.0));
    }
}
