// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light about a hole without spin, and the disk there, written from the textbooks: nothing of the library's tracer. M
//! = 1.

use bhr::physics::blackbody::radiance_xyz;
use std::f64::consts::PI;

/// u = 1/r where a ray from the observer at radius `r_observer` with impact parameter `b`, going inward, has swept
/// `angle` about the hole: u'' = 3 u^2 - u (Darwin 1959), by RK4. `None`: it has fallen in before; not positive: it has
/// escaped before.
pub fn u_at(r_observer: f64, b: f64, angle: f64) -> Option<f64> {
    let steps = (angle / 0.01).ceil();
    let h = angle / steps;
    let u0 = 1.0 / r_observer;
    let (mut u, mut v) = (u0, (1.0 / (b * b) - u0 * u0 * (1.0 - 2.0 * u0)).sqrt());
    let force = |u: f64| 3.0 * u * u - u;
    for _ in 0..steps as u32 {
        let (k1, l1) = (v, force(u));
        let (k2, l2) = (v + 0.5 * h * l1, force(u + 0.5 * h * k1));
        let (k3, l3) = (v + 0.5 * h * l2, force(u + 0.5 * h * k2));
        let (k4, l4) = (v + h * l3, force(u + h * k3));
        u += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        v += h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
        if u >= 0.5 {
            return None;
        }
        if u <= 0.0 {
            break;
        }
    }
    Some(u)
}

/// Angle swept until the plane of the disk is met for the (order + 1)-th time, by the ray that an observer at
/// inclination `i` sees at `alpha` from upward towards its right, about the hole's centre (Luminet 1979, eq. 10).
pub fn swept_to_plane(i: f64, alpha: f64, order: u32) -> f64 {
    i.cos().atan2(-i.sin() * alpha.cos()) + f64::from(order) * PI
}

/// The isoradial: impact parameter at which the ring of radius `r` is seen; bisection, the radius growing with b.
pub fn isoradial(r_observer: f64, i: f64, alpha: f64, order: u32, r: f64) -> f64 {
    let angle = swept_to_plane(i, alpha, order);
    let (mut low, mut high) = (0.01, 4.0 * r + 20.0);
    for _ in 0..50 {
        let b = 0.5 * (low + high);
        let beyond = u_at(r_observer, b, angle).is_some_and(|u| u < 1.0 / r);
        if beyond { high = b } else { low = b }
    }
    0.5 * (low + high)
}

/// g of light of matter orbiting at u, seen by a static observer at `r_observer` (Luminet 1979, eq. 19, at a finite
/// distance). `b` is seen at `alpha`: the photon's L / E is -b sin i sin alpha, the matter on the observer's right
/// going away.
pub fn redshift(r_observer: f64, i: f64, alpha: f64, b: f64, u: f64) -> f64 {
    let lambda = -b * i.sin() * alpha.sin();
    (1.0 - 3.0 * u).sqrt() / (1.0 - u.powf(1.5) * lambda) / (1.0 - 2.0 / r_observer).sqrt()
}

/// Page & Thorne 1974, eq. 15n, without spin; up to a factor.
fn flux(r: f64) -> f64 {
    let (x, s6, s3) = (r.sqrt(), 6.0_f64.sqrt(), 3.0_f64.sqrt());
    let ln = (((x + s3) * (s6 - s3)) / ((x - s3) * (s6 + s3))).ln();
    (x - s6 + 0.5 * s3 * ln) / ((r - 3.0) * r.powf(2.5))
}

/// Radius of the hottest ring, and the flux there (the golden luminet.json has both).
pub const HOTTEST: (f64, f64) = (9.550_928_08, 1.145_894_732e-4);

/// T(r) / T(hottest ring), r > 6.
pub fn temperature(r: f64) -> f64 {
    (flux(r).max(0.0) / HOTTEST.1).powf(0.25)
}

/// Luminance of a blackbody in units of that of another one; I_nu / nu^3 being invariant, one seen under g is one at g
/// T.
pub fn luminance(temperature: f64, reference: f64) -> f64 {
    radiance_xyz(temperature)[1] / radiance_xyz(reference)[1]
}

/// The golden file's maximum is that of the formula here.
#[test]
fn hottest_ring() {
    let (r, f) = HOTTEST;
    assert!((flux(r) / f - 1.0).abs() < 1e-9 && flux(r * 1.001) < f && flux(r / 1.001) < f);
}

/// Weak and strong deflection: 4 / b; Darwin's b of a ray that turns at r = 4.
#[test]
fn rays_bend_as_they_should() {
    let b = 1e4;
    // From 1e9 M a ray of the impact parameter b reaches u = 0 again after pi + 4 / b.
    let past = |extra: f64| u_at(1e9, b, PI + extra).unwrap();
    assert!(past(3.9 / b) > 0.0 && past(4.1 / b) < 0.0, "{} {}", past(3.9 / b), past(4.1 / b));
    let turning = 4.0 / (1.0 - 0.5_f64).sqrt();
    let nearest = (0..600).filter_map(|k| u_at(1e6, turning, 0.01 * f64::from(k + 1))).fold(0.0, f64::max);
    assert!((nearest - 0.25).abs() < 1e-5, "{nearest}");
}
