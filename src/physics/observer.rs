// SPDX-License-Identifier: MIT OR Apache-2.0
//! Observers: the local orthonormal frame at a place, how a moving observer's directions look in it (aberration), and
//! the start of the light ray that a look direction stands for. Knows no integrator.
//!
//! A look direction n is opposite to the photon's momentum. Components are along (e_r, e_th, e_ph) of the local static
//! observer (ZAMO when the hole spins), or, at or inside a spin-0 horizon and for a camera falling from rest at
//! infinity, of the rain observer, whose tetrad is the static one boosted by -sqrt(2/r) e_r (Painleve 1921, Gullstrand
//! 1922).

use super::geodesic::{Clock, Constants, RAIN_CLOCK_RADIUS, State};
use super::orbit::{circular_orbit, horizon_inner, horizon_outer, zamo_omega};
use glam::DVec3;

/// Below this E (at nu_local = 1) rays keep nu_local = 1: E = 1 would scale K and L beyond use, and E <= 0 turn tau
/// round.
const SMALLEST_UNIT_ENERGY: f64 = 1e-4;

/// A place in the chart with its local orthonormal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFrame {
    pub a: f64,
    pub r: f64,
    /// Sine and cosine of the polar angle, as ratios of coordinates: exactly 0 in the plane and on the axis.
    pub sin: f64,
    pub cos: f64,
    /// Euclidean unit vectors of spherical coordinates at the place. On the axis the azimuth is 0.
    pub e_r: DVec3,
    pub e_theta: DVec3,
    pub e_phi: DVec3,
    /// The rain observer's frame instead of the static one's.
    pub rain: bool,
    /// Lapse of the ZAMO, alpha = sqrt(Sigma Delta / A); NaN for rain.
    pub lapse: f64,
}

/// E and L of light along look directions n (components) of one frame, at nu_local = 1: affine in n, as tetrads are
/// linear.
#[derive(Clone, Copy, Debug)]
pub struct Momenta {
    energy: f64,
    energy_gradient: DVec3,
    angular_momentum_gradient: DVec3,
}

impl Momenta {
    /// E; <= 0 in the rain frame: no light comes from there.
    pub fn energy(&self, n: DVec3) -> f64 {
        self.energy + self.energy_gradient.dot(n)
    }

    /// L_z.
    pub fn angular_momentum(&self, n: DVec3) -> f64 {
        self.angular_momentum_gradient.dot(n)
    }
}

/// Why no frame exists at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFrame {
    /// The place is not finite, or r = 0.
    NotAPlace,
    /// At or inside a spinning hole's horizon.
    InsideSpinningHorizon,
}

impl LocalFrame {
    /// The static / ZAMO frame at `position` (chart, M = 1); rain at or inside a spin-0 horizon.
    pub fn new(a: f64, position: DVec3) -> Result<Self, NoFrame> {
        let rho = position.x.hypot(position.y);
        let r = rho.hypot(position.z);
        if !(r > 0.0 && r.is_finite()) {
            return Err(NoFrame::NotAPlace);
        }
        let (sin, cos) = (rho / r, position.z / r);
        let (sin_phi, cos_phi) = if rho == 0.0 { (0.0, 1.0) } else { (position.y / rho, position.x / rho) };
        let rain = r <= horizon_outer(a);
        if rain && a != 0.0 {
            return Err(NoFrame::InsideSpinningHorizon);
        }
        let lapse = if rain {
            f64::NAN
        } else {
            let sum = r * r + a * a;
            let delta = (r - horizon_outer(a)) * (r - horizon_inner(a));
            let sigma = r * r + (a * cos).powi(2);
            (sigma * delta / (sum * sum - delta * (a * sin).powi(2))).sqrt()
        };
        Ok(Self {
            a,
            r,
            sin,
            cos,
            e_r: DVec3::new(sin * cos_phi, sin * sin_phi, cos),
            e_theta: DVec3::new(cos * cos_phi, cos * sin_phi, -sin),
            e_phi: DVec3::new(-sin_phi, cos_phi, 0.0),
            rain,
            lapse,
        })
    }

    /// The rain frame at the same place. Spin 0 only.
    pub fn to_rain(self) -> Self {
        debug_assert!(self.a == 0.0);
        Self { rain: true, lapse: f64::NAN, ..self }
    }

    /// The clock by which rays of this frame tell times.
    pub fn clock(&self) -> Clock {
        if self.rain && self.r <= RAIN_CLOCK_RADIUS { Clock::Rain } else { Clock::Coordinate }
    }

    /// sqrt(1 - 2 / r), the lapse of the static observer at a place where the frame is that of the rain observer.
    /// `None`: the frame is the static observer's (or the ZAMO's) own, or no observer is at rest there.
    pub fn static_lapse(&self) -> Option<f64> {
        let squared = 1.0 - 2.0 / self.r;
        (self.rain && squared > 0.0).then(|| squared.sqrt())
    }

    /// Components (n_r, n_th, n_ph) of a chart vector.
    pub fn components(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.e_r.dot(v), self.e_theta.dot(v), self.e_phi.dot(v))
    }

    /// The chart vector of components (n_r, n_th, n_ph).
    pub fn vector(&self, n: DVec3) -> DVec3 {
        self.e_r * n.x + self.e_theta * n.y + self.e_phi * n.z
    }

    /// E and L of the frame's rays at nu_local = 1, as in `start`.
    pub fn momenta(&self) -> Momenta {
        if self.rain {
            let beta = (2.0 / self.r).sqrt();
            return Momenta {
                energy: 1.0,
                energy_gradient: DVec3::new(beta, 0.0, 0.0),
                angular_momentum_gradient: DVec3::new(0.0, 0.0, -self.sin * self.r),
            };
        }
        let q = self.circumference();
        let omega = zamo_omega(self.a, self.r, self.sin);
        let angular_momentum_gradient = DVec3::new(0.0, 0.0, -self.sin * q);
        Momenta { energy: self.lapse, energy_gradient: angular_momentum_gradient * omega, angular_momentum_gradient }
    }

    /// sqrt(A / Sigma) = sqrt(g_phph) / sin(theta), Boyer-Lindquist (Bardeen, Press & Teukolsky 1972, eq. 2.3).
    pub(crate) fn circumference(&self) -> f64 {
        let u = 1.0 / self.r;
        let au2 = (self.a * u).powi(2);
        let sigma = 1.0 + au2 * self.cos * self.cos;
        let d = (1.0 - horizon_outer(self.a) * u) * (1.0 - horizon_inner(self.a) * u);
        let big_a = (1.0 + au2).powi(2) - d * au2 * self.sin * self.sin;
        (big_a / sigma).sqrt() / u
    }

    /// The backward ray along the unit look direction `n` (components). `None`: no light comes from there (E <= 0 in
    /// the rain frame: it would have to leave the past horizon); such a ray is captured and crosses nothing.
    pub fn start(&self, n: DVec3) -> Option<(Constants, State)> {
        if self.rain { self.start_rain(n) } else { Some(self.start_zamo(n)) }
    }

    /// The start values of docs/numerics.md: outside the ergosphere no difference of nearly equal numbers appears.
    fn start_zamo(&self, n: DVec3) -> (Constants, State) {
        let (a, u) = (self.a, 1.0 / self.r);
        let (s, c, p) = (self.sin, self.cos, -n);
        let au2 = (a * u).powi(2);
        let sigma = 1.0 + au2 * c * c;
        let d = (1.0 - horizon_outer(a) * u) * (1.0 - horizon_inner(a) * u);
        let q = self.circumference();
        let omega = zamo_omega(a, self.r, s);
        let e_local = self.lapse + omega * q * s * p.z;
        let scale = if e_local > SMALLEST_UNIT_ENERGY { 1.0 / e_local } else { 1.0 };
        let energy = if e_local > SMALLEST_UNIT_ENERGY { 1.0 } else { e_local };
        let polar = sigma.sqrt() * p.y * scale / u;
        let w = q * p.z * scale;
        let carter = polar * polar + c * c * (w * w - (a * energy).powi(2));
        let constants = Constants::new(a, energy, s * w, carter, scale, u);
        let state = State {
            u,
            du: (sigma * d).sqrt() * p.x * scale,
            n: self.e_r,
            dn: -(self.e_theta * polar + self.e_phi * w),
            drag: 0.0,
            delay: 0.0,
        };
        (constants, state)
    }

    /// The start values in the rain tetrad e_T = d_T - beta d_r, e_r = d_r, e_th = d_th / r, e_ph = d_ph / (r s), beta
    /// = sqrt(2 u).
    fn start_rain(&self, n: DVec3) -> Option<(Constants, State)> {
        let u = 1.0 / self.r;
        let beta = (2.0 * u).sqrt();
        let p = -n;
        let energy = 1.0 + beta * n.x;
        if energy <= 0.0 {
            return None;
        }
        let e = 1.0 / energy;
        let (polar, w) = (self.r * p.y * e, self.r * p.z * e);
        let carter = polar * polar + (self.cos * w).powi(2);
        let mut constants = Constants::new(0.0, 1.0, self.sin * w, carter, e, u);
        constants.clock = self.clock();
        let state = State {
            u,
            du: e * (p.x - beta),
            n: self.e_r,
            dn: -(self.e_theta * polar + self.e_phi * w),
            drag: 0.0,
            delay: 0.0,
        };
        Some((constants, state))
    }
}

/// An observer moving at velocity `beta` (components, |beta| < 1) against the frame; its axes are the frame's, boosted
/// without rotation.
#[derive(Clone, Copy, Debug)]
pub struct Observer {
    pub frame: LocalFrame,
    pub beta: DVec3,
    pub gamma: f64,
}

impl Observer {
    /// From this gamma on 1 - beta.n is computed from the angle between the two: as a difference of numbers near 1 it
    /// keeps 6e-8 in f32 and 1e-16 in f64, and near the direction of motion, where such observers see nearly all light,
    /// it is 1 / (2 gamma^2).
    pub const SWIFT: f64 = 32.0;

    /// A velocity whose length is rounded to 1 counts as the largest one below.
    pub fn moving(frame: LocalFrame, beta: DVec3) -> Self {
        Self { frame, beta, gamma: 1.0 / (1.0 - beta.length_squared()).max(0.5 * f64::EPSILON).sqrt() }
    }

    pub fn at_rest(frame: LocalFrame) -> Self {
        Self { frame, beta: DVec3::ZERO, gamma: 1.0 }
    }

    /// Falls radially from rest at infinity. Spin 0: at rest in the rain frame, at any r. With spin: E = 1, L = Q = 0,
    /// so that gamma = 1 / alpha against the ZAMO and th stays.
    pub fn free_fall(frame: LocalFrame) -> Self {
        if frame.a == 0.0 {
            return Self::at_rest(frame.to_rain());
        }
        let speed = ((1.0 - frame.lapse) * (1.0 + frame.lapse)).sqrt();
        Self { frame, beta: DVec3::new(-speed, 0.0, 0.0), gamma: 1.0 / frame.lapse }
    }

    /// The largest |cos(theta)| that counts as in the equatorial plane: places that were computed, as r cos(pi / 2),
    /// miss it by some roundings.
    pub const IN_PLANE: f64 = 1e-12;

    /// On a circular geodesic towards +ph: spin 0 at any latitude (the great circle along e_ph), with spin in the
    /// plane. `None`: no such orbit there.
    pub fn orbiting(frame: LocalFrame) -> Option<Self> {
        if frame.rain || (frame.a != 0.0 && frame.cos.abs() > Self::IN_PLANE) {
            return None;
        }
        let orbit = circular_orbit(frame.a, frame.r)?;
        Some(Self::moving(frame, DVec3::new(0.0, 0.0, orbit.beta)))
    }

    /// Aberration: the look direction in the frame for `n` seen by the moving observer, and nu_observer / nu_frame.
    ///
    /// n_frame = (n + ((gamma - 1)(beta.n) / beta^2 - gamma) beta) / (gamma (1 - beta.n)), ratio 1 / (gamma (1 -
    /// beta.n)).
    pub fn aberrate(&self, n: DVec3) -> (DVec3, f64) {
        if self.beta == DVec3::ZERO {
            return (n, 1.0);
        }
        if self.gamma > Self::SWIFT {
            return self.aberrate_swift(n);
        }
        let along = self.beta.dot(n);
        // (gamma - 1) / beta^2 = gamma^2 / (gamma + 1): regular at rest.
        let factor = self.gamma * self.gamma / (self.gamma + 1.0) * along - self.gamma;
        let ratio = 1.0 / (self.gamma * (1.0 - along));
        (((n + self.beta * factor) * ratio).normalize(), ratio)
    }

    /// With the angle w between n and the motion, and f = 1 - cos w: 1 - beta cos w = (1 - beta) + beta f, and along
    /// the motion n_frame holds (cos w - beta) / (1 - beta cos w), across it what n holds, times the ratio.
    fn aberrate_swift(&self, n: DVec3) -> (DVec3, f64) {
        let motion = self.beta.normalize();
        let off = n - motion;
        let f = 0.5 * off.length_squared();
        let lag = self.one_less_beta();
        let q = lag + (1.0 - lag) * f;
        let ratio = 1.0 / (self.gamma * q);
        ((motion * ((lag - f) / q) + (off + motion * f) * ratio).normalize(), ratio)
    }

    /// 1 - beta = (1 / gamma^2) / (1 + beta).
    fn one_less_beta(&self) -> f64 {
        let inverse = 1.0 / (self.gamma * self.gamma);
        inverse / (1.0 + (1.0 - inverse).sqrt())
    }

    /// The change of the look direction in the frame, `seen` (with its frequency ratio), for a small change `dn` of
    /// the one seen by the moving observer: the derivative of `aberrate`.
    pub fn aberrate_change(&self, (seen, ratio): (DVec3, f64), dn: DVec3) -> DVec3 {
        if self.beta == DVec3::ZERO {
            return dn;
        }
        let along = self.beta.dot(dn);
        let gamma = self.gamma;
        (dn + self.beta * (gamma * gamma / (gamma + 1.0) * along) + seen * (gamma * along)) * ratio
    }

    /// d tau / d t: alpha / gamma, in the chart's t; NaN in the rain frame at or inside the horizon.
    pub fn time_rate(&self) -> f64 {
        if !self.frame.rain {
            return self.frame.lapse / self.gamma;
        }
        // At rest in the rain frame, E = 1: d tau / d t = 1 - 2/r.
        let rate = (self.frame.r - 2.0) / self.frame.r;
        if rate > 0.0 { rate } else { f64::NAN }
    }
}
