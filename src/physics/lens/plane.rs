// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes a spin-0 ray from its own plane to the chart: where it goes on the sky, where it crosses the equatorial plane,
//! and how both change with the look direction. Geometry of great circles; the ray itself comes from
//! `table::SchwarzschildLookup`.
//!
//! The ray lies at N(phi) = e_r cos phi + T sin phi, T the unit vector of (e_th n_th + e_ph n_ph).

use super::table::{Crossing, SchwarzschildLookup};
use crate::physics::observer::LocalFrame;
use glam::{DVec3, Vec3Swizzles};
use std::f64::consts::PI;

/// Below this sin psi_c, close to straight outwards, the ratio sin(swept) / sin psi is taken for its limit.
const RADIAL: f64 = 1e-3;

/// The plane of one ray.
#[derive(Clone, Copy, Debug)]
pub struct OrbitPlane {
    pub e_r: DVec3,
    /// T; any unit vector across e_r for a radial ray.
    pub tangent: DVec3,
    /// sin psi T, as long as the look direction's part across e_r.
    across: DVec3,
    /// Cosine of the observer's polar angle: exactly 0 in the plane.
    cos_theta: f64,
}

/// How a ray changes with its look direction.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    pub dpsi: f64,
    /// sin psi dT.
    pub dtangent: DVec3,
}

/// The end of an escaping ray.
#[derive(Clone, Copy, Debug)]
pub struct PlaneSky {
    /// Chart, unit.
    pub direction: DVec3,
    by_psi: DVec3,
    /// sin(swept) / sin psi.
    sine_ratio: f64,
}

/// A crossing of the equatorial plane as seen along a ray, or its change.
#[derive(Clone, Copy, Debug)]
pub struct PlaneImage {
    pub u: f64,
    /// Azimuth in the chart, in (-pi, pi].
    pub azimuth: f64,
    /// Time since light left there, M; 0 if the table has no delays.
    pub delay: f64,
}

impl OrbitPlane {
    /// The plane of the look direction `n` (components, unit).
    #[inline]
    pub fn new(frame: &LocalFrame, n: DVec3) -> Self {
        let across = frame.e_theta * n.y + frame.e_phi * n.z;
        let sin = n.yz().length();
        let tangent = if sin > 0.0 { across / sin } else { frame.e_theta };
        Self { e_r: frame.e_r, tangent, across, cos_theta: frame.cos }
    }

    /// N(phi).
    pub fn position(&self, phi: f64) -> DVec3 {
        let (sin, cos) = phi.sin_cos();
        self.e_r * cos + self.tangent * sin
    }

    /// dN/dphi.
    pub fn heading(&self, phi: f64) -> DVec3 {
        let (sin, cos) = phi.sin_cos();
        self.tangent * cos - self.e_r * sin
    }

    /// The angle at which the ray crosses the equatorial plane for the (`order` + 1)-th time, however far it goes: the
    /// zeros of N_z = cos(theta) cos(phi) + T_z sin(phi), the observer's own place not counted. `None`: the ray lies in
    /// that plane.
    pub fn crossing_angle(&self, order: u32) -> Option<f64> {
        if self.cos_theta == 0.0 {
            return (self.tangent.z != 0.0).then(|| PI * (f64::from(order) + 1.0));
        }
        let first = self.cos_theta.abs().atan2(-self.tangent.z * self.cos_theta.signum());
        Some(first + PI * f64::from(order))
    }

    /// The (`order` + 1)-th crossing. `None`: the ray ends before.
    pub fn crossing(&self, lookup: &SchwarzschildLookup, order: u32) -> Option<Crossing> {
        lookup.crossing(self.crossing_angle(order)?)
    }

    pub fn image(&self, lookup: &SchwarzschildLookup, crossing: &Crossing) -> PlaneImage {
        let at = self.position(crossing.phi);
        PlaneImage { u: crossing.u, azimuth: at.y.atan2(at.x), delay: lookup.delay(crossing) }
    }

    /// How far the crossing moves along the ray with the look direction: N_z stays 0, dphi = -sin(phi) dT_z / N'_z.
    fn phi_change(&self, lookup: &SchwarzschildLookup, crossing: &Crossing, turn: &Turn) -> f64 {
        let (sin, cos) = crossing.phi.sin_cos();
        let rise = self.tangent.z * cos - self.e_r.z * sin;
        -turn.dtangent.z * sin / (lookup.sin.max(f64::MIN_POSITIVE) * rise)
    }

    /// The change of a crossing's u with the look direction.
    pub fn u_change(&self, lookup: &SchwarzschildLookup, crossing: &Crossing, turn: &Turn) -> f64 {
        crossing.u_psi * turn.dpsi + crossing.u_phi * self.phi_change(lookup, crossing, turn)
    }

    /// The change of `image` with the look direction. The delay follows from its gradient
    /// (`SchwarzschildLookup::delay_gradient`).
    pub fn image_change(&self, lookup: &SchwarzschildLookup, crossing: &Crossing, turn: &Turn) -> PlaneImage {
        let (at, heading) = (self.position(crossing.phi), self.heading(crossing.phi));
        let swing = turn.dtangent * (crossing.phi.sin() / lookup.sin.max(f64::MIN_POSITIVE));
        let dphi = self.phi_change(lookup, crossing, turn);
        let moved = swing + heading * dphi;
        let du = crossing.u_psi * turn.dpsi + crossing.u_phi * dphi;
        let (by_phi, by_u) = lookup.delay_gradient(crossing);
        PlaneImage {
            u: du,
            azimuth: (at.x * moved.y - at.y * moved.x) / (at.x * at.x + at.y * at.y),
            delay: by_phi * dphi + by_u * du,
        }
    }

    /// The change of the ray for a small change `dn` (components) of the look direction `n`, dn across n.
    #[inline]
    pub fn turn(&self, frame: &LocalFrame, lookup: &SchwarzschildLookup, dn: DVec3) -> Turn {
        let across = frame.e_theta * dn.y + frame.e_phi * dn.z;
        let along = self.tangent.dot(across);
        // psi = atan2(sin psi, -n_r).
        Turn { dpsi: lookup.sin * dn.x + lookup.cos * along, dtangent: across - self.tangent * along }
    }

    /// Where on the sky an escaping ray ends: N(swept).
    #[inline]
    pub fn sky(&self, lookup: &SchwarzschildLookup) -> PlaneSky {
        let (sin, cos) = lookup.swept.sin_cos();
        // sin(swept) / sin psi; -d swept / d psi straight outwards, where both vanish.
        let radial = lookup.cos < 0.0 && lookup.sin < RADIAL * lookup.sin_critical();
        let sine_ratio = if radial { -lookup.swept_slope } else { sin / lookup.sin };
        PlaneSky {
            direction: self.e_r * cos + self.across * sine_ratio,
            by_psi: (self.tangent * cos - self.e_r * sin) * lookup.swept_slope,
            sine_ratio,
        }
    }
}

impl PlaneSky {
    /// The change of the direction with the look direction.
    pub fn change(&self, turn: &Turn) -> DVec3 {
        self.by_psi * turn.dpsi + turn.dtangent * self.sine_ratio
    }
}
