// SPDX-License-Identifier: MIT OR Apache-2.0
//! How fast bodies move in Doran's chart, and how that is seen by the rain observer and by the ZAMO of a place. Knows
//! no world line.
//!
//! By Doran 2000 (Phys. Rev. D 61, 067503, eq. 13) with s = sin th, Sigma = rho^2 = r^2 + a^2 cos^2 th
//!
//! ```text
//! ds^2 = -dT^2 + (rho dr / sqrt(r^2 + a^2) + sqrt(2 r) (dT - a s^2 dph) / rho)^2 + rho^2 dth^2
//!        + (r^2 + a^2) s^2 dph^2
//! ```
//!
//! so that the rain observer, whose clock is T, sees the velocity rho r' / sqrt(r^2 + a^2) + sqrt(2 r) (1 - a s^2 ph')
//! / rho along E_r, rho th' along E_th and sqrt(r^2 + a^2) s ph' along E_ph, primes being d/dT. The triad that hosts
//! know is turned against these by the angle of `RainTriad`.

use super::flow::{Place, Velocity};
use super::observer::RainTriad;
use glam::{DVec3, dvec3};

/// A place in Doran's chart by its spherical coordinates, with the unit vectors towards them. On the axis the azimuth
/// is 0.
struct Spherical {
    r: f64,
    sin: f64,
    triad: RainTriad,
    e_r: DVec3,
    e_theta: DVec3,
    e_phi: DVec3,
}

impl Spherical {
    fn new(a: f64, position: DVec3) -> Self {
        let r = position.length();
        let e_r = position / r;
        let sin = e_r.x.hypot(e_r.y);
        let (cos_ph, sin_ph) = if sin > 0.0 { (e_r.x / sin, e_r.y / sin) } else { (1.0, 0.0) };
        Self {
            r,
            sin,
            triad: RainTriad::new(a, r, sin, e_r.z),
            e_r,
            e_theta: dvec3(e_r.z * cos_ph, e_r.z * sin_ph, -sin),
            e_phi: dvec3(-sin_ph, cos_ph, 0.0),
        }
    }
}

/// d(position)/dT in Doran's chart, of a body that the rain observer at `position` (not the centre) sees move with
/// `velocity` along (e_r, e_th, e_ph).
pub fn chart_rate(a: f64, position: DVec3, velocity: DVec3) -> DVec3 {
    let at = Spherical::new(a, position);
    let t = &at.triad;
    let radial = t.cos_turn * velocity.x + t.sin_turn * velocity.z;
    let around = t.cos_turn * velocity.z - t.sin_turn * velocity.x;
    let outwards = (t.q * radial + a / at.r * at.sin * t.w * around / t.rho - t.q * t.w / t.rho) / t.rho;
    at.e_r * outwards + at.e_theta * (velocity.y / t.rho) + at.e_phi * (around / t.q)
}

/// The velocity along (e_r, e_th, e_ph) that the rain observer at `position` sees: the inverse of `chart_rate`.
pub fn rain_velocity(a: f64, position: DVec3, rate: DVec3) -> DVec3 {
    let at = Spherical::new(a, position);
    let t = &at.triad;
    let turn = rate.dot(at.e_phi);
    let radial = t.rho / t.q * rate.dot(at.e_r) + t.w / t.rho * (1.0 - a / at.r * at.sin * turn);
    let around = t.q * turn;
    dvec3(
        t.cos_turn * radial - t.sin_turn * around,
        t.rho * rate.dot(at.e_theta),
        t.cos_turn * around + t.sin_turn * radial,
    )
}

/// The motion that the ZAMO measures of what the rain observer at the same place sees move with `velocity` along (e_r,
/// e_th, e_ph): the ZAMO, whose lapse is al, sees that observer fall along -e_r with sqrt(1 - al^2), at the energy 1 /
/// al.
pub fn zamo_velocity(at: &Place, velocity: DVec3) -> Velocity {
    let fall = ((1.0 - at.lapse) * (1.0 + at.lapse)).max(0.0).sqrt();
    let gamma = 1.0 / (1.0 - velocity.length_squared()).sqrt();
    let slowed = at.lapse / (1.0 - fall * velocity.x);
    Velocity { around: slowed * velocity.z, polar: slowed * velocity.y, radial: gamma * (velocity.x - fall) / at.lapse }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::geodesic::Clock;
    use crate::physics::orbit::horizon_inner;
    use crate::physics::world_line::{Body, world_line};

    const PLACES: [[f64; 3]; 5] =
        [[9.0, 2.0, 3.0], [1.1, -0.9, 0.4], [0.0, 2.5, -2.0], [0.4, 0.5, 0.3], [0.0, 0.0, 6.0]];

    #[test]
    fn velocities_are_the_inverse_of_rates() {
        for a in [0.0, 0.5, -0.9, 0.9999] {
            for place in PLACES.map(DVec3::from_array) {
                for velocity in [dvec3(0.1, 0.3, -0.5), dvec3(-0.9, 0.1, 0.2), DVec3::ZERO] {
                    let found = rain_velocity(a, place, chart_rate(a, place, velocity));
                    assert!((found - velocity).length() < 1e-14, "{a} {place}: {found} {velocity}");
                }
            }
        }
    }

    /// Differences of places along world lines, inside the horizon too.
    #[test]
    fn rates_are_those_of_world_lines() {
        for (a, place) in [0.0, 0.5, -0.9, 0.99].into_iter().flat_map(|a| PLACES.map(|place| (a, place))) {
            let body = Body {
                clock: Clock::Rain,
                position: DVec3::from_array(place),
                velocity: dvec3(-0.2, 0.4, 0.3),
                time: 0.0,
            };
            let h = 1e-4;
            let Ok(events) = world_line(a, &body, &[DVec3::X; 3], &[-2.0 * h, -h, h, 2.0 * h]) else {
                assert!(body.position.length() <= horizon_inner(a) * (1.0 + 1e-6), "{a} {place:?}");
                continue;
            };
            let there = |i: usize| events[i].body.position;
            let time = |i: usize| events[i].body.time;
            let change = (there(2) - there(1)) * 8.0 - (there(3) - there(0));
            let rate = change / (8.0 * (time(2) - time(1)) - (time(3) - time(0)));
            let expected = chart_rate(a, body.position, body.velocity);
            assert!((rate - expected).length() < 1e-8, "{a} {place:?}: {rate} {expected}");
        }
    }

    /// The rain observer itself, whom the ZAMO sees fall from rest at infinity (`flow::Motion::Keplerian`).
    #[test]
    fn zamos_see_rain_fall() {
        use crate::physics::flow::keplerian;
        for a in [0.0, 0.7, -0.998] {
            for (r, cos) in [(2.2, 0.1), (6.0, -0.8), (300.0, 0.5)] {
                let at = Place::new(a, 1.0 / r, cos);
                let (found, expected) = (zamo_velocity(&at, DVec3::ZERO), keplerian(a, &at, 6.0, 0.0, 1.0));
                assert!((found.radial / expected.radial - 1.0).abs() < 1e-12, "{a} {r}: {found:?} {expected:?}");
                assert!(found.around.abs() + found.polar.abs() < 1e-15, "{a} {r}: {found:?}");
            }
        }
    }
}
