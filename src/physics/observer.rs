// SPDX-License-Identifier: MIT OR Apache-2.0
//! Observers: the local orthonormal frame at a place, how a moving observer's directions look in it (aberration), and
//! the start of the light ray that a look direction stands for, or of a body's world line. Knows no integrator.
//!
//! A look direction n is opposite to the photon's momentum. Components are along (e_r, e_th, e_ph) of the local static
//! observer (ZAMO when the hole spins), or, at or inside a horizon and for a camera falling from rest at infinity, of
//! the rain observer, whose tetrad is the static one boosted by -sqrt(2/r) e_r (Painleve 1921, Gullstrand 1922).
//!
//! About a spinning hole the rain observer is Doran's (2000, Phys. Rev. D 61, 067503), who falls with E = 1, L = Q = 0:
//! e_T = d_T - sqrt(2 r (r^2 + a^2)) / Sigma d_r. The triad is the ZAMO's boosted along -e_r, too: e_ph along d_ph and
//! e_th along d_th, both as the azimuth of Doran's chart has them. It is regular at both horizons. Doran's own triad is
//!
//! ```text
//! E_r = sqrt(r^2 + a^2) / rho d_r        E_th = d_th / rho        rho^2 = Sigma = r^2 + a^2 cos^2 th
//! E_ph = d_ph / (sqrt(r^2 + a^2) s) + a s sqrt(2 r) / Sigma d_r,  s = sin th
//! ```
//!
//! which is turned about E_th by the angle d: e_ph = cos d E_ph + sin d E_r, e_r = cos d E_r - sin d E_ph, where
//!
//! ```text
//! sin d = -sqrt(2 r) a s / (rho Q),   cos d = sqrt(r^2 + a^2) / Q,   Q = sqrt(g_phph) / s
//! ```

use super::geodesic::{Clock, Constants, RAIN_CLOCK_RADIUS, State, rain_offset, turned};
use super::orbit::{circular_orbit, horizon_inner, horizon_outer, innermost_radius, zamo_omega};
use super::rain::{MOST_SERIES_SPIN, OffsetSeries, offsets};
use crate::error::{Error, Number, Result};
use glam::{DMat3, DVec3};

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
    /// `Constants::offsets` of the frame's rays.
    pub offsets: Option<OffsetSeries>,
}

/// The static observer (the ZAMO) at the place of a rain frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticObserver {
    pub lapse: f64,
    /// omega, the angular velocity of the ZAMO.
    pub angular_velocity: f64,
}

impl StaticObserver {
    /// The frequency that this observer measures: (E - omega L) / alpha.
    pub fn frequency(&self, energy: f64, angular_momentum: f64) -> f64 {
        (energy - self.angular_velocity * angular_momentum) / self.lapse
    }
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

/// A momentum as the observer of a frame measures it: light's, or a body's per mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    /// Frequency or energy, > 0: gamma of a body.
    pub energy: f64,
    /// Components (p_r, p_th, p_ph).
    pub space: DVec3,
    /// mu^2 = energy^2 - space^2: 0 or 1.
    pub mu2: f64,
}

impl Momentum {
    /// Light of frequency 1 that is seen in the unit look direction `n`.
    pub fn of_light(n: DVec3) -> Self {
        Self { energy: 1.0, space: -n, mu2: 0.0 }
    }

    /// A body of mass 1 at the velocity `beta`, |beta| < 1.
    pub fn of_body(beta: DVec3) -> Self {
        let gamma = 1.0 / (1.0 - beta.length_squared()).max(0.5 * f64::EPSILON).sqrt();
        Self { energy: gamma, space: beta * gamma, mu2: 1.0 }
    }
}

/// The numbers that the rain triad at a place is made of.
#[derive(Clone, Copy, Debug)]
pub struct RainTriad {
    u: f64,
    /// sqrt(2 u).
    pub w: f64,
    /// rho / r.
    pub rho: f64,
    /// sqrt(1 + a^2 u^2).
    pub q: f64,
    /// Q / r, Q = sqrt(g_phph) / sin th.
    pub circumference: f64,
    /// sin d and cos d.
    pub sin_turn: f64,
    pub cos_turn: f64,
}

impl RainTriad {
    /// At `r` of a hole of spin `a`, and sine and cosine of theta.
    pub fn new(a: f64, r: f64, sin: f64, cos: f64) -> Self {
        let u = 1.0 / r;
        let au = a * u;
        let w = (2.0 * u).sqrt();
        let rho2 = 1.0 + (au * cos).powi(2);
        let (rho, q) = (rho2.sqrt(), (1.0 + au * au).sqrt());
        // g_phph = s^2 (r^2 + a^2 + 2 r a^2 s^2 / Sigma): positive inside, too.
        let circumference = (1.0 + au * au + 2.0 * u * (au * sin).powi(2) / rho2).sqrt();
        let sin_turn = -w * au * sin / (rho * circumference);
        Self { u, w, rho, q, circumference, sin_turn, cos_turn: q / circumference }
    }
}

/// A momentum in Doran's chart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoranMomentum {
    /// E and L / sin th.
    pub energy: f64,
    pub around: f64,
    /// Sigma p^th.
    pub polar: f64,
    /// u' of `State`.
    pub du: f64,
    /// x of `Constants::advanced_rate`, which is linear in the momentum.
    pub advanced_rate: f64,
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
        let frame = Self {
            a,
            r,
            sin,
            cos,
            e_r: DVec3::new(sin * cos_phi, sin * sin_phi, cos),
            e_theta: DVec3::new(cos * cos_phi, cos * sin_phi, -sin),
            e_phi: DVec3::new(-sin_phi, cos_phi, 0.0),
            rain,
            lapse: f64::NAN,
            offsets: None,
        };
        Ok(if rain { frame } else { Self { lapse: frame.zamo_lapse(), ..frame } })
    }

    /// The rain frame at `position`, whose azimuth is Doran's (M = 1), outside the hole or inside: |a| <= 1, r > r- (1
    /// + 1e-6). Errors: INVALID_ARGUMENT for a spin or a place that is none, UNSUPPORTED farther in.
    pub fn rain(a: f64, position: DVec3) -> Result<Self> {
        if a.is_nan() || a.abs() > 1.0 {
            return Err(Error::argument(format!("a spin of {} is no hole's: it must lie in [-1, 1]", Number(a))));
        }
        // Its axes do not depend on the spin, and without spin there is a frame at every place.
        let Ok(place) = Self::new(0.0, position) else {
            return Err(Error::argument(format!(
                "position ({}, {}, {}) is no place: it must be finite, and not the hole's centre",
                Number(position.x),
                Number(position.y),
                Number(position.z)
            )));
        };
        let least = innermost_radius(a);
        if place.r <= least {
            return Err(Error::unsupported(format!(
                "r = {} M lies at or within {} M, which is r- (1 + 1e-6) of spin {}; the inside is known down to there",
                Number(place.r),
                Number(least),
                Number(a)
            )));
        }
        Ok(place.to_rain_of(a))
    }

    /// The rain frame of a hole of spin `a` at this place, of which the axes are the same at every spin.
    pub(crate) fn to_rain_of(self, a: f64) -> Self {
        Self { a, rain: true, lapse: f64::NAN, ..self }
    }

    /// This frame at the place that is turned about the hole's axis by `angle`. On the axis, too, its axes turn.
    pub(crate) fn turned(self, angle: f64) -> Self {
        let [e_r, e_theta, e_phi] = [self.e_r, self.e_theta, self.e_phi].map(|axis| turned(axis, angle));
        Self { e_r, e_theta, e_phi, ..self }
    }

    /// The static observer's (the ZAMO's) frame at the place of this rain frame outside the horizon: that place has
    /// another azimuth in the chart of Boyer and Lindquist.
    pub fn to_static(self) -> Self {
        debug_assert!(self.rain && self.r > horizon_outer(self.a));
        let there = if self.a == 0.0 { self } else { self.turned(-offsets(self.a, 1.0 / self.r).azimuth) };
        Self { rain: false, lapse: self.zamo_lapse(), ..there }
    }

    /// This rain frame for many rays, that tell azimuths and times of matter by the series of the chart's offsets where
    /// there is one: without spin none is needed.
    pub fn with_offset_series(self) -> Self {
        let has_series = self.a != 0.0 && self.a.abs() <= MOST_SERIES_SPIN;
        Self { offsets: has_series.then(|| OffsetSeries::new(self.a)), ..self }
    }

    /// Rain time less t here, M, by the integral; outside the horizon.
    pub fn rain_time_offset(&self) -> f64 {
        let u = 1.0 / self.r;
        if self.a == 0.0 { rain_offset(u, (self.r - 2.0) / self.r) } else { offsets(self.a, u).time }
    }

    /// sqrt(Sigma Delta / A), the ZAMO's lapse; NaN at or inside the horizon.
    fn zamo_lapse(&self) -> f64 {
        let (a, r) = (self.a, self.r);
        let sum = r * r + a * a;
        let delta = (r - horizon_outer(a)) * (r - horizon_inner(a));
        let sigma = r * r + (a * self.cos).powi(2);
        let squared = sigma * delta / (sum * sum - delta * (a * self.sin).powi(2));
        if r > horizon_outer(a) { squared.sqrt() } else { f64::NAN }
    }

    /// The rain frame at the same place. Spin 0 only.
    pub fn to_rain(self) -> Self {
        debug_assert!(self.a == 0.0);
        Self { rain: true, lapse: f64::NAN, ..self }
    }

    /// The clock by which rays of this frame tell times.
    pub fn clock(&self) -> Clock {
        if self.rain && (self.a != 0.0 || self.r <= RAIN_CLOCK_RADIUS) { Clock::Rain } else { Clock::Coordinate }
    }

    /// The lapse of the static observer (the ZAMO) at a place where the frame is that of the rain observer: sqrt(1 - 2
    /// / r) without spin. `None`: the frame is the static observer's own, or no observer is at rest there.
    pub fn static_lapse(&self) -> Option<f64> {
        if self.a != 0.0 {
            return Some(self.zamo_lapse()).filter(|lapse| self.rain && *lapse > 0.0);
        }
        let squared = 1.0 - 2.0 / self.r;
        (self.rain && squared > 0.0).then(|| squared.sqrt())
    }

    /// The static observer where the frame is that of the rain observer; `None` as for `static_lapse`.
    pub fn static_observer(&self) -> Option<StaticObserver> {
        let lapse = self.static_lapse()?;
        Some(StaticObserver { lapse, angular_velocity: zamo_omega(self.a, self.r, self.sin) })
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
        if self.rain && self.a != 0.0 {
            let triad = self.rain_triad();
            let speed = triad.w / triad.rho;
            return Momenta {
                energy: 1.0,
                energy_gradient: DVec3::new(triad.cos_turn * speed, 0.0, triad.sin_turn * speed),
                angular_momentum_gradient: DVec3::new(0.0, 0.0, -self.sin * (self.r * triad.circumference)),
            };
        }
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

    /// The backward ray along the unit look direction `n` (components). `None`: no light comes from there (in the rain
    /// frame inside the horizon: it would have to leave the past horizon, or come from another outside); such a ray is
    /// captured and crosses nothing.
    pub fn start(&self, n: DVec3) -> Option<(Constants, State)> {
        if self.rain { self.start_rain(n) } else { Some(self.start_zamo(n)) }
    }

    /// The constants and the state, in Doran's chart, of a body of mass 1 that has this momentum in the rain frame.
    pub fn start_body(&self, momentum: &Momentum) -> (Constants, State) {
        debug_assert!(self.rain);
        let m = self.doran_momentum(momentum);
        let constants = Constants::of_body(self.a, m.energy, self.sin * m.around, self.carter(&m, 1.0), 1.0 / self.r);
        (constants, self.state(&m, 1.0))
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

    /// Whether light of this energy and angular momentum that a rain observer sees can have come from outside the hole.
    pub fn sees_outside(&self, energy: f64, angular_momentum: f64) -> bool {
        let r_plus = horizon_outer(self.a);
        let energy_there = energy * (r_plus * r_plus + self.a * self.a) - self.a * angular_momentum;
        energy_there > 0.0 || (self.a != 0.0 && self.r > r_plus)
    }

    /// Light in the rain frame, at any spin. Inside the horizon light with P = E (r^2 + a^2) - a L <= 0 at r+ does not
    /// come from outside; without spin that is E <= 0.
    fn start_rain(&self, n: DVec3) -> Option<(Constants, State)> {
        let a = self.a;
        let m = self.doran_momentum(&Momentum::of_light(n));
        if !self.sees_outside(m.energy, self.sin * m.around) {
            return None;
        }
        // Without spin only light of E > 0 comes this far.
        let is_unit = a == 0.0 || m.energy > SMALLEST_UNIT_ENERGY;
        let (e, energy) = if is_unit { (1.0 / m.energy, 1.0) } else { (1.0, m.energy) };
        let carter = self.carter(&DoranMomentum { energy, polar: m.polar * e, around: m.around * e, ..m }, 0.0);
        let mut constants = Constants::new(a, energy, self.sin * (m.around * e), carter, e, 1.0 / self.r);
        constants.clock = self.clock();
        constants.offsets = self.offsets;
        Some((constants, self.state(&m, e)))
    }

    /// Q = (Sigma p^th)^2 + cos^2 th (a^2 (mu^2 - E^2) + L^2 / sin^2 th).
    fn carter(&self, m: &DoranMomentum, mu2: f64) -> f64 {
        let c = self.cos;
        m.polar * m.polar + (c * m.around).powi(2) - c * c * ((self.a * m.energy).powi(2) - mu2 * (self.a * self.a))
    }

    /// The state that a momentum in the rain frame, times `e`, starts.
    fn state(&self, m: &DoranMomentum, e: f64) -> State {
        State {
            u: 1.0 / self.r,
            du: e * m.du,
            n: self.e_r,
            dn: -(self.e_theta * (m.polar * e) + self.e_phi * (m.around * e)),
            drag: 0.0,
            delay: 0.0,
        }
    }

    pub fn rain_triad(&self) -> RainTriad {
        RainTriad::new(self.a, self.r, self.sin, self.cos)
    }

    /// A momentum in the rain triad as constants of motion and rates: with p^r and p^ph along E_r and E_ph
    ///
    /// ```text
    /// E = p^T - sqrt(2 r) / rho p^r                        L = sqrt(g_phph) p_ph          Sigma p^th = rho p_th
    /// u' = q (rho / r p^r - w p^T) + a u s w p^ph          x = (p^T + (rho / r p^r - a u s p^ph) / q) / (1 + w / q)
    /// ```
    pub(crate) fn doran_momentum(&self, p: &Momentum) -> DoranMomentum {
        let t = self.rain_triad();
        let (radial, around) =
            (t.cos_turn * p.space.x + t.sin_turn * p.space.z, t.cos_turn * p.space.z - t.sin_turn * p.space.x);
        let aus = self.a * t.u * self.sin;
        DoranMomentum {
            energy: p.energy - t.w / t.rho * radial,
            around: self.r * t.circumference * p.space.z,
            polar: self.r * t.rho * p.space.y,
            du: t.q * (t.rho * radial - t.w * p.energy) + aus * t.w * around,
            advanced_rate: (p.energy + (t.rho * radial - aus * around) / t.q) / (1.0 + t.w / t.q),
        }
    }

    /// The momentum in the rain frame of what is here in the state `there`, whose chart is the frame's: what
    /// `doran_momentum` is of it. p^r = (w x + u' / (q (1 + w / q))) r / rho has no difference that vanishes at a
    /// horizon.
    pub(crate) fn momentum(&self, c: &Constants, there: &State) -> Momentum {
        let t = self.rain_triad();
        let motion = -turned(there.dn, there.drag);
        let (polar, around) = (self.e_theta.dot(motion), self.e_phi.dot(motion));
        let radial = (t.w * c.advanced_rate(there.u, there.du) + there.du / (t.q + t.w)) / t.rho;
        let aus = self.a * t.u * self.sin;
        let azimuthal = (around * t.u + radial * t.w * aus / t.rho) / t.q;
        let space = DVec3::new(
            t.cos_turn * radial - t.sin_turn * azimuthal,
            polar * t.u / t.rho,
            around * t.u / t.circumference,
        );
        Momentum { energy: c.energy + t.w / t.rho * radial, space, mu2: c.mu2 }
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

    /// Falls radially from rest at infinity: E = 1, L = Q = 0, so that th stays. Spin 0: at rest in the rain frame, at
    /// any r. With spin: against the ZAMO.
    pub fn free_fall(frame: LocalFrame) -> Self {
        if frame.a == 0.0 {
            return Self::at_rest(frame.to_rain());
        }
        Self::rain_against(frame)
    }

    /// The rain observer as the static one (the ZAMO) of `frame` has it: gamma = 1 / alpha.
    pub fn rain_against(frame: LocalFrame) -> Self {
        let speed = ((1.0 - frame.lapse) * (1.0 + frame.lapse)).sqrt();
        Self { frame, beta: DVec3::new(-speed, 0.0, 0.0), gamma: 1.0 / frame.lapse }
    }

    /// This observer against the frame in which its own frame moves at the velocity of `carrier`, and the turn between
    /// their axes: n in the axes of `self` is turn * n in those of the result, both boosted without rotation.
    ///
    /// Two boosts make a boost and a turn (Thomas 1926; Wigner 1939). With spinors, exp(eta / 2 v.sigma), and T = gamma
    /// beta / (gamma + 1), which is tanh(eta / 2) v: half the angle of the turn, about T2 x T1, has the tangent
    /// |T2 x T1| / (1 + T1.T2).
    pub fn carried_by(&self, carrier: &Self) -> (Self, DMat3) {
        let half = |observer: &Self| observer.beta * (observer.gamma / (observer.gamma + 1.0));
        let (first, second) = (half(carrier), half(self));
        let axis = second.cross(first) / (1.0 + first.dot(second));
        let turn = match axis.length() {
            0.0 => DMat3::IDENTITY,
            tangent => DMat3::from_axis_angle(axis / tangent, 2.0 * tangent.atan()),
        };
        let momentum = self.beta * self.gamma;
        let along = carrier.beta.dot(momentum);
        let gamma = carrier.gamma * self.gamma + carrier.gamma * along;
        let factor = carrier.gamma * carrier.gamma / (carrier.gamma + 1.0) * along + carrier.gamma * self.gamma;
        let beta = (momentum + carrier.beta * factor) / gamma;
        (Self { frame: carrier.frame, beta, gamma }, turn)
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
        // At rest in the rain frame, E = 1: d tau / d t is the square of the lapse, 1 - 2/r without spin.
        let spinning = self.frame.a != 0.0;
        let rate = if spinning { self.frame.zamo_lapse().powi(2) } else { (self.frame.r - 2.0) / self.frame.r };
        if rate > 0.0 { rate } else { f64::NAN }
    }
}
