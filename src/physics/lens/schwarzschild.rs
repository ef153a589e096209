// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light rays of one observer at spin 0, integrated one by one (`Family::column`), as a lens table holds them.
//! Each ray is independent of the others. Knows neither threads nor how the tables are interpolated.
//!
//! In the ray's plane, with phi the angle swept from the observer and primes for d/dphi: u'' = -u + 3 u^2, u = 1/r. The
//! observer is at u_e, the ray leaves it at the angle psi from the inward radius: u' = f u_e (cos psi - beta) / sin
//! psi, with f = sqrt(1 - 2 u_e), beta = 0 for the static frame and f = 1, beta = sqrt(2 u_e) for the rain frame.
//! Integrated is the deviation v = u - u_s from the critical ray, which is known in closed form (Darwin 1959, tanh^2
//! being written out):
//!
//! ```text
//! u_s = -1/6 + ((1 - e) / (1 + e))^2 / 2,   e = e_0 exp(-phi),   e_0 = 2 (1/3 - u_e) / (1 + sqrt(2 u_e + 1/3))^2
//! v'' = v (6 u_s - 1 + 3 v),   v(0) = 0,
//! v'(0) = -2 f u_e sin(d/2) (cos(d/2) - beta cos((psi + psi_c)/2)) / (sin psi sin psi_c),   d = psi - psi_c
//! ```
//!
//! No nearly equal numbers are subtracted, so rays as near the critical one as one likes come out right, in f32 too.
//! e_0 > 0, = 0, < 0 for observers outside, on, inside the photon sphere. Rays that pass far from it, u << 1/3, would
//! lose by the subtraction: for them v = u, the same equation with u_s = 0. The tables hold v: beside the critical ray
//! it is small where u is well conditioned, so that few points suffice however long the ray winds.
//!
//! The parameter is sigma, phi = kappa sigma, kappa = g sin psi with g = min(1 / |sin psi|, r / (3 f)): nothing is
//! singular for radial rays, and past the poles of the sky (sin psi < 0) all goes on smoothly: u and sigma evenly, phi
//! oddly.

use super::coordinate::{Angle, Coordinate, LEAST_OCTAVE, LENS};
use crate::allocate::{collected, with_room};
use crate::error::Result;
use crate::physics::geodesic::{Clock, Constants, RAIN_CLOCK_RADIUS, rain_offset};
use crate::physics::integrator::{B, D, Quintic};
use crate::physics::observer::LocalFrame;
use crate::physics::quadrature::gauss_legendre;
use crate::physics::shadow::critical_direction;
use std::ops::RangeInclusive;

/// Observers served, in M.
pub const RADII: RangeInclusive<f64> = 0.9..=1e6;
/// Static observers stay this far from the horizon.
pub const LEAST_STATIC_RADIUS: f64 = 2.0005;
/// Captured rays end at this u, inside 6 M, where no thin disk reaches.
pub const CAPTURE_U: f64 = 0.25;
/// Captured rays are of use to observers outside this radius only: those of nearer observers start inside it and move
/// inwards.
const LEAST_CAPTURE_RADIUS: f64 = 6.0;
/// Escaping rays from |t_hat| = 2^-2 on have v = u; the ray there is in the table in both ways.
const FREE_OCTAVE: f64 = -2.0;
/// Steps to the end of a ray before it is given up; one near the critical ray takes some 20 / `Resolution::step`.
const MOST_STEPS: u32 = 10_000;

/// How finely a table is made. Errors go with the fourth power of the spacings and the fifth of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Rays per octave of distance from the critical direction, at least 1.
    pub nodes_per_octave: u32,
    /// Intervals along a ray from the observer to its end, at least 1.
    pub intervals: u32,
    /// Largest step in sigma, > 0.
    pub step: f64,
}

impl Resolution {
    /// The CPU tracer's, as fine as f32 resolves: errors over (1 + conditioning) below 4e-7 in the swept angle and 1e-7
    /// in u.
    pub const SINGLE: Self = Self { nodes_per_octave: 8, intervals: 32, step: 0.2 };
}

/// The two kinds of rays, on either side of the critical one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Rays that escape, psi > psi_c; end: u = 0.
    Escaping,
    /// Captured rays, psi < psi_c, of observers outside 6 M; end: u = `CAPTURE_U`.
    Captured,
}

/// All rays of one observer.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    pub r: f64,
    pub u_observer: f64,
    pub rain: bool,
    pub with_delay: bool,
    pub resolution: Resolution,
    pub coordinate: Coordinate,
    /// f and beta of the frame.
    f: f64,
    beta: f64,
    /// e at the observer.
    e_observer: f64,
}

/// The part of a table that holds one ray. x is the node coordinate along the branch, y = phi / swept in [0, 1].
#[derive(Clone, Debug)]
pub struct Column {
    /// The angle swept to the ray's end, and its slope by x; odd about the poles of the sky.
    pub swept: [f64; 2],
    /// v, v_x, v_y, v_xy at `intervals` + 1 even steps of y; `Family::reference` leads to u.
    pub v: Vec<[f64; 4]>,
    /// J and J_y there, the integral part of the delay (`Family::delay`); empty unless asked for.
    pub delay: Vec<[f64; 2]>,
}

/// The constants of one ray.
#[derive(Clone, Copy, Debug)]
struct Ray {
    kappa: f64,
    /// d kappa / dx at constant g.
    kappa_x: f64,
    /// 1 where v is the deviation from the critical ray, 0 where v = u.
    reference: f64,
    /// v and dv / d sigma at the observer, and the derivative of du / d sigma by x.
    v: f64,
    slope: f64,
    slope_x: f64,
    /// d sigma / d tau, tau the Mino time of `geodesic`.
    per_tau: f64,
    /// Impact parameter; < 0 past a pole of the sky.
    b: f64,
}

/// A point of a ray, and the variation w = du/dx at fixed sigma; slopes are by sigma.
#[derive(Clone, Copy, Debug)]
struct Point {
    e: f64,
    v: f64,
    dv: f64,
    w: f64,
    dw: f64,
}

/// A step of Nystrom's method in sigma, and the factors exp(-kappa h c) that take e to the nodes 1/5, 2/3 and 1.
#[derive(Clone, Copy, Debug)]
struct Step {
    h: f64,
    decay: [f64; 3],
}

/// u of the critical ray: -1/6 + Q^2 / 2, Q = (1 - e) / (1 + e).
pub(crate) fn separatrix(e: f64) -> f64 {
    let q = (1.0 - e) / (1.0 + e);
    0.5 * q * q - 1.0 / 6.0
}

/// du_s / dphi = Q Q' = 2 e (1 - e) / (1 + e)^3.
fn separatrix_slope(e: f64) -> f64 {
    let p = 1.0 + e;
    2.0 * e * (1.0 - e) / (p * p * p)
}

impl Step {
    fn new(ray: &Ray, h: f64) -> Self {
        Self { h, decay: [0.2, 2.0 / 3.0, 1.0].map(|c| (-ray.kappa * h * c).exp()) }
    }
}

impl Point {
    fn u(&self, ray: &Ray) -> f64 {
        ray.reference * separatrix(self.e) + self.v
    }

    fn du(&self, ray: &Ray) -> f64 {
        ray.kappa * ray.reference * separatrix_slope(self.e) + self.dv
    }
}

impl Ray {
    /// v'' and w'' by sigma: kappa^2 v (6 u_s - 1 + 3 v); kappa^2 w (6 u - 1) + 2 kappa kappa_x u (3 u - 1), the
    /// latter because w is taken at fixed sigma and not at fixed phi, where it is singular for radial rays.
    fn accelerations(&self, e: f64, v: f64, w: f64) -> [f64; 2] {
        let u_s = self.reference * separatrix(e);
        let u = u_s + v;
        let k2 = self.kappa * self.kappa;
        let source = 2.0 * self.kappa * self.kappa_x * u * (3.0 * u - 1.0);
        [k2 * v * (6.0 * u_s - 1.0 + 3.0 * v), k2 * w * (6.0 * u - 1.0) + source]
    }

    /// u'' by sigma.
    fn curvature(&self, u: f64) -> f64 {
        self.kappa * self.kappa * u * (3.0 * u - 1.0)
    }

    /// Nystrom's method of order 5 (`integrator::nystrom_step`), where f depends on sigma through e.
    fn step(&self, p: &Point, s: &Step) -> Point {
        let (h, h2) = (s.h, s.h * s.h);
        let e = s.decay.map(|factor| p.e * factor);
        let ahead = |c: f64| [p.v + c * h * p.dv, p.w + c * h * p.dw];
        let f1 = self.accelerations(p.e, p.v, p.w);
        let [v, w] = ahead(0.2);
        let f2 = self.accelerations(e[0], v + h2 / 50.0 * f1[0], w + h2 / 50.0 * f1[1]);
        let [v, w] = ahead(2.0 / 3.0);
        let third = |i: usize| h2 / 27.0 * (7.0 * f2[i] - f1[i]);
        let f3 = self.accelerations(e[1], v + third(0), w + third(1));
        let [v, w] = ahead(1.0);
        let fourth = |i: usize| h2 * (0.3 * f1[i] - 2.0 / 35.0 * f2[i] + 9.0 / 35.0 * f3[i]);
        let f4 = self.accelerations(e[2], v + fourth(0), w + fourth(1));
        let rise = |i: usize| h2 * (B[0] * f1[i] + B[1] * f2[i] + B[2] * f3[i]);
        let slope = |i: usize| h * (D[0] * f1[i] + D[1] * f2[i] + D[2] * f3[i] + D[3] * f4[i]);
        Point { e: e[2], v: v + rise(0), w: w + rise(1), dv: p.dv + slope(0), dw: p.dw + slope(1) }
    }

    /// sigma from the observer to where u = `end`. `None`: not within `MOST_STEPS`.
    fn length(&self, start: Point, end: f64, h: f64) -> Option<f64> {
        let step = Step::new(self, h);
        let side = start.u(self) > end;
        let mut point = start;
        for count in 0..MOST_STEPS {
            let next = self.step(&point, &step);
            let u = next.u(self);
            if !u.is_finite() {
                return None;
            }
            if (u > end) != side {
                return Some(
                    f64::from(count) * h + self.land(&point, end, h * (point.u(self) - end) / (point.u(self) - u)),
                );
            }
            point = next;
        }
        None
    }

    /// The step from `from` to where u = `end`, by Newton's method with the integrator itself.
    fn land(&self, from: &Point, end: f64, guess: f64) -> f64 {
        (0..4).fold(guess, |h, _| {
            let point = self.step(from, &Step::new(self, h));
            h - (point.u(self) - end) / point.du(self)
        })
    }
}

impl Family {
    /// `None`: spin, or an observer outside `RADII`, or a static one nearer than `LEAST_STATIC_RADIUS`.
    pub fn new(frame: &LocalFrame, with_delay: bool, resolution: Resolution) -> Option<Self> {
        let (r, rain) = (frame.r, frame.rain);
        let served = RADII.contains(&r) && (rain || r >= LEAST_STATIC_RADIUS);
        let valid = resolution.nodes_per_octave > 0 && resolution.intervals > 0 && resolution.step > 0.0;
        if frame.a != 0.0 || !served || !valid {
            return None;
        }
        let u_observer = 1.0 / r;
        let (f, beta) = if rain { (1.0, (2.0 * u_observer).sqrt()) } else { (((r - 2.0) / r).sqrt(), 0.0) };
        let (sin, cos) = critical_direction(r, rain);
        let q = (2.0 * u_observer + 1.0 / 3.0).sqrt();
        Some(Self {
            r,
            u_observer,
            rain,
            with_delay,
            resolution,
            coordinate: Coordinate::new(sin, cos, resolution.nodes_per_octave),
            f,
            beta,
            // 1/3 - u_e = (r - 3) / (3 r)
            e_observer: 2.0 * (r - 3.0) / (3.0 * r * (1.0 + q).powi(2)),
        })
    }

    /// Number of columns of a branch; 0 where the branch is of no use.
    pub fn columns(&self, branch: Branch) -> usize {
        match branch {
            Branch::Escaping => self.coordinate.nodes(true) + 1,
            Branch::Captured if self.r > LEAST_CAPTURE_RADIUS => self.coordinate.nodes(false),
            Branch::Captured => 0,
        }
    }

    /// The columns of a branch with v = u start here, with the same ray as the one before.
    pub fn first_free_column(&self, branch: Branch) -> usize {
        match branch {
            Branch::Escaping => (self.coordinate.nodes_per_octave * (FREE_OCTAVE - LEAST_OCTAVE)) as usize + 1,
            Branch::Captured => usize::MAX,
        }
    }

    /// u - v and its derivative by phi.
    pub fn reference(&self, phi: f64) -> (f64, f64) {
        let e = self.e_observer * (-phi).exp();
        (separatrix(e), separatrix_slope(e))
    }

    /// Integrates the ray of one column: once to its end, then again in even steps of y. `None`: it does not end.
    /// Errors: OUT_OF_MEMORY.
    pub fn column(&self, branch: Branch, index: usize) -> Result<Option<Column>> {
        let (sign, end) = match branch {
            Branch::Escaping => (1.0, 0.0),
            Branch::Captured => (-1.0, CAPTURE_U),
        };
        let free = index >= self.first_free_column(branch);
        let node = if free { index - 1 } else { index };
        let ray = self.ray(&self.coordinate.angle(sign * self.coordinate.t_hat_at(node as f64)), free);
        let start = Point { e: self.e_observer, v: ray.v, dv: ray.slope, w: 0.0, dw: ray.slope_x };
        let Some(length) = ray.length(start, end, self.resolution.step) else { return Ok(None) };
        let points = self.points(&ray, start, length)?;
        let Some(last) = points.last() else { return Ok(None) };
        // The slope of length(x) follows from u(length(x); x) = end.
        let length_x = -last.w / last.du(&ray);
        Ok(Some(Column {
            swept: [ray.kappa * length, ray.kappa_x * length + ray.kappa * length_x],
            v: self.row(&ray, &points, length, length_x)?,
            delay: if self.with_delay { self.delay_row(&ray, &points, length)? } else { Vec::new() },
        }))
    }

    /// `free`: v = u.
    fn ray(&self, angle: &Angle, free: bool) -> Ray {
        let (f, u_observer, beta) = (self.f, self.u_observer, self.beta);
        let g = (1.0 / angle.sin.abs().max(f64::MIN_POSITIVE)).min(self.r / (3.0 * f));
        let psi_x = self.coordinate.psi_slope(angle.tan_half);
        let inverse_b = f * u_observer * (1.0 - beta * angle.cos);
        let off = angle.sin_half * (angle.cos_half - beta * angle.cos_mean);
        let off = -2.0 * off / self.coordinate.sin_critical;
        Ray {
            kappa: g * angle.sin,
            kappa_x: g * angle.cos * psi_x,
            reference: if free { 0.0 } else { 1.0 },
            v: if free { u_observer } else { 0.0 },
            slope: g * f * u_observer * if free { angle.cos - beta } else { off },
            slope_x: -g * f * u_observer * angle.sin * psi_x,
            per_tau: 1.0 / (g * inverse_b),
            b: angle.sin / inverse_b,
        }
    }

    /// The points at even steps of y, substeps being taken where these exceed the resolution's step.
    fn points(&self, ray: &Ray, start: Point, length: f64) -> Result<Vec<Point>> {
        let interval = length / f64::from(self.resolution.intervals);
        let substeps = (interval / self.resolution.step).ceil().max(1.0) as u32;
        let step = Step::new(ray, interval / f64::from(substeps));
        let mut points = with_room(self.resolution.intervals as usize + 1, LENS)?;
        points.push(start);
        let mut point = start;
        for _ in 0..self.resolution.intervals {
            point = (0..substeps).fold(point, |p, _| ray.step(&p, &step));
            points.push(point);
        }
        Ok(points)
    }

    /// v(x, y) = V(y length(x); x) with its derivatives. w being dU/dx at fixed sigma, that of V is w - u_s' kappa_x
    /// sigma.
    fn row(&self, ray: &Ray, points: &[Point], length: f64, length_x: f64) -> Result<Vec<[f64; 4]>> {
        let values = points.iter().enumerate().map(|(i, p)| {
            let y = i as f64 / f64::from(self.resolution.intervals);
            let curvature = ray.accelerations(p.e, p.v, p.w)[0];
            let u_s = separatrix(p.e);
            let (slope_s, curvature_s) =
                (ray.reference * separatrix_slope(p.e), ray.reference * u_s * (3.0 * u_s - 1.0));
            let phi_x = ray.kappa_x * length;
            let v_x = p.w + y * (p.dv * length_x - slope_s * phi_x);
            let v_xy = length * (p.dw + y * curvature * length_x) + p.dv * length_x
                - phi_x * (slope_s + y * curvature_s * ray.kappa * length);
            [p.v, v_x, length * p.dv, v_xy]
        });
        collected(values, LENS)
    }

    /// J and J_y: Gauss-Legendre on the dense output, as one form of the rate needs u'.
    fn delay_row(&self, ray: &Ray, points: &[Point], length: f64) -> Result<Vec<[f64; 2]>> {
        let constants = self.constants(ray.b);
        let scale = length / ray.per_tau;
        // The last u is 0 but for rounding.
        let rate = |u: f64, du: f64| scale * constants.delay_rate(u.max(f64::MIN_POSITIVE), du * ray.per_tau, 0.0);
        let dy = 1.0 / f64::from(self.resolution.intervals);
        let h = length * dy;
        let mut row = with_room(points.len(), LENS)?;
        let mut sum = 0.0;
        let mut before: Option<&Point> = None;
        for p in points {
            let (u, du) = (p.u(ray), p.du(ray));
            if let Some(q) = before {
                let (u0, du0) = (q.u(ray), q.du(ray));
                let dense = Quintic::new(u0, du0, ray.curvature(u0), u, du, ray.curvature(u), h);
                let rate_at = |x: f64| {
                    let (u, du) = dense.at(x);
                    rate(u, du)
                };
                sum += dy * gauss_legendre(rate_at);
            }
            row.push([sum, rate(u, du)]);
            before = Some(p);
        }
        Ok(row)
    }

    /// Impact parameter at E = 1 of the direction (sin psi, cos psi): b = sin psi / (f u_e (1 - beta cos psi)).
    pub fn impact_parameter(&self, sin: f64, cos: f64) -> f64 {
        sin / (self.f * self.u_observer * (1.0 - self.beta * cos))
    }

    /// The ray's constants, with the clock in whose form the delay is integrated: rain time where all rays move
    /// outwards, as it has no singularity at the horizon, near or far.
    fn constants(&self, b: f64) -> Constants {
        let mut constants = Constants::new(0.0, 1.0, b, 0.0, 1.0, self.u_observer);
        if self.r <= RAIN_CLOCK_RADIUS {
            constants.clock = Clock::Rain;
        }
        constants
    }

    /// `Constants::retardation` by the observer's clock (`LocalFrame::clock`) at the crossing `u` of the ray of impact
    /// parameter `b`, from the integral part J there. The slopes are du/dtau = b du/dphi, at the observer and there.
    pub fn delay(&self, b: f64, observer_slope: f64, u: f64, slope: f64, integral: f64) -> f64 {
        let constants = self.constants(b);
        let rise =
            constants.delay_boundary(u, slope) - constants.delay_boundary(self.u_observer, observer_slope) + integral;
        let retardation = rise + constants.clock_offset(u);
        if self.rain || constants.clock == Clock::Coordinate {
            return retardation;
        }
        // A static observer keeps t.
        retardation - rain_offset(self.u_observer, (self.r - 2.0) / self.r)
    }

    /// du/dtau at the observer of the direction (sin psi, cos psi): (cos psi - beta) / (1 - beta cos psi).
    pub fn observer_slope(&self, cos: f64) -> f64 {
        (cos - self.beta) / (1.0 - self.beta * cos)
    }
}
