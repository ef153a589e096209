// SPDX-License-Identifier: MIT OR Apache-2.0
//! The shadow: critical impact parameter, and its angular radius for spin-0 observers.
//! Knows observers, no integrator.

use super::observer::Observer;
use glam::DVec3;

/// b_c = 3 sqrt(3): impact parameter of the rays that wind up on the photon sphere, spin 0 (Hilbert 1917).
pub const CRITICAL_IMPACT_PARAMETER: f64 = 5.196152422706632;

/// A circle on an observer's sky.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// Angular radius; more than pi / 2 when the shadow fills most of the sky.
    pub radius: f64,
    /// Unit look direction to its centre, components in the observer's (boosted) frame.
    pub center: DVec3,
}

/// The spin-0 shadow, a circle for every observer: Synge 1966 for the static one, aberrated for a moving one; inside
/// the horizon that of the rain observer is aberrated.
///
/// Look directions n on a circle about k, n.k = cos psi, are the null vectors (1, n) orthogonal to the unit space-like
/// vector S = (cos psi, k) / sin psi; a boost takes S to S', whose time part is cot psi' and whose space part points
/// to the new centre. (Look directions transform like (nu, nu n) under the opposite velocity.)
pub fn shadow(observer: &Observer) -> Shadow {
    let r = observer.frame.r;
    let inward = DVec3::NEG_X;
    let (sin, cos) = critical_direction(r, observer.frame.rain);
    let (cot, k) = (cos / sin, inward / sin);
    let (beta, gamma) = (observer.beta, observer.gamma);
    let time = gamma * (cot + beta.dot(k));
    let space = k + beta * (gamma * gamma / (gamma + 1.0) * beta.dot(k) + gamma * cot);
    Shadow { radius: 1.0_f64.atan2(time), center: space.normalize() }
}

/// (sin, cos) of psi_c, the angle from the inward radius at which a spin-0 ray winds up on the photon sphere, for the
/// static observer at `r` > 2 or, with `rain`, for the one that falls from rest at infinity, at any `r` > 0.
///
/// Static: sin psi = b_c sqrt(1 - 2/r) / r (Synge 1966). Rain: r sin psi = b_c (1 - sqrt(2/r) cos psi), inside the
/// horizon too. r^3 - 27 r + 54 = (r - 3)^2 (r + 6) is 1 - sin^2 psi without cancellation at the photon sphere, and
/// the root's sign.
pub fn critical_direction(r: f64, rain: bool) -> (f64, f64) {
    let b = CRITICAL_IMPACT_PARAMETER;
    let root = (r - 3.0) * ((r + 6.0) / r).sqrt();
    if !rain {
        return (b * ((r - 2.0) / r).sqrt() / r, root / r);
    }
    let speed = (2.0 / r).sqrt();
    let amplitude2 = r * r + 54.0 / r;
    (b * (r - speed * root) / amplitude2, (r * root + b * b * speed) / amplitude2)
}

/// The shadow seen by the observer falling from rest at infinity, inside too: `critical_direction` as an angle.
pub fn rain_shadow_radius(r: f64) -> f64 {
    let (sin, cos) = critical_direction(r, true);
    sin.atan2(cos)
}
