// SPDX-License-Identifier: MIT OR Apache-2.0
//! Parallel transport of vectors along a geodesic: four numbers each, integrated with the orbit. Knows one step of one
//! geodesic, no driver.
//!
//! Vectors have their components (t, x, y, z) of ingoing Kerr-Schild coordinates (Kerr 1963), in which the metric is
//! g = eta + f k k, regular at the poles and at both horizons. With the unit vector N and X the place,
//!
//! ```text
//! f = 2 r / Sigma,   k = (1, N),   X = r N + a z x N,   inverse of g = eta - f l l,   l = (-1, N)
//! ```
//!
//! X turns with N and, beyond that, by a (x - E) in Mino time (x of `Constants::advanced_rate`). The axes here turn by
//! that with it, so that N is the one of `State`, and only X' has to know of it.

use super::geodesic::{Constants, State, turned};
use super::integrator::Quintic;
use super::observer::{LocalFrame, Momentum};
use super::quadrature::{GAUSS_BEFORE, GAUSS_NODES, GAUSS_WEIGHTS};
use glam::{DMat3, DMat4, DVec3, DVec4};

/// A vector's components (t, x, y, z), in glam's order (x, y, z, w): w is t.
pub type Vector4 = DVec4;

/// The stages of the collocation method (`GAUSS_BEFORE`) are found by iteration, which gains the more digits each time
/// the less a step turns the vectors.
const ITERATIONS: usize = 12;

/// The metric at a place, and its slopes by x, y and z.
struct KerrSchild {
    r: f64,
    /// Sigma.
    sigma: f64,
    n: DVec3,
    f: f64,
    place: DVec3,
}

impl KerrSchild {
    fn new(a: f64, u: f64, n: DVec3) -> Self {
        let r = 1.0 / u;
        let sigma = r * r + (a * n.z).powi(2);
        Self { r, sigma, n, f: 2.0 * r / sigma, place: n * r + DVec3::Z.cross(n) * a }
    }

    /// g(v, w).
    fn product(&self, v: Vector4, w: Vector4) -> f64 {
        let along = |v: Vector4| v.w + self.n.dot(v.truncate());
        v.truncate().dot(w.truncate()) - v.w * w.w + self.f * along(v) * along(w)
    }

    /// d r, the gradient, and d N, of which column i is the slope of N by the coordinate i.
    fn slopes(&self, a: f64) -> (DVec3, DMat3) {
        let (r, n, place) = (self.r, self.n, self.place);
        let dr = (place * r + DVec3::Z * (a * a * n.z)) / self.sigma;
        let sum = r * r + a * a;
        // N_x = (r x + a y) / (r^2 + a^2), N_y = (r y - a x) / (r^2 + a^2), N_z = z / r.
        let slope = |i: usize| {
            let unit = DVec3::AXES[i];
            let across = (place * dr[i] + unit * r - DVec3::Z.cross(unit) * a - n * (2.0 * r * dr[i])) / sum;
            DVec3::new(across.x, across.y, (unit.z - n.z * dr[i]) / r)
        };
        (dr, DMat3::from_cols(slope(0), slope(1), slope(2)))
    }

    /// The matrix M of d v / d lambda = -M v for vectors v that are carried in parallel along `velocity`, lambda its
    /// parameter: M^a_c = Gamma^a_bc velocity^b, where Gamma_abc = (d_b g_ac + d_c g_ab - d_a g_bc) / 2.
    fn connection(&self, a: f64, velocity: Vector4) -> DMat4 {
        let (dr, dn) = self.slopes(a);
        // f = 2 r / (r^2 + a^2 N_z^2).
        let dn_z = DVec3::new(dn.x_axis.z, dn.y_axis.z, dn.z_axis.z);
        let df = dr * (2.0 / self.sigma) - (dr * self.r + dn_z * (a * a * self.n.z)) * (2.0 * self.f / self.sigma);
        let space = velocity.truncate();
        let along = velocity.w + self.n.dot(space);
        let k = self.n.extend(1.0);
        // d_c (g_ab) velocity^b = (d_c f k_a + f d_c k_a) (k . velocity) + f k_a d_c (k_b) velocity^b, in column c.
        let (f_rate, k_rate) = (df.dot(space), (dn * space).extend(0.0));
        let column =
            |slope: f64, dk: DVec3| (k * slope + dk.extend(0.0) * self.f) * along + k * (self.f * dk.dot(space));
        let by_place =
            DMat4::from_cols(column(df.x, dn.x_axis), column(df.y, dn.y_axis), column(df.z, dn.z_axis), DVec4::ZERO);
        let outer = |v: DVec4, w: DVec4| DMat4::from_cols(v * w.x, v * w.y, v * w.z, v * w.w);
        let along_path = outer(k, k) * f_rate + (outer(k_rate, k) + outer(k, k_rate)) * self.f;
        let lowered = (along_path + by_place - by_place.transpose()) * 0.5;
        // Raised by eta - f l l.
        let l = self.n.extend(-1.0);
        let eta = DMat4::from_diagonal(DVec4::new(1.0, 1.0, 1.0, -1.0));
        (eta - outer(l, l) * self.f) * lowered
    }
}

/// The four-velocity of a geodesic in the axes of this module, times Sigma (by Mino time that grows into the future),
/// from d N / d tau of that sense, u' of `State`, and its E and x.
fn velocity(at: &KerrSchild, a: f64, n_rate: DVec3, du: f64, energy: f64, advanced_rate: f64) -> Vector4 {
    // dr = -du / u^2, and u' of `State` is by time that grows into the past.
    let r_rate = du * at.r * at.r;
    let turn = a * (advanced_rate - energy);
    let space = at.n * r_rate + n_rate * at.r + DVec3::Z.cross(n_rate) * a + DVec3::Z.cross(at.place) * turn;
    space.extend(energy * at.sigma + 2.0 * at.r * advanced_rate)
}

/// The matrix A of d v / d tau = A v in Mino time (which grows into the past), at a place of a geodesic.
fn rate(c: &Constants, u: f64, du: f64, n: DVec3, dn: DVec3) -> DMat4 {
    let at = KerrSchild::new(c.a, u, n);
    let advanced_rate = c.advanced_rate(u, du);
    let along = velocity(&at, c.a, -dn, du, c.energy, advanced_rate);
    let turn = c.a * (advanced_rate - c.energy);
    // The axes turn with the drag, into the past as well.
    let axes =
        DMat4::from_cols(DVec4::new(0.0, turn, 0.0, 0.0), DVec4::new(-turn, 0.0, 0.0, 0.0), DVec4::ZERO, DVec4::ZERO);
    at.connection(c.a, along) + axes
}

/// `vectors` after the step of length `h` in tau between two states of a geodesic.
pub fn carried<const COUNT: usize>(
    c: &Constants,
    [from, to]: [&State; 2],
    h: f64,
    vectors: [Vector4; COUNT],
) -> [Vector4; COUNT] {
    if h == 0.0 {
        return vectors;
    }
    let u = Quintic::of_u(c, from, to, h);
    let (f0, f1) = (c.n_acceleration(from.n), c.n_acceleration(to.n));
    let n = [0, 1, 2].map(|i| Quintic::new(from.n[i], from.dn[i], f0[i], to.n[i], to.dn[i], f1[i], h));
    let rates = GAUSS_NODES.map(|x| {
        let ((u, du), [x, y, z]) = (u.at(x), [0, 1, 2].map(|i| n[i].at(x)));
        rate(c, u, du, DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1)) * h
    });
    vectors.map(|begin| {
        let mut slopes = rates.map(|rate| rate * begin);
        for _ in 0..ITERATIONS {
            let next = [0, 1, 2].map(|i| {
                let stage = (0..3).fold(begin, |sum, j| sum + slopes[j] * GAUSS_BEFORE[i][j]);
                rates[i] * stage
            });
            let change = (0..3).fold(0.0, |most: f64, i| most.max((next[i] - slopes[i]).abs().max_element()));
            slopes = next;
            if change <= 1e-15 * begin.abs().max_element() {
                break;
            }
        }
        (0..3).fold(begin, |sum, i| sum + slopes[i] * GAUSS_WEIGHTS[i])
    })
}

/// The rain observer's tetrad at the place of a state, in the axes of this module: e_r, e_th, e_ph, e_T.
pub struct Tetrad {
    at: KerrSchild,
    vectors: [Vector4; 4],
}

impl Tetrad {
    /// `frame` is the rain frame at the state's place in the chart, which `drag` has turned.
    pub fn new(frame: &LocalFrame, drag: f64) -> Self {
        let n = turned(frame.e_r, -drag);
        let at = KerrSchild::new(frame.a, 1.0 / frame.r, n);
        let vector = |energy: f64, space: DVec3| {
            let m = frame.doran_momentum(&Momentum { energy, space, mu2: 0.0 });
            let n_rate = turned(frame.e_theta * m.polar + frame.e_phi * m.around, -drag);
            velocity(&at, frame.a, n_rate, m.du, m.energy, m.advanced_rate) / at.sigma
        };
        let [r, theta, phi] = DVec3::AXES.map(|axis| vector(0.0, axis));
        let time = vector(1.0, DVec3::ZERO);
        Self { at, vectors: [r, theta, phi, time] }
    }

    /// The vector with the components (r, th, ph, T).
    pub fn vector(&self, components: DVec4) -> Vector4 {
        (0..4).fold(Vector4::ZERO, |sum, i| sum + self.vectors[i] * components[i])
    }

    /// The components (r, th, ph, T) of a vector.
    pub fn components(&self, vector: Vector4) -> DVec4 {
        let [r, theta, phi, time] = self.vectors.map(|e| self.at.product(e, vector));
        DVec4::new(r, theta, phi, -time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::integrator::nystrom_step;
    use crate::physics::metric::chart;
    use crate::physics::orbit::innermost_radius;

    /// The tetrad is orthonormal in the metric of Kerr and Schild, which shares no formula with it: outside, at and
    /// inside the horizons, on the axis too.
    #[test]
    fn rain_tetrads_are_orthonormal() {
        let mut worst: f64 = 0.0;
        for (a, r) in
            [(0.0, 1.3), (0.0, 40.0), (0.9, 8.0), (0.9, 1.2), (-0.9, 0.6), (0.5, 0.14), (1.0, 1.01), (-1.0, 3.0)]
        {
            for theta in [0.0, 0.3, 1.2, 2.7] {
                let frame = LocalFrame::rain(a, chart(r, theta, 0.6)).unwrap();
                let tetrad = Tetrad::new(&frame, 2.3);
                for i in 0..4 {
                    let components = tetrad.components(tetrad.vectors[i]);
                    worst = worst.max((components - DVec4::AXES[i]).abs().max_element() * r.min(1.0));
                }
            }
        }
        println!("tetrads are orthonormal to {worst:.1e}");
        assert!(worst < 1e-13, "{worst:.1e}");
    }

    /// A geodesic's own four-velocity is carried along: the connection, and the equations of motion of `geodesic`,
    /// which have been got in another way, agree. Through both horizons' places, and over a pole.
    #[test]
    fn four_velocities_are_carried_along() {
        let mut worst: f64 = 0.0;
        for (a, r, theta, beta, steps) in [
            (0.9, 6.0, 1.0, DVec3::new(0.4, 0.2, 0.3), 4000),
            (-0.7, 3.0, 2.0, DVec3::new(-0.1, 0.3, 0.2), 900),
            (0.0, 4.0, 0.3, DVec3::new(0.3, -0.6, 0.0), 1000),
            (1.0, 1.3, 1.5, DVec3::new(0.6, -0.3, -0.2), 1000),
            (0.8, 1.2, 1.1, DVec3::new(0.2, 0.1, -0.5), 200),
        ] {
            let momentum = Momentum::of_body(beta);
            let frame = LocalFrame::rain(a, chart(r, theta, 0.0)).unwrap();
            let (c, mut state) = frame.start_body(&momentum);
            let mut carry = [Tetrad::new(&frame, 0.0).vector(momentum.space.extend(momentum.energy))];
            for _ in 0..steps {
                let h = -2e-3 / c.scale;
                let next = nystrom_step(&c, &state, h, false);
                if next.u * 1.1 * innermost_radius(a) > 1.0 {
                    break;
                }
                carry = carried(&c, [&state, &next], h, carry);
                state = next;
            }
            let there = LocalFrame::rain(a, state.chart_direction() / state.u).unwrap();
            let found = Tetrad::new(&there, state.drag).components(carry[0]);
            let expected = there.momentum(&c, &state);
            let error = (found - expected.space.extend(expected.energy)).length() / expected.energy.powi(2);
            println!("a {a}: r {r} to {}: {error:.1e}", there.r);
            worst = worst.max(error);
        }
        assert!(worst < 1e-10, "{worst:.1e}");
    }

    /// The slopes of f and N against differences.
    #[test]
    fn slopes_are_the_slopes_of_the_metric() {
        let (a, u) = (0.8, 0.7);
        let n = DVec3::new(0.3, -0.5, 0.6).normalize();
        let at = KerrSchild::new(a, u, n);
        let (dr, dn) = at.slopes(a);
        let h = 1e-5;
        // Along any change of r and N the slopes give the changes back from that of the place.
        for (dr_path, turn) in [(1.0, DVec3::ZERO), (0.0, DVec3::X), (0.0, DVec3::Y), (-0.4, DVec3::new(0.2, 0.1, 0.9))]
        {
            let path = |s: f64| KerrSchild::new(a, 1.0 / (at.r + s * dr_path), (n + turn.cross(n) * s).normalize());
            let step = (path(h).place - path(-h).place) / (2.0 * h);
            assert!((dr.dot(step) - dr_path).abs() < 1e-9);
            assert!((dn * step - turn.cross(n)).length() < 1e-9);
        }
    }
}
