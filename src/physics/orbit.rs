// SPDX-License-Identifier: MIT OR Apache-2.0
//! Radii and circular equatorial orbits of the Kerr spacetime. Knows nothing of light beyond the photon orbits.
//!
//! Bardeen, Press & Teukolsky 1972, eq. 2.12 - 2.21. `a` is signed; matter moves towards +ph ("prograde") unless
//! `retrograde`, which is the same orbit seen in a mirror: a -> -a, ph -> -ph.

/// r+ = 1 + sqrt(1 - a^2).
pub fn horizon_outer(a: f64) -> f64 {
    1.0 + ((1.0 - a) * (1.0 + a)).sqrt()
}

/// r- = a^2 / r+: the other root of Delta, without cancellation.
pub fn horizon_inner(a: f64) -> f64 {
    a * a / horizon_outer(a)
}

/// The least r that observers and bodies inside a hole are followed to: r- (1 + 1e-6), |a| <= 1. From there to r- the
/// sky's light comes in a time that ends before it does.
pub fn innermost_radius(a: f64) -> f64 {
    horizon_inner(a) * (1.0 + 1e-6)
}

/// The static limit at polar angle th: 1 + sqrt(1 - a^2 cos^2 th).
pub fn ergosphere(a: f64, theta: f64) -> f64 {
    1.0 + (1.0 - (a * theta.cos()).powi(2)).max(0.0).sqrt()
}

/// Circular photon orbit towards +ph: 2 (1 + cos(2/3 acos(-a))); towards -ph with -a. (Eq. 2.18.)
pub fn photon_orbit(a: f64) -> f64 {
    2.0 * (1.0 + (2.0 / 3.0 * (-a).acos()).cos())
}

/// Innermost stable circular orbit of matter moving towards +ph; towards -ph with -a. (Eq. 2.21.)
pub fn isco(a: f64) -> f64 {
    let z1 = 1.0 + ((1.0 - a) * (1.0 + a)).cbrt() * ((1.0 + a).cbrt() + (1.0 - a).cbrt());
    let z2 = (3.0 * a * a + z1 * z1).sqrt();
    let root = ((3.0 - z1) * (3.0 + z1 + 2.0 * z2)).max(0.0).sqrt();
    3.0 + z2 - root.copysign(a)
}

/// omega = -g_tph / g_phph: angular velocity of the ZAMO at (r, th), th by its sine.
pub fn zamo_omega(a: f64, r: f64, sin: f64) -> f64 {
    let sum = r * r + a * a;
    let delta = (r - horizon_outer(a)) * (r - horizon_inner(a));
    let big_a = sum * sum - delta * (a * sin).powi(2);
    2.0 * a * r / big_a
}

/// nu measured by the ZAMO at (1/r, cos th), of a photon with constants E, L: (E - omega L) / lapse. (Bardeen, Press &
/// Teukolsky 1972, eq. 2.6, 3.2.)
pub fn zamo_frequency(a: f64, u: f64, cos: f64, energy: f64, angular_momentum: f64) -> f64 {
    let r = 1.0 / u;
    let sum = r * r + a * a;
    let delta = (r - horizon_outer(a)) * (r - horizon_inner(a));
    let sin2 = 1.0 - cos * cos;
    let lapse = ((r * r + (a * cos).powi(2)) * delta / (sum * sum - delta * a * a * sin2)).sqrt();
    (energy - zamo_omega(a, r, sin2.sqrt()) * angular_momentum) / lapse
}

/// Matter on a circular equatorial geodesic of radius `r`, moving towards +ph.
#[derive(Clone, Copy, Debug)]
pub struct CircularOrbit {
    /// Omega = d ph / d t = 1 / (r^(3/2) + a).
    pub angular_velocity: f64,
    /// u^t = d t / d tau.
    pub ut: f64,
    /// E / m.
    pub energy: f64,
    /// L_z / m.
    pub angular_momentum: f64,
    /// v / c measured by the ZAMO there, towards +ph.
    pub beta: f64,
}

/// Sums in s = 1 / sqrt(r) that circular orbits towards +ph are made of. For spins near 1 each is small beside the
/// horizon, and written as what it is for a = 1, which has factors 1 - s, and a rest.
struct OrbitSums {
    /// 1 - 3 u + 2 a s^3 = (1 - s)^2 (1 + 2 s) - 2 (1 - a) s^3.
    root: f64,
    /// 1 - 2 u + a s^3 = (1 - s) (1 + s - u) - (1 - a) s^3.
    energy: f64,
    /// 1 - 2 a s^3 + a^2 u^2 = (1 - s) (1 + s + u - s^3) + (1 - a) (2 s^3 - (1 + a) u^2).
    momentum: f64,
}

/// From this spin on `OrbitSums` are written for it.
const SPINS_FAST: f64 = 0.9999;

impl OrbitSums {
    fn new(a: f64, u: f64) -> Self {
        let s = u.sqrt();
        let v = u * s;
        if a <= SPINS_FAST {
            return Self {
                root: 1.0 - 3.0 * u + 2.0 * a * v,
                energy: 1.0 - 2.0 * u + a * v,
                momentum: 1.0 - 2.0 * a * v + (a * u).powi(2),
            };
        }
        let (near, rest) = ((1.0 - u) / (1.0 + s), 1.0 - a);
        Self {
            root: near * near * (1.0 + 2.0 * s) - 2.0 * rest * v,
            energy: near * (1.0 + s - u) - rest * v,
            momentum: near * (1.0 + s + u - v) + rest * (2.0 * v - (1.0 + a) * u * u),
        }
    }
}

/// `None` at or inside the circular photon orbit, where no time-like circular orbit exists. (Eq. 2.12, 2.13, 2.16,
/// 3.11a.)
pub fn circular_orbit(a: f64, r: f64) -> Option<CircularOrbit> {
    let u = 1.0 / r;
    let v = u * u.sqrt();
    let sums = OrbitSums::new(a, u);
    let root = sums.root.sqrt();
    if root.is_nan() || root <= 0.0 || r <= horizon_outer(a) {
        return None;
    }
    let delta = (r - horizon_outer(a)) * (r - horizon_inner(a));
    Some(CircularOrbit {
        angular_velocity: 1.0 / (r * r.sqrt() + a),
        ut: (1.0 + a * v) / root,
        energy: sums.energy / root,
        angular_momentum: r.sqrt() * sums.momentum / root,
        beta: r * r * sums.momentum / (delta.sqrt() * (r * r.sqrt() + a)),
    })
}

/// g = nu_receiver / nu_emitter of a photon with constants E, L (scaled so that the receiver measures `nu_receiver`)
/// emitted at u = 1 / r by matter on the circular orbit towards +ph, or -ph if `retrograde`. (Luminet 1979; eq. 2.16
/// above.) Also for E <= 0, inside the ergosphere. NaN where no such orbit exists.
pub fn redshift(a: f64, u: f64, retrograde: bool, energy: f64, angular_momentum: f64, nu_receiver: f64) -> f64 {
    let v = if retrograde { -u * u.sqrt() } else { u * u.sqrt() };
    let matter_spin = if retrograde { -a } else { a };
    nu_receiver * OrbitSums::new(matter_spin, u).root.sqrt() / (energy * (1.0 + a * v) - v * angular_momentum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schwarzschild_radii() {
        assert_eq!(horizon_outer(0.0), 2.0);
        assert_eq!(horizon_inner(0.0), 0.0);
        assert!((photon_orbit(0.0) - 3.0).abs() < 1e-14);
        assert_eq!(isco(0.0), 6.0);
        assert_eq!(ergosphere(0.9, std::f64::consts::FRAC_PI_2), 2.0);
    }

    #[test]
    fn radii_of_both_senses_bracket_schwarzschild() {
        for a in [0.1, 0.5, 0.9, 0.998] {
            assert!(photon_orbit(a) < 3.0 && photon_orbit(-a) > 3.0, "a {a}");
            assert!(isco(a) < 6.0 && isco(-a) > 6.0, "a {a}");
        }
        assert!((photon_orbit(-1.0) - 4.0).abs() < 1e-12);
        assert!((isco(-1.0) - 9.0).abs() < 1e-12);
    }

    #[test]
    fn no_circular_orbit_at_the_photon_orbit() {
        assert!(circular_orbit(0.0, 3.0).is_none());
        assert!(circular_orbit(0.5, photon_orbit(0.5) * (1.0 - 1e-9)).is_none());
        assert!(circular_orbit(0.5, photon_orbit(0.5) * (1.0 + 1e-6)).is_some());
    }

    /// About the fastest holes, beside the horizon too: where a = 1, E = 1 / sqrt(3) at r+ (Bardeen, Press & Teukolsky
    /// 1972), and the speed is 1/2. The sums agree where both ways of writing them hold.
    #[test]
    fn orbits_about_the_fastest_holes() {
        for x in [1e-2, 1e-5, 1e-8, 1e-11] {
            let orbit = circular_orbit(1.0, 1.0 + x).unwrap();
            assert!((orbit.energy * 3.0_f64.sqrt() - 1.0).abs() < 2.0 * x + 1e-4 * 1e-11 / x, "{x}: {orbit:?}");
            assert!((orbit.beta - 0.5).abs() < 2.0 * x + 1e-4 * 1e-11 / x, "{x}: {orbit:?}");
            // -1 = g_ab u^a u^b: E u^t - L u^ph = 1.
            let norm = orbit.ut * (orbit.energy - orbit.angular_velocity * orbit.angular_momentum);
            assert!((norm - 1.0).abs() < 4e-16 / (x * x) && orbit.ut > 0.5 / x, "{x}: {norm}");
        }
        for a in [0.99991, 1.0 - 1e-6, 1.0] {
            for r in [1.5, 3.0, 40.0_f64] {
                let (s, sums) = (1.0 / r.sqrt(), OrbitSums::new(a, 1.0 / r));
                let v = s.powi(3);
                assert!((sums.root - (1.0 - 3.0 * s * s + 2.0 * a * v)).abs() < 1e-15);
                assert!((sums.energy - (1.0 - 2.0 * s * s + a * v)).abs() < 1e-15);
                assert!((sums.momentum - (1.0 - 2.0 * a * v + a * a * s.powi(4))).abs() < 1e-15);
            }
        }
        assert_eq!((isco(1.0), horizon_outer(1.0), horizon_inner(-1.0)), (1.0, 1.0, 1.0));
        assert!((isco(1.0 - 1e-12) - 1.0 - 4e-12_f64.cbrt()).abs() < 1e-7);
        assert!(photon_orbit(1.0) >= 1.0 && photon_orbit(1.0) < 1.0 + 1e-15);
    }

    /// L_z = sqrt(r) (1 - 2 a v + a^2 u^2) / root and E are stationary at the ISCO.
    #[test]
    fn energy_is_stationary_at_the_isco() {
        for a in [-0.9, 0.0, 0.5, 0.99] {
            let r = isco(a);
            let energy = |r| circular_orbit(a, r).unwrap().energy;
            let slope = (energy(r + 1e-4) - energy(r - 1e-4)) / 2e-4;
            let curvature = (energy(r + 1e-2) + energy(r - 1e-2) - 2.0 * energy(r)) / 1e-4;
            assert!(slope.abs() < 1e-6 * (1.0 + curvature), "a {a}: {slope}");
        }
    }
}
