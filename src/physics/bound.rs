// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bound orbits of bodies about a spinning hole: their constants of motion and their frequencies. Knows no integrator.
//!
//! An orbit is named by its semi-latus rectum p and its eccentricity e, so that r lies in [p / (1 + e), p / (1 - e)],
//! and by x, the cosine of its inclination: cos^2 th is at most 1 - x^2, and the sign of x is the sense of the motion
//! (Schmidt 2002, Class. Quantum Grav. 19, 2743). `a` is signed: x > 0 is motion towards +ph.

use glam::DVec3;
use std::f64::consts::TAU;

/// The constants of motion of a body, per mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyConstants {
    pub energy: f64,
    /// L_z, M.
    pub angular_momentum: f64,
    /// Q of Carter 1968, M^2.
    pub carter: f64,
}

/// A bound orbit that is stable.
#[derive(Clone, Copy, Debug)]
pub struct BoundOrbit {
    a: f64,
    p: f64,
    e: f64,
    x: f64,
    pub constants: BodyConstants,
    /// Sum and product of the two roots of the radial potential that lie within the orbit.
    inner_sum: f64,
    inner_product: f64,
}

/// The frequencies of a bound orbit in Mino time, rad / M^-1, and how fast time passes in it (Fujita & Hikida 2009,
/// Class. Quantum Grav. 26, 135002): a frequency in the time t is that in Mino time over `time`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frequencies {
    /// From pericentre to pericentre.
    pub radial: f64,
    /// From one ascending node to the next; > 0.
    pub polar: f64,
    /// About the axis; its sign is that of x.
    pub azimuthal: f64,
    /// The mean of dt / d(Mino time), M.
    pub time: f64,
}

/// A polynomial of fourth degree, lowest coefficient first.
type Quartic = [f64; 5];

fn value(c: &Quartic, u: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

/// (f(v) - f(u)) / (v - u); the slope for v = u.
fn divided_difference(c: &Quartic, u: f64, v: f64) -> f64 {
    // (v^k - u^k) / (v - u) = v^(k-1) + u (v^(k-1) - u^(k-1)) / (v - u).
    let (mut sum, mut difference, mut power) = (0.0, 0.0, 1.0);
    for c in &c[1..] {
        difference = power + u * difference;
        power *= v;
        sum += c * difference;
    }
    sum
}

/// E, L and Q of the orbit, |a| <= 1, p > 0, 0 <= e <= 1, |x| <= 1. `None`: there is no such orbit, or the arguments
/// are out of range. (Schmidt 2002, eq. 9, 20; with L / x for L, which is regular for polar orbits.)
///
/// With z = 1 - x^2, l = L / x, Delta = r^2 - 2 r + a^2, both ends of the orbit solve f E^2 - 2 g E l - h l^2 = d,
/// where
///
/// ```text
/// d r^4 = (r^2 + a^2 z) Delta          f r^4 = r^4 + a^2 (r (r + 2) + z Delta)
/// g r^4 = 2 a x r                      h r^4 = x^2 r (r - 2) + z Delta
/// ```
///
/// are polynomials in u = 1/r. In place of the second end stands the difference of both, divided by that of their u:
/// circles are no exception, nor are parabolas, whose second end is at u = 0.
pub fn constants_of_motion(a: f64, p: f64, e: f64, x: f64) -> Option<BodyConstants> {
    if !(a.abs() <= 1.0 && p > 0.0 && (0.0..=1.0).contains(&e) && x.abs() <= 1.0) {
        return None;
    }
    let a2 = a * a;
    let z = (1.0 - x) * (1.0 + x);
    let d = [1.0, -2.0, a2 * (1.0 + z), -2.0 * z * a2, z * a2 * a2];
    let f = [1.0, 0.0, a2 * (1.0 + z), 2.0 * a2 * x * x, z * a2 * a2];
    let g = [0.0, 0.0, 0.0, 2.0 * a * x, 0.0];
    let h = [0.0, 0.0, 1.0, -2.0, z * a2];
    let (near, far) = ((1.0 + e) / p, (1.0 - e) / p);
    let ends = [d, f, g, h].map(|c| [value(&c, near), divided_difference(&c, near, far)]);
    let pair = |i: usize, j: usize| ends[i][0] * ends[j][1] - ends[i][1] * ends[j][0];
    let (kappa, epsilon, rho, eta, sigma) = (pair(0, 3), pair(0, 2), pair(1, 3), pair(1, 2), pair(2, 3));
    let root = sigma * (sigma * epsilon * epsilon + rho * epsilon * kappa - eta * kappa * kappa);
    // Both senses of motion solve the equations: the one along the spin has the lesser energy.
    let root = root.max(0.0).sqrt().copysign(a * x);
    let energy2 = (kappa * rho + 2.0 * epsilon * sigma - 2.0 * root) / (rho * rho + 4.0 * eta * sigma);
    let energy = energy2.sqrt();
    let [[d, _], [f, _], [g, _], [h, _]] = ends;
    let over_x = ((g * g * energy2 + (f * energy2 - d) * h).sqrt() - g * energy) / h;
    let found =
        BodyConstants { energy, angular_momentum: x * over_x, carter: z * (a2 * (1.0 - energy2) + over_x * over_x) };
    (energy > 0.0 && over_x >= 0.0 && found.carter.is_finite()).then_some(found)
}

impl BoundOrbit {
    /// |a| <= 1, p > 0, 0 <= e < 1, |x| <= 1. `None`: there is no such orbit, or it is not stable.
    pub fn new(a: f64, p: f64, e: f64, x: f64) -> Option<Self> {
        let constants = constants_of_motion(a, p, e, x)?;
        let bound = (1.0 - constants.energy) * (1.0 + constants.energy);
        let (near, far) = (p / (1.0 + e), p / (1.0 - e));
        let orbit = Self {
            a,
            p,
            e,
            x,
            constants,
            // By comparing the coefficients of R = (1 - E^2)(far - r)(r - near)(r - r3)(r - r4).
            inner_sum: 2.0 / bound - near - far,
            inner_product: a * a * constants.carter / (bound * near * far),
        };
        (bound > 0.0 && e < 1.0 && near > orbit.separatrix_radius()).then_some(orbit)
    }

    /// The radius of the unstable orbit of the same constants, where the orbit would end if its pericentre were there.
    pub fn separatrix_radius(&self) -> f64 {
        let half = 0.5 * self.inner_sum;
        half + (half * half - self.inner_product).max(0.0).sqrt()
    }

    /// (d psi / d lambda, r) at the phase psi of r = p / (1 + e cos psi), lambda being Mino time.
    fn radial_phase(&self, psi: f64) -> (f64, f64) {
        let bound = (1.0 - self.constants.energy) * (1.0 + self.constants.energy);
        let stretch = 1.0 + self.e * psi.cos();
        let r = self.p / stretch;
        let inner = r * r - self.inner_sum * r + self.inner_product;
        ((bound * inner / (1.0 - self.e * self.e)).sqrt() * stretch, r)
    }

    /// (d chi / d lambda, cos^2 th) at the phase chi of cos th = sqrt(1 - x^2) sin chi.
    fn polar_phase(&self, chi: f64) -> (f64, f64) {
        let BodyConstants { energy, angular_momentum, carter } = self.constants;
        let bound = self.a * self.a * (1.0 - energy) * (1.0 + energy);
        let cos2 = (1.0 - self.x) * (1.0 + self.x) * chi.sin().powi(2);
        let outer = angular_momentum * angular_momentum + carter + bound * self.x * self.x;
        ((outer - bound * cos2).sqrt(), cos2)
    }

    /// By the means over both phases, which converge exponentially in the number of places.
    pub fn frequencies(&self) -> Frequencies {
        let (a, a2) = (self.a, self.a * self.a);
        let BodyConstants { energy, angular_momentum: momentum, .. } = self.constants;
        // Integrals over a period: of 1, of ph' and of t'.
        let period = |rates: &dyn Fn(f64) -> DVec3| {
            let places = 512;
            let width = TAU / f64::from(places);
            (0..places).map(|i| rates((f64::from(i) + 0.5) * width)).sum::<DVec3>() * width
        };
        let radial = period(&|psi| {
            let (rate, r) = self.radial_phase(psi);
            let sum = r * r + a2;
            let p = (energy * sum - a * momentum) / (sum - 2.0 * r);
            DVec3::new(1.0, a * p, sum * p) / rate
        });
        let polar = period(&|chi| {
            let (rate, cos2) = self.polar_phase(chi);
            let sin2 = 1.0 - cos2;
            // L = x l; x^2 <= sin^2 th, and polar orbits have none.
            let around = if momentum == 0.0 { 0.0 } else { momentum / sin2 };
            DVec3::new(1.0, around - a * energy, a * momentum - a2 * energy * sin2) / rate
        });
        let mean = radial / radial.x + polar / polar.x;
        Frequencies { radial: TAU / radial.x, polar: TAU / polar.x, azimuthal: mean.y, time: mean.z }
    }
}
