// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light that leaves a surface by the angle to its normal: limb darkening of an atmosphere that scatters by
//! electrons. Knows no disk.

/// I(mu) / F of the light that leaves a semi-infinite plane-parallel atmosphere of free electrons, both polarisations
/// together, at mu = 0, 0.05 .. 1. (Chandrasekhar 1960, "Radiative Transfer", table XXIV.) pi F is the net flux: a
/// surface that shines alike in all directions has I / F = 1.
pub const ELECTRON_SCATTERING: [f64; 21] = [
    0.41441, 0.47490, 0.52397, 0.57001, 0.61439, 0.65770, 0.70029, 0.74234, 0.78398, 0.82530, 0.86637, 0.90722,
    0.94789, 0.98842, 1.02882, 1.06911, 1.10931, 1.14943, 1.18947, 1.22945, 1.26938,
];

/// I(mu) / F, linear between the angles of the table; `mu`: cosine of the angle to the normal, 0 .. 1, and its ends
/// beyond.
pub fn limb_darkening(mu: f64) -> f64 {
    let last = ELECTRON_SCATTERING.len() - 1;
    let x = mu.clamp(0.0, 1.0) * last as f64;
    let i = (x as usize).min(last - 1);
    let [low, high] = [ELECTRON_SCATTERING[i], ELECTRON_SCATTERING[i + 1]];
    low + (high - low) * (x - i as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both are linear between nodes: Simpson's rule is exact there.
    #[test]
    fn the_flux_is_that_of_a_surface_that_shines_alike_in_all_directions() {
        let last = ELECTRON_SCATTERING.len() - 1;
        let flux: f64 = (0..last)
            .map(|i| {
                let f = |x: f64| 2.0 * x / last as f64 * limb_darkening(x / last as f64);
                let i = i as f64;
                (f(i) + 4.0 * f(i + 0.5) + f(i + 1.0)) / (6.0 * last as f64)
            })
            .sum();
        assert!((flux - 1.0).abs() < 1e-3, "{flux}");
    }

    /// Chandrasekhar's closed form for isotropic scattering, I / F = sqrt(3) / 4 H(mu), is within 5 % of it everywhere;
    /// H is solved here from its integral equation (same book, chapter V, eq. 19 with Psi = 1/2).
    #[test]
    fn it_is_near_that_of_isotropic_scattering() {
        const COUNT: usize = 400;
        let places: [f64; COUNT] = std::array::from_fn(|i| (i as f64 + 0.5) / COUNT as f64);
        let mut h = [1.0; COUNT];
        // 1 / H(mu) = 1/2 integral of x H(x) / (x + mu), because the integral of H / 2 is 1.
        let inverse = |h: &[f64; COUNT], mu: f64| {
            places.iter().zip(h).map(|(x, h)| 0.5 * x * h / (x + mu)).sum::<f64>() / COUNT as f64
        };
        for _ in 0..200 {
            let next: [f64; COUNT] = std::array::from_fn(|i| 0.5 * (h[i] + 1.0 / inverse(&h, places[i])));
            h = next;
        }
        for (i, found) in ELECTRON_SCATTERING.iter().enumerate() {
            let mu = i as f64 / 20.0;
            let isotropic = 3.0_f64.sqrt() / 4.0 / inverse(&h, mu);
            assert!((found / isotropic - 1.0).abs() < 0.05, "{mu}: {found}, {isotropic}");
        }
    }

    #[test]
    fn between_its_angles_it_is_linear_and_beyond_them_constant() {
        assert_eq!(limb_darkening(0.0), 0.41441);
        assert_eq!(limb_darkening(-1.0), 0.41441);
        assert_eq!(limb_darkening(1.0), 1.26938);
        assert_eq!(limb_darkening(7.0), 1.26938);
        assert!((limb_darkening(0.5) - 0.86637).abs() < 1e-12);
        assert!((limb_darkening(0.975) - 0.5 * (1.22945 + 1.26938)).abs() < 1e-12);
    }
}
