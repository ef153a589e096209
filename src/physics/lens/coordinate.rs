// SPDX-License-Identifier: MIT OR Apache-2.0
//! The axis of a lens table: distance of a ray from the critical direction, on a logarithmic scale. Plain trigonometry
//! of one angle; knows nothing of metrics.
//!
//! psi is a ray's angle from a centre inside the shadow, psi_c its critical value, t = tan((psi - psi_c) / 2). The
//! swept angle grows as -ln|t| towards t = 0 and is smooth elsewhere, so nodes at even steps of log2|t| suit it.
//! Everything is computed from sines and cosines, without acos and without a difference of angles: exact in f32,
//! however near the shadow's edge.

use std::f64::consts::LN_2;

/// The name of the tables in errors of memory.
pub const LENS: &str = "the tables of a lens";

/// log2 of the smallest |t_hat| that is told from 0.
pub const LEAST_OCTAVE: f64 = -24.0;
/// That |t_hat|.
pub const LEAST_T_HAT: f64 = 1.0 / 16_777_216.0;

/// The axis about one critical angle.
#[derive(Clone, Copy, Debug)]
pub struct Coordinate {
    pub sin_critical: f64,
    pub cos_critical: f64,
    /// tan(psi_c / 2).
    pub tan_half: f64,
    /// t = scale t_hat with scale = min(tan(psi_c / 2), cot(psi_c / 2)): the nearer pole of the sphere is at |t_hat| =
    /// 1.
    pub scale: f64,
    pub nodes_per_octave: f64,
}

/// A direction by its place on the axis.
#[derive(Clone, Copy, Debug)]
pub struct Angle {
    /// tan(d / 2), d = psi - psi_c.
    pub tan_half: f64,
    pub sin_half: f64,
    pub cos_half: f64,
    /// Sine and cosine of psi; past a pole of the sphere the sine is negative.
    pub sin: f64,
    pub cos: f64,
    /// cos((psi + psi_c) / 2).
    pub cos_mean: f64,
}

impl Coordinate {
    pub fn new(sin_critical: f64, cos_critical: f64, nodes_per_octave: u32) -> Self {
        let tan_half = half_tangent(sin_critical, cos_critical);
        Self {
            sin_critical,
            cos_critical,
            tan_half,
            scale: tan_half.min(1.0 / tan_half),
            nodes_per_octave: f64::from(nodes_per_octave),
        }
    }

    /// t_hat of a direction: > 0 outside the shadow. `sin` >= 0.
    ///
    /// tan((psi - psi_c) / 2) by the addition theorem, with tan(psi / 2) = s / (1 + c).
    pub fn t_hat(&self, sin: f64, cos: f64) -> f64 {
        let one_plus_cos = if cos < 0.0 { sin * sin / (1.0 - cos) } else { 1.0 + cos };
        let above = sin - self.tan_half * one_plus_cos;
        let below = one_plus_cos + self.tan_half * sin;
        // Straight away from the centre both vanish: the limit is cot(psi_c / 2).
        if below > 0.0 { above / below / self.scale } else { 1.0 / (self.tan_half * self.scale) }
    }

    /// Node coordinate of |t_hat|; 0 at the smallest one.
    pub fn x(&self, t_hat: f64) -> f64 {
        self.nodes_per_octave * (t_hat.abs().log2() - LEAST_OCTAVE).max(0.0)
    }

    /// |t_hat| of a node coordinate.
    pub fn t_hat_at(&self, x: f64) -> f64 {
        (x / self.nodes_per_octave + LEAST_OCTAVE).exp2()
    }

    /// The direction of `t_hat`, which may lie past a pole of the sphere.
    pub fn angle(&self, t_hat: f64) -> Angle {
        let t = t_hat * self.scale;
        let cos_half = 1.0 / t.hypot(1.0);
        let sin_half = t * cos_half;
        let (sin_d, cos_d) = (2.0 * sin_half * cos_half, (cos_half - sin_half) * (cos_half + sin_half));
        let (sin_c, cos_c) = (self.sin_critical, self.cos_critical);
        Angle {
            tan_half: t,
            sin_half,
            cos_half,
            sin: sin_c * cos_d + cos_c * sin_d,
            cos: cos_c * cos_d - sin_c * sin_d,
            cos_mean: cos_c * cos_half - sin_c * sin_half,
        }
    }

    /// d psi / dx at t = tan((psi - psi_c) / 2): dt/dx = t ln 2 / nodes per octave, d psi / dt = 2 / (1 + t^2).
    pub fn psi_slope(&self, t: f64) -> f64 {
        2.0 * t / (1.0 + t * t) * (LN_2 / self.nodes_per_octave)
    }

    /// dx / d psi at the same t.
    pub fn x_slope(&self, t: f64) -> f64 {
        (1.0 + t * t) / (2.0 * t) * (self.nodes_per_octave / LN_2)
    }

    /// Nodes from x = 0 to the second one past the pole psi = pi (`outer`) or psi = 0, so that four nodes surround
    /// every x.
    pub fn nodes(&self, outer: bool) -> usize {
        let pole = if outer { 1.0 / self.tan_half } else { self.tan_half };
        self.x(pole / self.scale) as usize + 3
    }
}

/// tan(angle / 2) for an angle in [0, pi].
fn half_tangent(sin: f64, cos: f64) -> f64 {
    if cos < 0.0 { (1.0 - cos) / sin } else { sin / (1.0 + cos) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_and_directions_agree() {
        for critical in [1e-5_f64, 0.3, 1.5, 3.0] {
            let axis = Coordinate::new(critical.sin(), critical.cos(), 32);
            for part in [0.01, 0.3, 0.999, 1.001, 1.5] {
                let psi = critical * part;
                if psi >= std::f64::consts::PI {
                    continue;
                }
                let t_hat = axis.t_hat(psi.sin(), psi.cos());
                let expected = ((psi - critical) / 2.0).tan() / axis.scale;
                assert!((t_hat / expected - 1.0).abs() < 1e-12, "{critical} {part}: {t_hat} {expected}");
                let angle = axis.angle(t_hat);
                assert!((angle.sin - psi.sin()).abs() < 1e-15 && (angle.cos - psi.cos()).abs() < 1e-15);
                assert!((angle.cos_mean - ((psi + critical) / 2.0).cos()).abs() < 1e-15);
                assert!((axis.t_hat_at(axis.x(t_hat)) / t_hat.abs() - 1.0).abs() < 1e-13);
                assert!((axis.x_slope(angle.tan_half) * axis.psi_slope(angle.tan_half) - 1.0).abs() < 1e-14);
                let ahead = axis.angle(t_hat.signum() * axis.t_hat_at(axis.x(t_hat) + 1e-4));
                let turned = (ahead.sin * angle.cos - ahead.cos * angle.sin) / 1e-4;
                assert!((turned / axis.psi_slope(angle.tan_half) - 1.0).abs() < 1e-5, "{critical} {part}");
            }
        }
    }

    #[test]
    fn nodes_pass_both_poles() {
        for critical in [1e-5_f64, 0.3, 1.5, 3.0] {
            let axis = Coordinate::new(critical.sin(), critical.cos(), 16);
            for (outer, sign) in [(true, 1.0), (false, -1.0)] {
                let sine_at = |i: usize| axis.angle(sign * axis.t_hat_at(i as f64)).sin;
                let last = axis.nodes(outer) - 1;
                assert!(sine_at(last) < 0.0 && sine_at(last - 1) < 0.0 && sine_at(last - 2) >= -1e-15, "{critical}");
            }
        }
    }

    #[test]
    fn straight_away_is_the_pole() {
        let axis = Coordinate::new(0.3, (1.0_f64 - 0.09).sqrt(), 32);
        assert!((axis.angle(axis.t_hat(0.0, -1.0)).sin).abs() < 1e-15);
        assert!((axis.angle(axis.t_hat(0.0, 1.0)).sin).abs() < 1e-15);
    }
}
