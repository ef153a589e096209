// SPDX-License-Identifier: MIT OR Apache-2.0
//! Geodesics traced backward, in Mino time tau: the equations of motion of light and of bodies, and what is measured
//! along a ray. Knows no integrator and no observer. What light needs is mirrored by
//! `shaders/geodesic/geodesic.wgsl`.
//!
//! State: u = 1/r, the unit position vector N (in axes that the drag has not turned), the drag angle and the delay.
//! With the constants mu (the mass: 0 for light, 1 for bodies, whose other constants are per mass), E, L = L_z, Q
//! (Carter's), K = Q + L^2, B = K - 2 a L E + a^2 E^2 and primes for d / d tau (Carter 1968; the N equation is a
//! Neumann problem):
//!
//! ```text
//! u''    = mu^2 + (a^2 (E^2 - mu^2) - K) u + 3 B u^2 - 2 a^2 Q u^3
//! N''    = -(K + 2 a^2 (E^2 - mu^2) N_z^2) N + a^2 (E^2 - mu^2) N_z z
//! drag'  = -a (2 E u - a L u^2) / D,     D = 1 - 2 u + a^2 u^2
//! ```
//!
//! Polynomial right-hand sides without square roots: regular at poles, turning points and infinity (u = 0). The chart
//! position is N turned about z by `drag`. a = 0 is Schwarzschild. The first integral is, with W = E + a (a E - L) u^2,
//!
//! ```text
//! u'^2   = W^2 - D (mu^2 + B u^2)
//! ```
//!
//! tau grows into the past: bodies move on with steps below 0, and everything that falls in has u' < 0.
//!
//! In Doran's chart (`Clock::Rain`; `rain`) azimuth and time are regular at both horizons for everything that falls in.
//! With x = (W + u') / D, which for such motion is (mu^2 + B u^2) / (W - u'), w = sqrt(2 u), q^2 = 1 + a^2 u^2 and
//! beta = w / q, from d(ph_Doran - ph)/dr and d(T - t)/dr of Doran 2000 and Carter's equations:
//!
//! ```text
//! drag'  = -a (x - E) + a u' / (q^2 (1 + beta))
//! delay' = W / u^2 + 2 x / u + a (L - a E sin^2 th) + beta / (1 + beta) u' / u^2
//! ```

use super::orbit::{horizon_inner, horizon_outer};
use super::rain::{OffsetSeries, Offsets, offsets};
use glam::DVec3;

/// The time that `State::delay` integrates, and the azimuth that `State::drag` leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Boyer-Lindquist (Schwarzschild) t and azimuth, for observers outside the horizon.
    Coordinate,
    /// Doran's, regular through the horizons: rain time, which without spin is Painleve and Gullstrand's.
    /// `Constants::clock_offset` leads to t.
    Rain,
}

/// The clock of falling observers is rain time from here inwards: t would cost the more digits the nearer to the
/// horizon. It is the photon sphere: from no farther out, all light that escapes moves outwards only, for which the
/// rate of rain time is regular.
pub const RAIN_CLOCK_RADIUS: f64 = 3.0;

/// H, rain time less t outside the horizon, M: dH/dr = sqrt(2/r) / (1 - 2/r), so that
///
/// ```text
/// H = 2 sqrt(2 r) + 2 ln((sqrt r - sqrt 2) / (sqrt r + sqrt 2))
///   = 4 / w + 2 ln(D / (1 + w)^2),   w = sqrt(2 u),   D = 1 - 2 u
/// ```
///
/// (Gullstrand 1922; Martel & Poisson 2001, eq. 2.5). `d` is D: beside the horizon the caller knows it better than `u`
/// tells.
pub fn rain_offset(u: f64, d: f64) -> f64 {
    let w = (2.0 * u).sqrt();
    4.0 / w + 2.0 * (d / (1.0 + w).powi(2)).ln()
}

/// The constants of one geodesic; energy, angular momentum and Carter's constant of bodies are per mass. Light is
/// scaled so that E = 1 where the local energy allows it, else so that the observer of the local frame measures
/// frequency 1: inside the ergosphere E <= 0 occurs, and E = 1 would turn tau round.
#[derive(Clone, Copy, Debug)]
pub struct Constants {
    pub a: f64,
    /// mu^2: 0 for light, 1 for bodies.
    pub mu2: f64,
    pub energy: f64,
    pub angular_momentum: f64,
    pub carter: f64,
    /// K = Q + L^2.
    pub k: f64,
    /// B = K - 2 a L E + a^2 E^2.
    pub b: f64,
    /// a^2 (E^2 - mu^2): a^2 E^2 for light.
    pub a2e2: f64,
    /// Frequency that the observer of the local frame measures, in the units that `energy` is in.
    pub nu_local: f64,
    pub u_observer: f64,
    /// S: sigma = S tau is the parameter in which all rays take steps of like size.
    pub scale: f64,
    pub r_plus: f64,
    pub r_minus: f64,
    pub clock: Clock,
    /// By rain time about a spinning hole: how the offsets of its chart are found; `None`: by their integrals.
    pub offsets: Option<OffsetSeries>,
}

#[derive(Clone, Copy, Debug)]
pub struct State {
    pub u: f64,
    pub du: f64,
    pub n: DVec3,
    pub dn: DVec3,
    pub drag: f64,
    /// The integral part of the delay; `Constants::delay` adds the boundary terms.
    pub delay: f64,
}

/// The part of sqrt(K) that L must be for N to turn about the axis nearly as evenly as it turns at all: a ray that
/// passes close to the axis gains half a turn there, and on the axis' other side loses one.
pub(crate) const AROUND_AXIS: f64 = 0.5;

impl Constants {
    /// The constants of light, in the chart of Boyer and Lindquist.
    pub fn new(a: f64, energy: f64, angular_momentum: f64, carter: f64, nu_local: f64, u_observer: f64) -> Self {
        Self::of_mass(0.0, a, energy, angular_momentum, carter, nu_local, u_observer)
    }

    /// The constants of a body that is at 1/r = `u`, per mass, in Doran's chart.
    pub fn of_body(a: f64, energy: f64, angular_momentum: f64, carter: f64, u: f64) -> Self {
        Self { clock: Clock::Rain, ..Self::of_mass(1.0, a, energy, angular_momentum, carter, 1.0, u) }
    }

    fn of_mass(mu2: f64, a: f64, energy: f64, angular_momentum: f64, carter: f64, nu_local: f64, u: f64) -> Self {
        let k = carter + angular_momentum * angular_momentum;
        let e2 = (a * energy).powi(2);
        let a2e2 = e2 - mu2 * (a * a);
        Self {
            a,
            mu2,
            energy,
            angular_momentum,
            carter,
            k,
            b: k - 2.0 * a * angular_momentum * energy + e2,
            a2e2,
            nu_local,
            u_observer: u,
            // 3 |E|: radial rays have K = 0 but still r to travel. (K + a^2 E^2 >= 0 for light.)
            scale: (k + a2e2).max(0.0).sqrt().max(3.0 * energy.abs()),
            r_plus: horizon_outer(a),
            r_minus: horizon_inner(a),
            clock: Clock::Coordinate,
            offsets: None,
        }
    }

    /// u''.
    #[inline(always)]
    pub fn u_acceleration(&self, u: f64) -> f64 {
        self.mu2 + u * (self.a2e2 - self.k + u * (3.0 * self.b - u * (2.0 * self.a * self.a * self.carter)))
    }

    /// W = E + a (a E - L) u^2, which is u^2 P with Carter's P = E (r^2 + a^2) - a L.
    #[inline(always)]
    pub fn radial_energy(&self, u: f64) -> f64 {
        self.energy + self.a * (self.a * self.energy - self.angular_momentum) * (u * u)
    }

    /// u'^2 by the first integral, W^2 - D (mu^2 + B u^2).
    #[inline(always)]
    pub fn radial_speed_squared(&self, u: f64) -> f64 {
        let w = self.radial_energy(u);
        w * w - self.horizon_function(u) * (self.mu2 + self.b * u * u)
    }

    /// Whether what is at 1/r = `u` inside the horizon has come in through it, from the outside that observers share:
    /// P > 0 there. With P <= 0 at r+ it would have come out of the past horizon.
    pub fn comes_from_outside(&self) -> bool {
        self.radial_energy(1.0 / self.r_plus) > 0.0
    }

    /// x = (W + u') / D, without its 0 / 0 at the horizons: advanced time grows by (r^2 + a^2) x + a (L - a E sin^2
    /// th).
    #[inline(always)]
    pub fn advanced_rate(&self, u: f64, du: f64) -> f64 {
        let w = self.radial_energy(u);
        if w >= 0.0 && du <= 0.0 { (self.mu2 + self.b * u * u) / (w - du) } else { (w + du) / self.horizon_function(u) }
    }

    /// How fast N turns in Mino time, at most. Unlike S it does not count how fast u changes, which inside a horizon
    /// knows no limit.
    #[inline]
    pub fn turn_rate(&self) -> f64 {
        (self.k.abs() + 2.0 * self.a2e2.abs()).sqrt()
    }

    /// How near a ray comes to staying for ever at the radius of a photon orbit, where u'^2 = R(u) is least:
    ///
    /// ```text
    /// R = E^2 - (K - a^2 E^2) u^2 + 2 B u^3 - a^2 Q u^4,   margin = 3 |R| / (kappa^2 u^2),   kappa^2 = R'' / 2
    /// ```
    ///
    /// there. Rays part from that radius as exp(kappa tau), so that whatever is wrong at the ray's begin is some
    /// 1 / margin times as large when it leaves. Without spin it is |27 / b^2 - 1|. Infinity: the ray does not go
    /// there.
    pub fn critical_margin(&self, start: &State) -> f64 {
        let (c, a2q) = (self.k - self.a2e2, self.a * self.a * self.carter);
        let root = (9.0 * self.b * self.b - 8.0 * a2q * c).sqrt();
        let u = 2.0 * c / (3.0 * self.b + root);
        let kappa2 = u * (6.0 * self.b - 6.0 * a2q * u) - c;
        // Moving away from it.
        let leaves = (start.u - u) * start.du > 0.0;
        if leaves || !(u > 0.0 && u * self.r_plus < 1.0 && kappa2 > 0.0) {
            return f64::INFINITY;
        }
        let least = self.energy * self.energy + u * u * (u * (2.0 * self.b - a2q * u) - c);
        3.0 * least.abs() / (kappa2 * u * u)
    }

    /// N''.
    #[inline(always)]
    pub fn n_acceleration(&self, n: DVec3) -> DVec3 {
        let mut f = n * -(self.k + 2.0 * self.a2e2 * n.z * n.z);
        f.z += self.a2e2 * n.z;
        f
    }

    /// D = Delta / r^2 from its roots: no cancellation near the horizon.
    #[inline(always)]
    pub fn horizon_function(&self, u: f64) -> f64 {
        (1.0 - self.r_plus * u) * (1.0 - self.r_minus * u)
    }

    /// drag' = d ph / d tau of the backward ray beyond what N turns.
    #[inline(always)]
    pub fn drag_rate(&self, u: f64) -> f64 {
        if self.a == 0.0 {
            return 0.0;
        }
        -self.a * u * (2.0 * self.energy - self.a * self.angular_momentum * u) / self.horizon_function(u)
    }

    /// drag' to Kerr's azimuth (`rain::doran_turn`): -a (x - E).
    #[inline(always)]
    pub fn kerr_drag_rate(&self, u: f64, du: f64) -> f64 {
        -self.a * (self.advanced_rate(u, du) - self.energy)
    }

    /// drag' in Doran's chart, without what `rain_drag_boundary` holds in closed form: near infinity it goes as
    /// sqrt(u), which no step would meet.
    ///
    /// 1 / (q^2 (1 + beta)) = 1 / (1 + w) - (a^2 u^2 + w a^2 u^2 / (1 + q)) / ((q^2 + q w) (1 + w)).
    #[inline(always)]
    pub fn rain_drag_rate(&self, u: f64, du: f64) -> f64 {
        let w = (2.0 * u.max(0.0)).sqrt();
        let au2 = (self.a * u).powi(2);
        let q = (1.0 + au2).sqrt();
        let rest = au2 * (1.0 + w / (1.0 + q)) / (q * (q + w) * (1.0 + w));
        self.kerr_drag_rate(u, du) - self.a * du * rest
    }

    /// d(azimuth of the chart) / d tau beyond what N turns, in whichever chart the clock has.
    pub fn turning_rate(&self, u: f64, du: f64) -> f64 {
        if self.clock == Clock::Coordinate || self.a == 0.0 {
            return self.drag_rate(u);
        }
        // The slope of `rain_drag_boundary`.
        self.rain_drag_rate(u, du) + self.a * du / (1.0 + (2.0 * u.max(0.0)).sqrt())
    }

    /// The closed-form part of the drag in Doran's chart, the integral of a du / (1 + w).
    #[inline(always)]
    pub fn rain_drag_boundary(&self, u: f64) -> f64 {
        let w = (2.0 * u.max(0.0)).sqrt();
        self.a * (w - w.ln_1p())
    }

    /// For light of E = 1, 1/u^2 may be integrated by parts, so that far observers are no difficulty.
    pub fn is_unit_energy(&self) -> bool {
        self.energy == 1.0 && self.mu2 == 0.0
    }

    /// Light by rain time without spin, for which E = 1.
    fn is_plain_rain(&self) -> bool {
        self.clock == Clock::Rain && self.a == 0.0 && self.mu2 == 0.0
    }

    /// d/dtau of `State::delay`: Carter's dt/dtau without what `delay_boundary` holds in closed form.
    ///
    /// dt/dtau = 1/u^2 + 2/u + a^2 N_z^2 + (4 - 2 a L u) / D with E = 1; 1/u^2 = -(u'/u)' + B u - a^2 Q u^2 and, with
    /// l = ln(u / u_observer), 1/u = (u' l)' + (K - a^2) u (1 + l) - B u^2 (2 + 3 l) + a^2 Q u^3 (1 + 2 l).
    #[inline(always)]
    pub fn delay_rate(&self, u: f64, du: f64, n_z: f64) -> f64 {
        let k = self.k;
        if self.is_plain_rain() {
            // T = t + H (`rain_offset`); a = 0, E = 1, B = K.
            let l = u.ln();
            return 3.0 * k * u + 2.0 * k * u * l - 2.0 * k * u * u * (2.0 + 3.0 * l) + 4.0 * k * u * u / (1.0 - du);
        }
        if self.clock == Clock::Rain {
            return self.rain_delay_rate(u, du, n_z);
        }
        let a2 = self.a * self.a;
        let d = self.horizon_function(u);
        let frame = self.a2e2 / self.energy * n_z * n_z;
        let frame = if self.energy == 0.0 { 0.0 } else { frame };
        let horizon = (4.0 * self.energy - 2.0 * self.a * self.angular_momentum * u) / d;
        if !self.is_unit_energy() {
            return self.energy * (1.0 / (u * u) + 2.0 / u) + frame + horizon;
        }
        // |u|: the lens table continues rays past infinity, where u ln |u| is continuous.
        let l = (u / self.u_observer).abs().max(f64::MIN_POSITIVE).ln();
        let a2q = a2 * self.carter;
        let by_parts = (k - a2) * u * (1.0 + l) - self.b * u * u * (2.0 + 3.0 * l) + a2q * u * u * u * (1.0 + 2.0 * l);
        self.b * u - a2q * u * u + 2.0 * by_parts + frame + horizon
    }

    /// d/dtau of rain time about a spinning hole, and for bodies. For light of E = 1 without what `delay_boundary` has.
    ///
    /// 1/u^2 and 1/u are integrated by parts as above, and beta / (1 + beta) as w / (1 + w), of which the integral over
    /// du / u^2 is 4 ln(1 + w) - 4 / w - 2 ln u. What 2 x / u keeps is 2 y, y = (x - 1 - u') / u, with u^2 in place of
    /// differences of nearly equal numbers.
    fn rain_delay_rate(&self, u: f64, du: f64, n_z: f64) -> f64 {
        let (a, a2, k) = (self.a, self.a * self.a, self.k);
        let w = (2.0 * u.max(0.0)).sqrt();
        let q = (1.0 + a2 * u * u).sqrt();
        if !self.is_unit_energy() {
            let (energy, momentum) = (self.energy, self.angular_momentum);
            let around = a * (momentum - a * energy * (1.0 - n_z) * (1.0 + n_z));
            let fall = self.radial_energy(u) + 2.0 * u * self.advanced_rate(u, du) + w / (q + w) * du;
            return fall / (u * u) + around;
        }
        let a2q = a2 * self.carter;
        let l = u.abs().max(f64::MIN_POSITIVE).ln();
        let by_parts = (k - a2) * u * (1.0 + l) - self.b * u * u * (2.0 + 3.0 * l) + a2q * u * u * u * (1.0 + 2.0 * l);
        let (total, d) = (self.radial_energy(u), self.horizon_function(u));
        let y = if total >= 0.0 && du <= 0.0 {
            self.b * u / (total - du) - u * (k - a2 - 2.0 * self.b * u + a2q * u * u) / (1.0 - du)
        } else {
            // (W - D + u' (1 - D)) / (D u).
            (2.0 - a * self.angular_momentum * u + du * (2.0 - a2 * u)) / d
        };
        let beside = -w * a2 * du / ((1.0 + q) * (q + w) * (1.0 + w));
        self.b * u - a2q * u * u + 2.0 * by_parts + a2 * n_z * n_z + 2.0 * y + beside
    }

    /// The closed-form part of the time integral up to (u, u').
    pub(crate) fn delay_boundary(&self, u: f64, du: f64) -> f64 {
        if self.clock == Clock::Rain && (self.is_plain_rain() || self.is_unit_energy()) {
            return 2.0 * du * u.ln() - du / u - 2.0 * (2.0 / u).sqrt() + 4.0 * (2.0 * u).sqrt().ln_1p();
        }
        if !self.is_unit_energy() {
            return 0.0;
        }
        2.0 * du * (u / self.u_observer).ln() - du / u
    }

    /// Time from the event at `there` to the observer, which the ray left as `observer`; > 0 outside the horizon.
    pub fn delay(&self, observer: &State, there: &State) -> f64 {
        self.delay_boundary(there.u, there.du) - self.delay_boundary(observer.u, observer.du) + there.delay
            - observer.delay
    }

    /// The clock's time less t at u, outside the horizon.
    pub fn clock_offset(&self, u: f64) -> f64 {
        match self.clock {
            Clock::Coordinate => 0.0,
            Clock::Rain if self.a == 0.0 => rain_offset(u, 1.0 - 2.0 * u),
            Clock::Rain => self.chart_offsets(u).time,
        }
    }

    /// The offsets of Doran's chart about a spinning hole at u, outside the horizon.
    fn chart_offsets(&self, u: f64) -> Offsets {
        match &self.offsets {
            Some(series) => series.at(u, 1.0 - self.r_plus * u),
            None => offsets(self.a, u),
        }
    }

    /// The azimuth of Boyer and Lindquist's chart, in which matter moves, at a state outside the horizon: any of those
    /// that are whole turns apart.
    pub fn matter_azimuth(&self, there: &State) -> f64 {
        let azimuth = there.n.y.atan2(there.n.x) + there.drag;
        if self.clock == Clock::Coordinate || self.a == 0.0 {
            return azimuth;
        }
        azimuth - self.chart_offsets(there.u).azimuth
    }

    /// The azimuth, rad, by which a ray turns about the axis in `tau`, to a part of a turn, whole turns included: the
    /// drag, and sqrt(K) tau for the turn of N. NaN without spin, for which no one asks, and for steep rays.
    pub fn azimuth_turned(&self, drag: f64, tau: f64) -> f64 {
        let root = self.k.max(0.0).sqrt();
        let even = self.a != 0.0 && self.angular_momentum.abs() > AROUND_AXIS * root;
        if even { drag + root * tau * self.angular_momentum.signum() } else { f64::NAN }
    }

    /// The clock's time at the observer less the t at which light left `there`, outside the horizon: matter keeps t.
    pub fn retardation(&self, observer: &State, there: &State) -> f64 {
        self.delay(observer, there) + self.clock_offset(there.u)
    }
}

impl State {
    /// The chart direction of this point from the hole: N, normalised, turned by the drag.
    pub fn chart_direction(&self) -> DVec3 {
        turned(self.n.normalize(), self.drag)
    }
}

/// `v` turned about z by `angle`.
pub fn turned(v: DVec3, angle: f64) -> DVec3 {
    let (s, c) = angle.sin_cos();
    DVec3::new(v.x * c - v.y * s, v.x * s + v.y * c, v.z)
}

/// `angle` brought into (-pi, pi].
pub fn wrap_angle(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle - TAU * ((angle - PI) / TAU).ceil();
    // Rounding can leave the bracket by one step.
    if turned <= -PI { PI } else { turned.min(PI) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays on photon orbits have none: those of Schwarzschild, and the equatorial ones of Kerr (Bardeen, Press &
    /// Teukolsky 1972), at every spin.
    #[test]
    fn critical_rays_have_no_margin() {
        let start = |u: f64, du: f64| State { u, du, n: DVec3::X, dn: DVec3::Y, drag: 0.0, delay: 0.0 };
        for b in [3.0, 5.0, 27.0_f64.sqrt(), 5.3, 9.0] {
            let light = Constants::new(0.0, 1.0, 0.6 * b, 0.64 * b * b, 1.0, 0.01);
            let margin = light.critical_margin(&start(0.01, 1.0));
            assert!((margin - (27.0 / (b * b) - 1.0).abs()).abs() < 1e-12, "{b}: {margin}");
            assert_eq!(light.critical_margin(&start(0.01, -1.0)), f64::INFINITY);
            assert_eq!(light.critical_margin(&start(0.4, 0.1)), f64::INFINITY);
        }
        for a in [-0.998, -0.5, 0.3, 0.9, 0.999_f64] {
            let r = 2.0 * (1.0 + (2.0 / 3.0 * (-a).acos()).cos());
            let l = -(r * r * r - 3.0 * r * r + a * a * (r + 1.0)) / (a * (r - 1.0));
            let margin = |l: f64| Constants::new(a, 1.0, l, 0.0, 1.0, 0.01).critical_margin(&start(0.01, 1.0));
            assert!(margin(l) < 1e-9 && margin(1.02 * l) > 1e-3 && margin(0.98 * l) > 1e-3, "{a} {}", margin(l));
        }
        let radial = Constants::new(0.0, 1.0, 0.0, 0.0, 1.0, 0.01);
        assert_eq!(radial.critical_margin(&start(0.01, 1.0)), f64::INFINITY);
    }
}
