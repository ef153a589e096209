//! The shadow: critical impact parameter, its angular radius for spin-0 observers, Bardeen's curve for spinning holes.
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

/// The spin-0 shadow, a circle for every observer: Synge 1966 for the static one, aberrated for a moving one.
///
/// Look directions n on a circle about k, n.k = cos psi, are the null vectors (1, n) orthogonal to the unit space-like
/// vector S = (cos psi, k) / sin psi; a boost takes S to S', whose time part is cot psi' and whose space part points
/// to the new centre. (Look directions transform like (nu, nu n) under the opposite velocity.)
pub fn shadow(observer: &Observer) -> Shadow {
    let r = observer.frame.r;
    let inward = DVec3::NEG_X;
    if observer.frame.rain {
        return Shadow { radius: rain_shadow_radius(r), center: inward };
    }
    let (sin, cos) = critical_direction(r, false);
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

/// A point of the critical curve on the sky of an observer at infinity.
#[derive(Clone, Copy, Debug)]
pub struct CriticalPoint {
    /// Radius of the spherical photon orbit.
    pub r_photon: f64,
    pub lambda: f64,
    pub eta: f64,
    /// Sky coordinates, M: alpha right, beta up (projected spin axis).
    pub alpha: f64,
    pub beta: f64,
}

/// lambda and eta of the spherical photon orbit of radius `r`, a != 0. (Bardeen 1973.)
pub fn spherical_photon_orbit(a: f64, r: f64) -> (f64, f64) {
    let lambda = -(r * r * (r - 3.0) + a * a * (r + 1.0)) / (a * (r - 1.0));
    let eta = r * r * r * (4.0 * a * a - r * (r - 3.0).powi(2)) / (a * (r - 1.0)).powi(2);
    (lambda, eta)
}

/// Upper half (beta >= 0) of Bardeen's curve at inclination `inclination` from the spin axis, `count` points; a != 0.
/// The lower half mirrors it. beta^2 = eta + a^2 cos^2 i - lambda^2 cot^2 i.
pub fn bardeen_curve(a: f64, inclination: f64, count: usize) -> Vec<CriticalPoint> {
    let (sin, cos) = inclination.sin_cos();
    let beta2 = |r: f64| {
        let (lambda, eta) = spherical_photon_orbit(a, r);
        eta + (a * cos).powi(2) - (lambda * cos / sin).powi(2)
    };
    // beta^2 > 0 between two radii, which lie about the polar photon orbit (lambda = 0).
    let polar = bisect(|r| spherical_photon_orbit(a, r).0 * a, super::orbit::horizon_outer(a) + 1e-9, 4.0);
    let low = bisect(beta2, super::orbit::photon_orbit(a.abs()) * (1.0 - 1e-12), polar);
    let high = bisect(beta2, super::orbit::photon_orbit(-a.abs()) * (1.0 + 1e-12), polar);
    (0..count)
        .map(|i| {
            let x = (std::f64::consts::PI * i as f64 / (count - 1).max(1) as f64).cos();
            let r_photon = 0.5 * (low + high) - 0.5 * (high - low) * x;
            let (lambda, eta) = spherical_photon_orbit(a, r_photon);
            CriticalPoint { r_photon, lambda, eta, alpha: -lambda / sin, beta: beta2(r_photon).max(0.0).sqrt() }
        })
        .collect()
}

/// The zero of `f` between `x0` and `x1`, where it has opposite signs.
fn bisect(f: impl Fn(f64) -> f64, mut x0: f64, mut x1: f64) -> f64 {
    let sign = f(x1) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (x0 + x1);
        if (f(middle) > 0.0) == sign { x1 = middle } else { x0 = middle }
    }
    0.5 * (x0 + x1)
}
