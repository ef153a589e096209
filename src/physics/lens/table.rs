// SPDX-License-Identifier: MIT OR Apache-2.0
//! The lens table of one observer at spin 0, and looking directions up in it: what becomes of a ray and where it is
//! after a swept angle. Knows the rays' family, not how they are integrated; works in the ray's own plane (`plane`
//! leads to the chart).
//!
//! Interpolation: the swept angle cubic Hermite in x; v (`schwarzschild`) bicubic Hermite in (x, y); the delay's
//! integral part cubic Hermite in y and Lagrange with four nodes in x.

use super::coordinate::{LEAST_T_HAT, LENS};
use super::schwarzschild::{Branch, Column, Family};
use crate::allocate::with_room;
use crate::error::Result;
use glam::{DVec3, Vec3Swizzles};

/// The tables of one branch, rays one after the other.
#[derive(Clone, Debug, Default)]
struct BranchTable {
    swept: Vec<[f64; 2]>,
    v: Vec<[f64; 4]>,
    delay: Vec<[f64; 2]>,
}

/// The lens table of one observer. Depends on the observer's radius and frame kind only.
#[derive(Clone, Debug)]
pub struct SchwarzschildLens {
    family: Family,
    escaping: BranchTable,
    captured: BranchTable,
}

/// A direction looked up.
#[derive(Clone, Copy, Debug)]
pub struct SchwarzschildLookup<'a> {
    family: &'a Family,
    table: &'a BranchTable,
    /// Column of the node below, and the fraction to the next one.
    column: usize,
    fraction: f64,
    /// The first and last column of those with the same meaning of v.
    alike: [usize; 2],
    /// dx / d psi.
    x_slope: f64,
    pub escaped: bool,
    /// Place on the table's axis (`Coordinate::t_hat`): > 0 escapes.
    pub t_hat: f64,
    /// Sine and cosine of psi, the angle from the inward radius.
    pub sin: f64,
    pub cos: f64,
    /// Impact parameter, M.
    pub b: f64,
    /// Angle swept to the ray's end (u = 0, or `CAPTURE_U`), and its derivative by psi; 0 where captured rays are of
    /// no use.
    pub swept: f64,
    pub swept_slope: f64,
}

/// A point of a ray, `phi` from the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub phi: f64,
    pub u: f64,
    /// du/dpsi at fixed phi.
    pub u_psi: f64,
    /// du/dphi along the ray.
    pub u_phi: f64,
}

/// Cubic Hermite interpolation on [0, 1]: value and slope from those at both ends.
fn hermite(y0: f64, d0: f64, y1: f64, d1: f64, x: f64) -> (f64, f64) {
    let rise = y1 - y0;
    let (c2, c3) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
    (y0 + x * (d0 + x * (c2 + x * c3)), d0 + x * (2.0 * c2 + 3.0 * x * c3))
}

/// Lagrange's cubic through the values at -1, 0, 1, 2, at `x`.
pub(crate) fn lagrange(values: [f64; 4], x: f64) -> f64 {
    let (a, b, c) = (x + 1.0, x - 1.0, x - 2.0);
    let weights = [-x * b * c / 6.0, a * b * c / 2.0, -a * x * c / 2.0, a * x * b / 6.0];
    (0..4).map(|i| weights[i] * values[i]).sum()
}

impl BranchTable {
    /// `None`: columns of other lengths than `family` makes. Errors: OUT_OF_MEMORY.
    fn new(family: &Family, branch: Branch, columns: Vec<Column>) -> Result<Option<Self>> {
        let length = family.resolution.intervals as usize + 1;
        let delays = if family.with_delay { length } else { 0 };
        let fit = columns.iter().all(|c| c.v.len() == length && c.delay.len() == delays);
        if columns.len() != family.columns(branch) || !fit {
            return Ok(None);
        }
        let count = columns.len();
        let mut table = Self {
            swept: with_room(count, LENS)?,
            v: with_room(count * length, LENS)?,
            delay: with_room(count * delays, LENS)?,
        };
        for mut column in columns {
            table.swept.push(column.swept);
            table.v.append(&mut column.v);
            table.delay.append(&mut column.delay);
        }
        Ok(Some(table))
    }
}

impl SchwarzschildLens {
    /// The table from all of `Family::column`, in order. `None`: their number or lengths are not the family's. Errors:
    /// OUT_OF_MEMORY.
    pub fn from_columns(family: Family, escaping: Vec<Column>, captured: Vec<Column>) -> Result<Option<Self>> {
        let escaping = BranchTable::new(&family, Branch::Escaping, escaping)?;
        let captured = BranchTable::new(&family, Branch::Captured, captured)?;
        Ok(escaping.zip(captured).map(|(escaping, captured)| Self { family, escaping, captured }))
    }

    pub fn family(&self) -> &Family {
        &self.family
    }

    /// Looks up the direction `n` (components, unit).
    #[inline]
    pub fn look_up(&self, n: DVec3) -> SchwarzschildLookup<'_> {
        let (sin, cos) = (n.yz().length(), -n.x);
        let coordinate = &self.family.coordinate;
        let t_hat = coordinate.t_hat(sin, cos);
        let escaped = t_hat > 0.0;
        let table = if escaped { &self.escaping } else { &self.captured };
        let mut lookup = SchwarzschildLookup {
            family: &self.family,
            table,
            column: 0,
            fraction: 0.0,
            alike: [0, 0],
            x_slope: 0.0,
            escaped,
            t_hat,
            sin,
            cos,
            b: self.family.impact_parameter(sin, cos),
            swept: 0.0,
            swept_slope: 0.0,
        };
        if !table.swept.is_empty() {
            lookup.locate();
        }
        lookup
    }
}

impl SchwarzschildLookup<'_> {
    /// sin psi_c.
    pub fn sin_critical(&self) -> f64 {
        self.family.coordinate.sin_critical
    }

    /// d ln |t| / d psi, t = tan((psi - psi_c) / 2): 1 over the angle from the critical curve, nearly. Beyond 90
    /// degrees from it 1, as its antipode is not near it.
    pub fn curve_slope(&self) -> f64 {
        let t = (self.t_hat * self.family.coordinate.scale).clamp(-1.0, 1.0);
        (1.0 + t * t) / (2.0 * t)
    }

    #[inline]
    fn locate(&mut self) {
        let coordinate = &self.family.coordinate;
        let x = coordinate.x(self.t_hat);
        let branch = if self.escaped { Branch::Escaping } else { Branch::Captured };
        let (free, last) = (self.family.first_free_column(branch), self.table.swept.len() - 1);
        let is_free = x as usize + 1 >= free;
        // The ray at the seam has two columns.
        let shift = usize::from(is_free);
        self.alike = if is_free { [free, last] } else { [0, last.min(free - 1)] };
        self.column = (x as usize + shift).min(last - 1);
        self.fraction = x - (self.column - shift) as f64;
        // At the least |t_hat| where there is less.
        let t = (self.t_hat.abs().max(LEAST_T_HAT) * coordinate.scale).copysign(self.t_hat);
        self.x_slope = coordinate.x_slope(t);
        let [[y0, d0], [y1, d1]] = [0, 1].map(|i| self.table.swept[self.column + i]);
        let (swept, slope) = hermite(y0, d0, y1, d1, self.fraction);
        self.swept = swept;
        self.swept_slope = slope * self.x_slope;
    }

    /// Interval of `y` = phi / swept, and the fraction in it.
    fn interval(&self, y: f64) -> (usize, f64) {
        let intervals = self.family.resolution.intervals;
        let y = y * f64::from(intervals);
        let interval = (y as usize).min(intervals as usize - 1);
        (interval, y - interval as f64)
    }

    /// Where the ray is after the angle `phi` >= 0. `None`: it has ended before.
    #[inline]
    pub fn crossing(&self, phi: f64) -> Option<Crossing> {
        if !(phi >= 0.0 && phi < self.swept) {
            return None;
        }
        let intervals = f64::from(self.family.resolution.intervals);
        let per_swept = 1.0 / self.swept;
        let part = phi * per_swept;
        let (interval, y) = self.interval(part);
        let length = self.family.resolution.intervals as usize + 1;
        let h = 1.0 / intervals;
        // Along the rays on either side: v and v_x, and their slopes by y.
        let sides = [0, 1].map(|i| {
            let at = (self.column + i) * length + interval;
            let [p, q] = [self.table.v[at], self.table.v[at + 1]];
            let (v, v_y) = hermite(p[0], h * p[2], q[0], h * q[2], y);
            let (v_x, v_xy) = hermite(p[1], h * p[3], q[1], h * q[3], y);
            [v, v_x, v_y * intervals, v_xy * intervals]
        });
        let [p, q] = sides;
        let (v, v_x) = hermite(p[0], p[1], q[0], q[1], self.fraction);
        let (v_y, _) = hermite(p[2], p[3], q[2], q[3], self.fraction);
        let v_phi = v_y * per_swept;
        // The reference is the same for all rays: du/dpsi at fixed phi is dv/dpsi.
        let (u_s, slope_s) = if self.alike[0] > 0 { (0.0, 0.0) } else { self.family.reference(phi) };
        let u_psi = v_x * self.x_slope - v_phi * part * self.swept_slope;
        Some(Crossing { phi, u: v + u_s, u_psi, u_phi: v_phi + slope_s })
    }

    /// Time since light left a crossing (`Constants::retardation`), M; 0 if the table has no delays.
    pub fn delay(&self, crossing: &Crossing) -> f64 {
        if !self.family.with_delay || self.table.swept.is_empty() {
            return 0.0;
        }
        let integral = self.delay_integral(crossing.phi);
        let observer_slope = self.family.observer_slope(self.cos);
        self.family.delay(self.b, observer_slope, crossing.u, self.b * crossing.u_phi, integral)
    }

    fn delay_integral(&self, phi: f64) -> f64 {
        let (interval, y) = self.interval(phi / self.swept);
        let length = self.family.resolution.intervals as usize + 1;
        let h = 1.0 / f64::from(self.family.resolution.intervals);
        // The first of the four columns; the ends and the seam of the table have none before or behind.
        let first = self.column.saturating_sub(1).clamp(self.alike[0], self.alike[1] - 3);
        let values = std::array::from_fn(|i| {
            let at = (first + i) * length + interval;
            let [p, q] = [self.table.delay[at], self.table.delay[at + 1]];
            hermite(p[0], h * p[1], q[0], h * q[1], y).0
        });
        lagrange(values, (self.column - first) as f64 - 1.0 + self.fraction)
    }

    /// (d delay / dphi at fixed u, d delay / du at fixed phi): b and u' / (u^2 D), D = 1 - 2 u, ' = d/dtau. The delay
    /// to the observer is the action of the ray at E = 1, whose gradient is the momentum there (Hamilton-Jacobi).
    ///
    /// 0 if the table has no delays.
    pub fn delay_gradient(&self, crossing: &Crossing) -> (f64, f64) {
        if !self.family.with_delay {
            return (0.0, 0.0);
        }
        let (b, u) = (self.b, crossing.u);
        let slope = b * crossing.u_phi;
        (b, slope / (u * u * (1.0 - 2.0 * u)))
    }
}

#[cfg(test)]
mod unit_tests {
    use super::*;

    #[test]
    fn interpolations_reproduce_a_cubic() {
        let f = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x + 3.0 * x * x * x;
        let d = |x: f64| -2.0 + x + 9.0 * x * x;
        let (value, slope) = hermite(f(0.0), d(0.0), f(1.0), d(1.0), 0.3);
        assert!((value - f(0.3)).abs() < 1e-14 && (slope - d(0.3)).abs() < 1e-14);
        for x in [-0.9, 0.0, 0.4, 1.7] {
            assert!((lagrange([f(-1.0), f(0.0), f(1.0), f(2.0)], x) - f(x)).abs() < 1e-13);
        }
    }
}
