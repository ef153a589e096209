// SPDX-License-Identifier: MIT OR Apache-2.0
//! The critical curve - the shadow's edge - on the sky of an observer outside the photon region or in the rain frame of
//! a spinning hole, as a table over the angle along it, and polar coordinates about its centre. Knows the ray's
//! constants and the local frame; integrates nothing.
//!
//! An inward ray is captured when the radial potential has no zero between the observer and the horizon. The potential
//!
//! ```text
//! P(u) = u'^2 = E^2 + (a^2 E^2 - K) u^2 + 2 B u^3 - a^2 Q u^4
//! ```
//!
//! (Carter 1968) is least at the smaller root of P'(u) / u = 0, a quadratic; the critical rays have P = P' = 0 there:
//! they wind up on a spherical photon orbit (Teo 2003). Components are (n_r, n_th, n_ph) of the local frame.

use crate::physics::geodesic::{Constants, RAIN_CLOCK_RADIUS};
use crate::physics::observer::LocalFrame;
use crate::physics::orbit::photon_orbit;
use crate::physics::shadow::{CRITICAL_IMPACT_PARAMETER, critical_direction};
use glam::{DVec3, Vec3Swizzles};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes of the table over chi in [0, 2 pi).
pub const CRITICAL_NODES: usize = 512;

/// The nearest observer, in radii of the retrograde photon orbit. No spherical photon orbit reaches farther observers,
/// so that every captured ray starts inward, and the curve stays away from the directions with n_r = 0.
pub const NEAREST_OBSERVER: f64 = 1.03;

/// Up to here, in radii of the retrograde photon orbit, the curve comes so near to the directions with n_r = 0 that the
/// margin of inward rays alone is not even across it.
const NEAR_OBSERVER: f64 = 2.0;

/// Farthest observer, in M.
pub const FARTHEST_OBSERVER: f64 = 1e5;

/// The most evaluations of the potential for one node; four to six are usual.
const MAX_EVALUATIONS: usize = 40;

/// A bound on the angle of the curve from the centre on the sky of a rain observer, rad. At 4,000 random places the
/// most from the inward radius was 2.85.
const FARTHEST_EDGE: f64 = 0.99 * PI;

/// Whether an observer at `frame` has such a curve: outside the photon region and not too far, or in the rain frame of
/// a spinning hole, from the inner horizon to where scenes leave Doran's chart.
pub fn reaches(frame: &LocalFrame) -> bool {
    if frame.rain {
        return frame.a != 0.0 && frame.r <= RAIN_CLOCK_RADIUS;
    }
    let nearest = NEAREST_OBSERVER * photon_orbit(-frame.a.abs());
    frame.r > nearest && frame.r <= FARTHEST_OBSERVER
}

/// P(u) = u'^2.
pub fn radial_potential(c: &Constants, u: f64) -> f64 {
    let quadratic = c.a2e2 - c.k + u * (2.0 * c.b - u * (c.a * c.a * c.carter));
    c.energy * c.energy + u * u * quadratic
}

/// u of the least P between infinity and the horizon: 2 a^2 Q u^2 - 3 B u + K - a^2 E^2 = 0, the smaller root, in the
/// form that holds for a^2 Q -> 0. 0 when P rises all the way, 1/r+ when it falls all the way.
pub fn potential_minimum(c: &Constants) -> f64 {
    let rise = c.k - c.a2e2;
    let b3 = 3.0 * c.b;
    let root = (b3 * b3 - 8.0 * c.a * c.a * c.carter * rise).max(0.0).sqrt();
    let horizon = 1.0 / c.r_plus;
    // B >= 0 for light: B = Q + (L - a E)^2 is Carter's other constant, Sigma^2 theta'^2 + (...)^2.
    let u = 2.0 * rise.max(0.0) / (b3 + root).max(f64::MIN_POSITIVE);
    u.min(horizon)
}

/// Above 0 an inward ray with these constants falls in, below 0 it turns; the size measures how far the ray is from the
/// critical one.
pub fn capture_margin(c: &Constants) -> f64 {
    radial_potential(c, potential_minimum(c))
}

/// The part of 1/r+ within which the least potential is at the horizon.
pub(crate) const AT_HORIZON: f64 = 1e-6;

/// The rays whose level is that of their capture margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ByMargin {
    None = 0,
    /// Rays that move inwards: observers far outside the photon region.
    Inward = 1,
    /// All rays: observers near it and within, inside the horizon too, from where rays that move outwards may turn
    /// back.
    All = 2,
}

/// Tells how far look directions are from the critical curve by their rays' constants alone, for every observer, as
/// far as a curve is known there.
#[derive(Clone, Copy, Debug)]
pub struct CurveLevel {
    pub frame: LocalFrame,
    /// Sine and cosine of psi_c, the angle of the curve from the inward radius; of 0 where no curve is known or it is
    /// no circle about that.
    pub critical: [f64; 2],
    pub by_margin: ByMargin,
}

impl CurveLevel {
    pub fn new(frame: &LocalFrame) -> Self {
        let (sin, cos) = if frame.a == 0.0 { critical_direction(frame.r, frame.rain) } else { (0.0, 1.0) };
        let by_margin = match () {
            () if frame.a == 0.0 || frame.r > FARTHEST_OBSERVER => ByMargin::None,
            () if !frame.rain && frame.r > NEAR_OBSERVER * photon_orbit(-frame.a.abs()) => ByMargin::Inward,
            () => ByMargin::All,
        };
        Self { frame: *frame, critical: [sin, cos], by_margin }
    }

    /// The level where that of all rays is that of their margin: q - u', of a ray seen at frequency 1. Rays that move
    /// inwards escape if they turn before they fall in, those that move outwards if they do not turn. P(u) less its
    /// minimum P(m) has a double zero at m, so that its root q, positive farther out than m and negative farther in, is
    /// smooth where the observer is at m itself: there the curve goes from rays that move inwards to those that move
    /// outwards. On the curve, where P(m) = 0, u' is q.
    fn within(&self, n: DVec3) -> f64 {
        let Some((c, s)) = self.frame.start(n).filter(|(c, _)| c.energy > 0.0) else { return -1.0 };
        let m = potential_minimum(&c);
        let a2q = c.a * c.a * c.carter;
        let rise = if m * c.r_plus < 1.0 - AT_HORIZON {
            // (P(u) - P(m)) / (u - m)^2, by division of the polynomials.
            let rest = c.a2e2 - c.k + m * (4.0 * c.b - 3.0 * a2q * m) + s.u * (2.0 * c.b - a2q * (s.u + 2.0 * m));
            (m - s.u).powi(2) * rest
        } else {
            s.du * s.du - radial_potential(&c, m)
        };
        (rise.max(0.0).sqrt().copysign(m - s.u) - s.du) / c.nu_local
    }

    /// 0 on the curve, positive where rays escape, and nearly even across it: psi - psi_c, or, about a spinning hole,
    /// sqrt(1 - P / E^2) - 1, which is sin psi / sin psi_c - 1 without spin. `n`: look direction (components, unit).
    pub fn at(&self, n: DVec3) -> f64 {
        if self.by_margin == ByMargin::All {
            return self.within(n);
        }
        if self.by_margin == ByMargin::Inward && n.x < 0.0 {
            let margin = self.frame.start(n).map_or(1.0, |(c, _)| capture_margin(&c) / (c.energy * c.energy));
            return (1.0 - margin).max(0.0).sqrt() - 1.0;
        }
        let (sin, cos) = (n.yz().length(), -n.x);
        let [sin_c, cos_c] = self.critical;
        (sin * cos_c - cos * sin_c).atan2(cos * cos_c + sin * sin_c)
    }
}

/// The critical curve of one observer, about its centre k: n = k cos psi + (e1 sin chi + e2 cos chi) sin psi. The curve
/// lies at psi = R(chi); R(-chi) = R(chi), as the potential knows n_th only by its square.
#[derive(Clone, Debug)]
pub struct CriticalCurve {
    pub k: DVec3,
    pub e1: DVec3,
    pub e2: DVec3,
    /// T = tan(R / 2) and dT/dchi at chi = 2 pi i / `CRITICAL_NODES`.
    nodes: Vec<[f64; 2]>,
}

/// A look direction in polar coordinates about the centre of the curve.
#[derive(Clone, Copy, Debug)]
pub struct Polar {
    /// cos psi and sin psi >= 0.
    pub cos: f64,
    pub sin: f64,
    /// In (-pi, pi].
    pub chi: f64,
    pub sin_chi: f64,
    pub cos_chi: f64,
    /// Unit tangent d n / d psi.
    pub outward: DVec3,
    /// Unit tangent along growing chi.
    pub along: DVec3,
}

impl CriticalCurve {
    /// `None` for an observer that has none here (`reaches`).
    pub fn new(frame: &LocalFrame) -> Option<Self> {
        if !reaches(frame) {
            return None;
        }
        let mut curve = Self::centred(frame);
        let half: Vec<f64> = curve.half(frame);
        let last = CRITICAL_NODES as isize;
        let mirrored = |i: isize| half[i.rem_euclid(last).min((-i).rem_euclid(last)) as usize];
        curve.nodes = (0..last).map(|i| [mirrored(i), periodic_slope(&mirrored, i)]).collect();
        Some(curve)
    }

    /// Basis only: the centre is the middle of the curve's two points with n_th = 0.
    fn centred(frame: &LocalFrame) -> Self {
        let plain = |e2| Self { k: DVec3::NEG_X, e1: DVec3::Y, e2, nodes: Vec::new() };
        // Spin 0: sin R = b_c lapse / r (Synge 1966). Rain observers have no lapse.
        let sin = if frame.rain { 0.9 } else { (CRITICAL_IMPACT_PARAMETER * frame.lapse / frame.r).min(0.9) };
        let guess = sin / (1.0 + ((1.0 - sin) * (1.0 + sin)).sqrt());
        let radius = |side| 2.0 * plain(side).critical_tangent(frame, 0.0, guess).atan();
        let tilt = 0.5 * (radius(DVec3::Z) - radius(DVec3::NEG_Z));
        let (sin, cos) = tilt.sin_cos();
        Self { k: DVec3::new(-cos, 0.0, sin), e2: DVec3::new(sin, 0.0, cos), ..plain(DVec3::Z) }
    }

    /// T at chi = 0 .. pi, each from the two before.
    fn half(&self, frame: &LocalFrame) -> Vec<f64> {
        let mut found = Vec::with_capacity(CRITICAL_NODES / 2 + 1);
        let mut guess = (0.5 * CRITICAL_IMPACT_PARAMETER / frame.r).min(0.5);
        for i in 0..=CRITICAL_NODES / 2 {
            let t = self.critical_tangent(frame, TAU * i as f64 / CRITICAL_NODES as f64, guess);
            // The next by linear extrapolation; the curve is smooth.
            guess = found.last().map_or(t, |before| 2.0 * t - before);
            found.push(t);
        }
        found
    }

    /// tan(R / 2) at `chi`: the zero of the capture margin, or, for rain observers, who see light that has come inwards
    /// and turned as well, of the level; by the secant method inside a bracket.
    fn critical_tangent(&self, frame: &LocalFrame, chi: f64, guess: f64) -> f64 {
        let level = frame.rain.then(|| CurveLevel::new(frame));
        let margin = |t: f64| {
            let n = self.direction_by_tangent(t, chi);
            match &level {
                Some(level) => -level.at(n),
                None => frame.start(n).map_or(1.0, |(c, _)| capture_margin(&c)),
            }
        };
        // Captured at the centre; not beyond n_r = 0, unless by rain observers: k cos psi + e sin psi has no radial
        // part there.
        let psi = (-self.k.x).atan2(self.e2.x * chi.cos());
        let farthest = if frame.rain { FARTHEST_EDGE } else { psi.min(FRAC_PI_2 * 1.9) };
        let (mut low, mut high) = (0.0, (0.5 * farthest).tan());
        let mut t = guess.min(0.999 * high);
        let mut value = margin(t);
        // The margin is nearly 1 - (t / T)^2: a first step from its value alone, long enough to learn the slope.
        let mut next = t * (1.0 + (0.5 * value).abs().clamp(1e-5, 0.3).copysign(value));
        for _ in 1..MAX_EVALUATIONS {
            if value > 0.0 {
                low = t
            } else {
                high = t
            }
            let slack = 1e-7 * t;
            // A root that rounding puts beside the bracket's end is in it.
            if !(next > low - slack && next < high + slack) {
                next = 0.5 * (low + high);
            }
            // The secant method's next error is about this step times the one before: below rounding.
            if (next - t).abs() <= slack {
                return next;
            }
            let new_value = margin(next);
            let secant = next - new_value * (next - t) / (new_value - value);
            (t, value, next) = (next, new_value, if secant.is_finite() { secant } else { 0.5 * (low + high) });
        }
        t
    }

    /// T = tan(R / 2) and dT/dchi, by cubic Hermite interpolation; `chi` any angle.
    pub fn at(&self, chi: f64) -> (f64, f64) {
        let h = TAU / CRITICAL_NODES as f64;
        let turns = chi / TAU;
        let position = (turns - turns.floor()) * CRITICAL_NODES as f64;
        let index = (position as usize).min(CRITICAL_NODES - 1);
        let x = position - index as f64;
        let [y0, d0] = self.nodes[index];
        let [y1, d1] = self.nodes[(index + 1) % CRITICAL_NODES];
        let rise = y1 - y0;
        let (c2, c3) = (3.0 * rise - h * (2.0 * d0 + d1), h * (d0 + d1) - 2.0 * rise);
        (y0 + x * (h * d0 + x * (c2 + x * c3)), d0 + x * (2.0 * c2 + x * 3.0 * c3) / h)
    }

    /// Least and greatest T in the table.
    pub fn tangent_range(&self) -> [f64; 2] {
        self.nodes.iter().fold([f64::INFINITY, 0.0], |[low, high], [t, _]| [t.min(low), t.max(high)])
    }

    /// The look direction at (psi, chi).
    pub fn direction(&self, psi: f64, chi: f64) -> DVec3 {
        let (sin, cos) = psi.sin_cos();
        self.k * cos + self.radial(chi) * sin
    }

    /// The look direction at (psi, chi), where `t` = tan(psi / 2).
    fn direction_by_tangent(&self, t: f64, chi: f64) -> DVec3 {
        let inverse = 1.0 / (1.0 + t * t);
        self.k * ((1.0 - t * t) * inverse) + self.radial(chi) * (2.0 * t * inverse)
    }

    /// Unit vector from the centre towards `chi`, at right angles to k.
    pub(super) fn radial(&self, chi: f64) -> DVec3 {
        let (sin, cos) = chi.sin_cos();
        self.e1 * sin + self.e2 * cos
    }

    /// Polar coordinates of the unit vector `n`; sin psi comes from components, not from cos psi.
    pub fn polar(&self, n: DVec3) -> Polar {
        let (x, y, cos) = (n.dot(self.e2), n.dot(self.e1), n.dot(self.k));
        let sin = (x * x + y * y).sqrt();
        let (s, c) = if sin > 0.0 { (y / sin, x / sin) } else { (0.0, 1.0) };
        Polar {
            cos,
            sin,
            chi: s.atan2(c),
            sin_chi: s,
            cos_chi: c,
            outward: (self.e1 * s + self.e2 * c) * cos - self.k * sin,
            along: self.e1 * c - self.e2 * s,
        }
    }
}

/// Derivative by chi of a function sampled at the nodes: central differences of sixth order.
fn periodic_slope(f: &impl Fn(isize) -> f64, i: isize) -> f64 {
    let pair = |d: isize| f(i + d) - f(i - d);
    (45.0 * pair(1) - 9.0 * pair(2) + pair(3)) * (CRITICAL_NODES as f64 / (60.0 * TAU))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::metric::chart;
    use crate::physics::orbit::horizon_inner;
    use crate::physics::trace::{Fate, Settings, trace, trace_look};
    use crate::random::mix;

    fn frame(a: f64, r: f64, theta: f64) -> LocalFrame {
        LocalFrame::new(a, chart(r, theta, 0.4)).unwrap()
    }

    const OBSERVERS: [(f64, f64, f64); 9] = [
        (0.998, 4.2, 1.5),
        (0.998, 1000.0, std::f64::consts::FRAC_PI_2),
        (-0.9, 10.0, 1.2),
        (0.9999, 30.0, 0.0),
        (0.1, 6.0, 2.9),
        (-0.998, 4.5, 1.6),
        (0.7, 1e5, 0.8),
        (-0.5, 25.0, std::f64::consts::PI),
        (0.95, 8.0, 0.3),
    ];

    /// The tabulated curve against the root of the margin between nodes.
    #[test]
    fn interpolation_meets_the_root() {
        for (a, r, theta) in OBSERVERS {
            let frame = frame(a, r, theta);
            let curve = CriticalCurve::new(&frame).unwrap();
            let mut worst = 0.0_f64;
            let mut worst_slope = 0.0_f64;
            for i in 0..777 {
                let chi = TAU * (f64::from(i) + 0.37) / 777.0;
                let (t, slope) = curve.at(chi);
                let truth = curve.critical_tangent(&frame, chi, t);
                worst = worst.max((t / truth - 1.0).abs());
                let d = 1e-5;
                let rise = curve.critical_tangent(&frame, chi + d, t) - curve.critical_tangent(&frame, chi - d, t);
                worst_slope = worst_slope.max((slope - rise / (2.0 * d)).abs() / truth);
            }
            assert!(worst < 1e-8 && worst_slope < 1e-5, "a {a} r {r}: {worst:.1e} {worst_slope:.1e}");
        }
    }

    /// Just inside rays fall in, just outside they escape, by integration.
    #[test]
    fn rays_beside_the_curve_have_the_fates_it_says() {
        for (a, r, theta) in OBSERVERS {
            let frame = frame(a, r, theta);
            let curve = CriticalCurve::new(&frame).unwrap();
            for i in 0..24 {
                let chi = TAU * (f64::from(i) + 0.5) / 24.0;
                let psi = 2.0 * curve.at(chi).0.atan();
                for (factor, fate) in [(1.0 - 3e-5, Fate::Captured), (1.0 + 3e-5, Fate::Escaped)] {
                    let (c, start) = frame.start(curve.direction(psi * factor, chi)).unwrap();
                    let traced = trace(&c, &start, &Settings { delay: false, ..Settings::exact(a) });
                    assert_eq!(traced.fate, fate, "a {a} r {r} theta {theta} chi {chi} factor {factor}");
                }
            }
        }
    }

    /// The level is 0 on the curve and grows outwards; but for the fastest holes it tells small distances from the
    /// curve in proportion.
    #[test]
    fn levels_are_distances_from_the_curve() {
        for (a, r, theta) in OBSERVERS.into_iter().chain([(0.0, 7.0, 1.2)]) {
            let frame = frame(a, r, theta);
            let (curve, level) = (CriticalCurve::new(&frame).unwrap(), CurveLevel::new(&frame));
            for i in 0..12 {
                let chi = TAU * (f64::from(i) + 0.5) / 12.0;
                let psi = 2.0 * curve.at(chi).0.atan();
                let at = |part: f64| level.at(curve.direction(psi * (1.0 + part), chi));
                let slope = 0.5 * (at(1e-3) - at(-1e-3)) / 1e-3;
                assert!(slope > 0.0 && at(0.0).abs() < 1e-6 * slope, "a {a} r {r} chi {chi}: {} {slope}", at(0.0));
                for part in [-0.05, 0.02, 0.05] {
                    let even = (at(part) / (slope * part) - 1.0).abs() < 0.25;
                    assert!(even || (a.abs() > 0.99 && at(part) * part > 0.0), "a {a} r {r} chi {chi} {part}");
                }
            }
        }
    }

    /// Observers in the photon region, where the curve goes from rays that move inwards to those that move outwards,
    /// and inside the horizon: rays on both sides have the fates that the level says, and it is even across the curve.
    #[test]
    fn levels_are_even_within_the_photon_region() {
        let mut found = 0;
        for (a, r, rain) in [
            (1e-9, 3.0, false),
            (0.3, 2.4, false),
            (0.9, 3.0, false),
            (0.5, 3.6, false),
            (0.9, 1.9, true),
            (0.9, 1.2, true),
        ] {
            let place = chart(r, 1.1, 0.4);
            let frame = if rain { LocalFrame::rain(a, place).unwrap() } else { LocalFrame::new(a, place).unwrap() };
            let level = CurveLevel::new(&frame);
            for i in 0..24 {
                let across =
                    DVec3::Y * (TAU * f64::from(i) / 24.0).cos() + DVec3::Z * (TAU * f64::from(i) / 24.0).sin();
                let direction = |psi: f64| DVec3::NEG_X * psi.cos() + across * psi.sin();
                let (mut low, mut high) = (0.0, 3.1);
                if level.at(direction(high)) < 0.0 || level.at(direction(low)) > 0.0 {
                    continue;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    *(if level.at(direction(middle)) > 0.0 { &mut high } else { &mut low }) = middle;
                }
                for (part, fate) in [(-1e-4, Fate::Captured), (1e-4, Fate::Escaped)] {
                    let (c, start) = frame.start(direction(low + part)).unwrap();
                    let traced = trace(&c, &start, &Settings { delay: false, ..Settings::exact(a) });
                    assert_eq!(traced.fate, fate, "a {a} r {r} {i} {part}");
                }
                let at = |part: f64| level.at(direction(low + part));
                let slope = 0.5 * (at(1e-3) - at(-1e-3)) / 1e-3;
                for part in [-0.03, 0.03] {
                    let even = (at(part) / (slope * part) - 1.0).abs();
                    assert!(slope > 0.1 && even < 0.3, "a {a} r {r} {i}, {part}: {} {slope}", at(part));
                }
                found += 1;
            }
        }
        assert!(found > 120, "{found}");
    }

    /// Rain observers at random places from the inner horizon to where scenes leave Doran's chart: the interpolated
    /// curve is where the level changes its sign, and encloses the dark directions alone. Rays of every eighth observer
    /// are traced beside it.
    #[test]
    fn rain_observers_have_a_curve() {
        let mut seed = 5;
        let mut share = || {
            seed += 1;
            f64::from(mix(seed)) / 4_294_967_296.0
        };
        for i in 0..400 {
            let spin = [0.9, 0.998, 0.9999, share(), 1e-3 * share()][i % 5];
            let a = if share() < 0.5 { spin } else { -spin };
            let inner = horizon_inner(a);
            let r = (inner * (1.0 + 1e-6) + (RAIN_CLOCK_RADIUS - inner) * share() * share()).max(1e-3);
            let frame = LocalFrame::rain(a, chart(r, PI * share(), 0.4)).unwrap();
            let (curve, level) = (CriticalCurve::new(&frame).unwrap(), CurveLevel::new(&frame));
            for _ in 0..12 {
                let chi = TAU * share();
                let psi = 2.0 * curve.at(chi).0.atan();
                // A tenth of the angle from the curve within which rays are integrated: beside the horizon of the
                // fastest holes it has corners.
                let step = 1e-4 * psi.min(PI - psi);
                let at = |psi: f64| level.at(curve.direction(psi, chi));
                assert!(at(psi - step) < 0.0 && at(psi + step) > 0.0, "a {a} r {r} chi {chi} psi {psi}");
                for (part, fate) in [(-3.0, Fate::Captured), (3.0, Fate::Escaped)] {
                    let look = curve.direction(psi + part * step, chi);
                    let settings = Settings { delay: false, ..Settings::exact(a) };
                    let traced = || trace_look(&frame, look, &settings).1.fate;
                    assert!(i % 8 != 0 || traced() == fate, "a {a} r {r} chi {chi} {part}: not {fate:?}");
                }
                for _ in 0..4 {
                    let (dark, bright) = (share() * (psi - step), psi + step + share() * (PI - psi - step));
                    assert!(at(dark) < 0.0, "a {a} r {r} chi {chi}: bright at {dark}, within {psi}");
                    assert!(at(bright) > 0.0, "a {a} r {r} chi {chi}: dark at {bright}, beyond {psi}");
                }
            }
        }
    }

    /// Without spin also inside the photon sphere and the horizon.
    #[test]
    fn levels_without_spin_are_angles() {
        for (r, rain) in [(2.5, false), (3.0, false), (1.2, true), (8.0, true)] {
            let frame = LocalFrame::new(0.0, chart(r, 1.0, 0.4)).unwrap();
            let frame = if rain { frame.to_rain() } else { frame };
            let (sin, cos) = critical_direction(r, rain);
            let psi = sin.atan2(cos) + 0.1;
            let level = CurveLevel::new(&frame).at(DVec3::new(-psi.cos(), 0.6 * psi.sin(), 0.8 * psi.sin()));
            assert!((level - 0.1).abs() < 1e-12, "r {r}: {level}");
        }
    }

    /// Spin 0: Synge's circle about -e_r.
    #[test]
    fn without_spin_the_curve_is_synges_circle() {
        for r in [3.2, 6.0, 50.0, 1e4] {
            let frame = frame(0.0, r, 1.0);
            let curve = CriticalCurve::new(&frame).unwrap();
            let shadow = crate::physics::shadow::shadow(&crate::physics::observer::Observer::at_rest(frame));
            assert!((curve.k - shadow.center).length() < 1e-9);
            for chi in [0.0, 1.0, 4.0] {
                let radius = 2.0 * curve.at(chi).0.atan();
                assert!((radius / shadow.radius - 1.0).abs() < 1e-10, "r {r}: {radius} {}", shadow.radius);
            }
        }
    }

    #[test]
    fn polar_undoes_direction() {
        let curve = CriticalCurve::new(&frame(0.9, 12.0, 1.1)).unwrap();
        for (psi, chi) in [(0.3, 0.2), (1e-6, -3.0), (3.1, 1.5)] {
            let p = curve.polar(curve.direction(psi, chi));
            assert!((p.sin.atan2(p.cos) - psi).abs() < 1e-12 && (p.chi - chi).abs() < 1e-9, "{p:?}");
            let d = (curve.direction(psi + 1e-6, chi) - curve.direction(psi - 1e-6, chi)) / 2e-6;
            assert!((p.outward - d).length() < 1e-8);
        }
    }

    #[test]
    fn observers_in_the_photon_region_have_no_curve() {
        for (a, r) in [(0.998, 4.0), (0.5, 2.5), (-0.5, 3.5), (0.5, 2e5)] {
            assert!(CriticalCurve::new(&frame(a, r, 1.0)).is_none());
        }
    }
}
