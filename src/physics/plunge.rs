// SPDX-License-Identifier: MIT OR Apache-2.0
//! The motion of the matter in the equatorial plane: circular geodesics, and, where it is said to plunge, the geodesics
//! that lead from the ISCO to the horizon. The frequency of light that such matter measures. Knows no light's colour.
//!
//! Cunningham 1975, ApJ 202, 788: inside the ISCO matter keeps the energy E_m and the angular momentum L_m of the orbit
//! there. Its radial potential then has a triple root at the ISCO, so that, with r_I = r(ISCO) and u = 1/r
//! (E_m^2 - 1 and x = L_m - a E_m follow by comparing the coefficients of the cubic in u),
//!
//! ```text
//! (u^r)^2 = E_m^2 - 1 + 2 u + (a^2 (E_m^2 - 1) - L_m^2) u^2 + 2 x^2 u^3 = 2 / (3 r_I) (r_I u - 1)^3
//! E_m^2 = 1 - 2 / (3 r_I),   x = r_I / sqrt(3)
//! ```
//!
//! `a` is the spin as the matter meets it: its own sense of motion is +ph.

use super::geodesic::Constants;
use super::orbit::{isco, redshift};

/// The geodesic that leads from the ISCO to the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plunge {
    pub isco: f64,
    /// E_m.
    pub energy: f64,
    /// a x, which is the same whether the hole or its mirror image is meant.
    pub spin_term: f64,
    /// x of matter that moves towards +ph; its negative for matter that moves towards -ph.
    pub x: f64,
}

impl Plunge {
    pub fn new(spin: f64, retrograde: bool) -> Self {
        let matter_spin = if retrograde { -spin } else { spin };
        let isco = isco(matter_spin);
        let x = isco / 3.0_f64.sqrt();
        Self {
            isco,
            energy: (1.0 - 2.0 / (3.0 * isco)).sqrt(),
            spin_term: matter_spin * x,
            x: if retrograde { -x } else { x },
        }
    }

    /// The frequency that the matter at 1/r = `u`, inside the ISCO, measures of light with the constants `c` that
    /// crosses the plane there with u' = `du` (`geodesic::State`), in the units of `c.energy`.
    ///
    /// By definition that is -p . u of both four-velocities. In the orthonormal frame of Carter 1968, whose time axis
    /// is along (r^2 + a^2) d/dt + a d/dph, with W = E - a (L - a E) u^2 of each, D = Delta / r^2, p^r = u' of the
    /// light (rays are traced backward) and B = Q + (L - a E)^2:
    ///
    /// ```text
    /// nu = (W_m W + |u^r| u') / D - x (L - a E) u^2
    /// ```
    ///
    /// For light that moves inwards the numerator vanishes with D at the horizon. There W^2 - u'^2 = D B u^2 and
    /// W_m^2 - (u^r)^2 = D (1 + x^2 u^2) turn the quotient into one without cancellation.
    pub fn frequency(&self, c: &Constants, u: f64, du: f64) -> f64 {
        let u2 = u * u;
        let x = c.angular_momentum - c.a * c.energy;
        let (w_matter, w_light) = (self.energy - self.spin_term * u2, c.energy - c.a * x * u2);
        let excess = (self.isco * u - 1.0).max(0.0);
        let infall = (2.0 / (3.0 * self.isco)).sqrt() * excess * excess.sqrt();
        let radial = if du >= 0.0 {
            (w_matter * w_light + infall * du) / c.horizon_function(u)
        } else {
            (w_matter * w_matter * c.b * u2 + (1.0 + self.x * self.x * u2) * du * du)
                / (w_matter * w_light - infall * du)
        };
        radial - self.x * x * u2
    }
}

/// The motion of matter in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matter {
    /// Whether the disk's matter moves towards -ph.
    pub retrograde: bool,
    pub isco: f64,
    /// Its motion inside the ISCO; `None`: it is taken to be on the circular geodesic, as far as there are any.
    pub plunge: Option<Plunge>,
}

impl Matter {
    pub fn new(spin: f64, retrograde: bool, plunges: bool) -> Self {
        let isco = isco(if retrograde { -spin } else { spin });
        Self { retrograde, isco, plunge: plunges.then(|| Plunge::new(spin, retrograde)) }
    }

    /// g = nu(observer of the local frame) / nu(matter) of light that crosses the plane at 1/r = `u` with u' = `du`.
    /// NaN inside the photon orbit, unless the matter plunges.
    pub fn redshift(&self, c: &Constants, u: f64, du: f64) -> f64 {
        match self.plunge.filter(|_| u * self.isco > 1.0) {
            Some(plunge) => c.nu_local / plunge.frequency(c, u, du),
            None => redshift(c.a, u, self.retrograde, c.energy, c.angular_momentum, c.nu_local),
        }
    }

    /// g of light that has this energy and angular momentum where the local observer measures frequency 1, from matter
    /// at 1/r = `u` near its crossing of the plane, which is at 1/r = `crossing` with g = `known`. Where matter plunges
    /// at either of the two places `known` is returned, because g then depends on more than these two numbers. `ratio`
    /// is nu(camera) / nu(local frame). The result is NaN inside the photon orbit.
    pub fn redshift_beside(
        &self,
        spin: f64,
        [energy, angular_momentum, ratio]: [f64; 3],
        u: f64,
        [crossing, known]: [f64; 2],
    ) -> f64 {
        match self.plunge.is_some() && crossing.max(u) * self.isco > 1.0 {
            true => known,
            false => ratio * redshift(spin, u, self.retrograde, energy, angular_momentum, 1.0),
        }
    }

    /// Whether it moves as [`Matter::redshift`] has it at 1/r = `u`: there is no matter inside the ISCO that does not
    /// plunge.
    pub fn is_at(&self, u: f64) -> bool {
        self.plunge.is_some() || u * self.isco <= 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::geodesic::State;
    use crate::physics::integrator::{Method, step};
    use crate::physics::metric::{Kerr, boyer_lindquist, chart};
    use crate::physics::observer::LocalFrame;
    use crate::physics::orbit::{circular_orbit, horizon_outer};
    use crate::physics::trace::{Settings, trace_look};
    use glam::DVec3;
    use std::f64::consts::FRAC_PI_2;

    const SPINS: [(f64, bool); 6] =
        [(0.0, false), (0.0, true), (0.9, false), (0.9, true), (-0.5, false), (0.998, false)];

    /// The four-velocity (u^t, u^r, u^th, u^ph) of matter that falls with E and L of the ISCO: u_a raised with the
    /// metric, u_r from u . u = -1.
    fn four_velocity(spin: f64, retrograde: bool, r: f64) -> [f64; 4] {
        let sense = if retrograde { -1.0 } else { 1.0 };
        let isco = isco(sense * spin);
        let orbit = circular_orbit(sense * spin, isco).unwrap();
        let inverse = Kerr { a: spin }.inverse(r, FRAC_PI_2);
        let lower = [-orbit.energy, 0.0, 0.0, sense * orbit.angular_momentum];
        let raised = |i: usize| (0..4).map(|j| inverse[i][j] * lower[j]).sum::<f64>();
        let (t, ph) = (raised(0), raised(3));
        let without_r = lower[0] * t + lower[3] * ph;
        // g_rr (u^r)^2 = -1 - the rest.
        let falling = ((-1.0 - without_r).max(0.0) * inverse[1][1]).sqrt();
        [t, -falling, 0.0, ph]
    }

    /// -p_a u^a with the full metric: p_t and p_ph as the constants say, p^r by differences along the integrated ray.
    fn by_the_metric(c: &Constants, at: &State, velocity: [f64; 4]) -> f64 {
        let r = 1.0 / at.u;
        let metric = Kerr { a: c.a }.metric(r, FRAC_PI_2);
        // d tau is d lambda / r^2 in the plane; rays are followed backward, so that the momentum is the other way.
        let h = 1e-4 / c.scale;
        let radius = |h: f64| {
            let there = step(Method::Nystrom, c, at, h, false).0;
            boyer_lindquist(there.chart_direction() / there.u).0
        };
        let by_tau = (8.0 * (radius(h) - radius(-h)) - (radius(2.0 * h) - radius(-2.0 * h))) / (12.0 * h);
        let momentum = [-c.energy, metric[1][1] * -by_tau / (r * r), 0.0, c.angular_momentum];
        -(0..4).map(|i| momentum[i] * velocity[i]).sum::<f64>()
    }

    #[test]
    fn energy_momentum_and_fall_are_those_of_the_isco() {
        for (spin, retrograde) in SPINS {
            let plunge = Plunge::new(spin, retrograde);
            let matter_spin = if retrograde { -spin } else { spin };
            let orbit = circular_orbit(matter_spin, plunge.isco).unwrap();
            assert!((plunge.energy / orbit.energy - 1.0).abs() < 1e-12, "{spin}");
            let x = orbit.angular_momentum - matter_spin * orbit.energy;
            assert!((plunge.x.abs() / x - 1.0).abs() < 1e-12 && (plunge.x < 0.0) == retrograde, "{spin}");
            for part in [0.1, 0.5, 0.9] {
                let r = plunge.isco + (horizon_outer(spin) - plunge.isco) * part;
                let fall = (2.0 / (3.0 * plunge.isco)).sqrt() * (plunge.isco / r - 1.0).powf(1.5);
                let [_, by_metric, ..] = four_velocity(spin, retrograde, r);
                assert!((fall / -by_metric - 1.0).abs() < 1e-7, "{spin} {r}: {fall} {by_metric}");
            }
        }
        // The closed forms of spin 0.
        let r = 3.7_f64;
        let [t, radial, _, ph] = four_velocity(0.0, false, r);
        assert!((t - 8.0_f64.sqrt() / 3.0 / (1.0 - 2.0 / r)).abs() < 1e-12);
        assert!((ph - 12.0_f64.sqrt() / (r * r)).abs() < 1e-12);
        assert!((radial + (6.0 / r - 1.0).powf(1.5) / 3.0).abs() < 1e-10);
    }

    /// Along rays that fall in, that turn inside the ISCO, and that reach an observer inside the horizon.
    #[test]
    fn redshift_is_that_of_the_full_metric() {
        let (mut inwards, mut outwards) = (0, 0);
        for (spin, retrograde) in SPINS {
            let matter = Matter::new(spin, retrograde, true);
            for (r, theta) in [(30.0, 1.3), (8.0, 0.6), (4.6, 1.5)] {
                let frame = LocalFrame::new(spin, chart(r, theta, 0.4)).unwrap();
                for i in 0..400 {
                    let turn = 2.4 * f64::from(i);
                    let wide = (8.0 / r).min(1.2) * (f64::from(i) / 400.0).sqrt();
                    let n = DVec3::new(-1.0, wide * turn.cos(), wide * turn.sin()).normalize();
                    let (constants, traced) = trace_look(&frame, n, &Settings::exact(spin));
                    let c = constants.unwrap();
                    for crossing in traced.crossings.iter().filter(|x| x.u * matter.isco > 1.0) {
                        let r = 1.0 / crossing.u;
                        if r < horizon_outer(spin) * 1.01 {
                            continue;
                        }
                        let at = State { u: crossing.u, du: crossing.du, ..in_the_plane(&c, crossing.u, crossing.du) };
                        let velocity = four_velocity(spin, retrograde, r);
                        let expected = c.nu_local / by_the_metric(&c, &at, velocity);
                        let found = matter.redshift(&c, crossing.u, crossing.du);
                        assert!(found > 0.0, "{spin} {r}: {found}");
                        assert!((found / expected - 1.0).abs() < 1e-6, "{spin} {retrograde} {r}: {found} {expected}");
                        if crossing.du > 0.0 { inwards += 1 } else { outwards += 1 }
                    }
                }
            }
        }
        println!("{inwards} before and {outwards} after the least distance");
        assert!(inwards > 1000 && outwards > 30, "{inwards} {outwards}");
    }

    /// A state of the light in the plane: any azimuth does.
    fn in_the_plane(c: &Constants, u: f64, du: f64) -> State {
        let dn = DVec3::new(0.0, c.angular_momentum, c.carter.max(0.0).sqrt());
        State { u, du, n: DVec3::X, dn, drag: 0.0, delay: 0.0 }
    }

    #[test]
    fn redshift_goes_on_evenly_through_the_isco() {
        for (spin, retrograde) in SPINS {
            let [matter, circular] = [true, false].map(|plunges| Matter::new(spin, retrograde, plunges));
            let sense = if retrograde { -1.0 } else { 1.0 };
            for (l, q) in [(1.0, 4.0), (-2.0, 1.0), (sense * 1.5, 0.5)] {
                let c = Constants::new(spin, 1.0, l, q, 1.3, 0.01);
                let du = |u: f64| {
                    let w = 1.0 - spin * (l - spin) * u * u;
                    (w * w - c.horizon_function(u) * c.b * u * u).max(0.0).sqrt()
                };
                let g = |matter: &Matter, r: f64, side: f64| matter.redshift(&c, 1.0 / r, side * du(1.0 / r));
                let r = matter.isco;
                for side in [-1.0, 1.0] {
                    let [before, after] = [1.0 + 1e-9, 1.0 - 1e-9].map(|part| g(&matter, r * part, side));
                    assert!((after / before - 1.0).abs() < 1e-7, "{spin}: {before} {after}");
                    assert_eq!(g(&matter, r * 1.01, side), g(&circular, r * 1.01, side));
                }
                // Matter that falls in moves away from what its light moves towards when that is farther out.
                assert!(
                    du(1.0 / (r * 0.9)) > 0.0 && g(&matter, r * 0.9, 1.0) < 0.99 * g(&matter, r * 0.9, -1.0),
                    "{spin}"
                );
                assert!(matter.is_at(1.1 / r) && !circular.is_at(1.1 / r) && circular.is_at(0.9 / r));
            }
        }
    }

    /// Light that has come in from outside is seen by an observer beside the horizon: nothing diverges there.
    #[test]
    fn light_that_moves_inwards_has_a_finite_frequency_at_the_horizon() {
        for (spin, retrograde) in SPINS {
            let plunge = Plunge::new(spin, retrograde);
            let c = Constants::new(spin, 1.0, 0.7, 3.0, 1.0, 0.01);
            let nu = |margin: f64| {
                let u = 1.0 / (c.r_plus * (1.0 + margin));
                let w = 1.0 - spin * (0.7 - spin) * u * u;
                plunge.frequency(&c, u, -(w * w - c.horizon_function(u) * c.b * u * u).sqrt())
            };
            let [near, nearer] = [nu(1e-7), nu(1e-10)];
            assert!(near > 0.0 && near < 1e3 && (nearer / near - 1.0).abs() < 1e-3, "{spin}: {near} {nearer}");
        }
    }
}
