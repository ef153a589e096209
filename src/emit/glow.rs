// SPDX-License-Identifier: MIT OR Apache-2.0
//! The light and the absorption of matter with depth, per unit of affine length, as the camera sees them: thermal
//! matter, and power laws of the frequency. Knows no density, no motion and no ray.
//!
//! I_nu / nu^3 is the same for all observers, and so is the optical depth. Light of frequency nu at the camera has the
//! frequency nu / g at the matter, whose own length along the ray is ds = nu(matter) d lambda. So the camera sees
//! g^3 j(nu / g) ds, behind the optical depth of alpha(nu / g) ds (Rybicki & Lightman 1979, eq. 4.110 to 4.113).

use super::crossing::Shift;
use crate::physics::blackbody::BlackbodyTable;

/// The exponent by which the absorption of a power law falls with the frequency, less that of its emission: that of
/// synchrotron light in the model of Gold et al. 2020 (ApJ 897, 148).
pub const ABSORPTION_INDEX: f64 = 2.5;

/// Coefficients are no larger: what is behind an opaque cell is taken times 0, which must not meet infinity.
const MOST: f64 = 1e100;

/// How matter shines and absorbs.
#[derive(Clone, Copy, Debug)]
pub struct Glow {
    pub power_law: bool,
    /// Per M of the matter's own length at density 1.
    pub absorption: f64,
    /// K, at the reference radius.
    pub temperature: f64,
    pub reference_radius: f64,
    pub temperature_slope: f64,
    /// ln Y of a blackbody of `temperature`.
    pub log_reference: f64,
    pub spectral_index: f64,
    /// Linear Rec. 709.
    pub tint: [f64; 3],
    pub brightness: f64,
}

/// The coefficients of emission and absorption of all matter at a place, per unit of affine length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// Linear Rec. 709, as the camera sees it.
    pub light: [f64; 3],
    /// I_nu at the camera's frequency, where power laws send 1 per M at density 1.
    pub intensity: f64,
    /// Optical depth.
    pub absorption: f64,
}

impl Coefficients {
    pub fn add(&mut self, other: Self) {
        (0..3).for_each(|c| self.light[c] += other.light[c]);
        self.intensity += other.intensity;
        self.absorption += other.absorption;
    }

    /// The sum along a stretch of the affine length `length`.
    pub fn along(self, length: f64) -> Self {
        Self {
            light: self.light.map(|v| v * length),
            intensity: self.intensity * length,
            absorption: self.absorption * length,
        }
    }
}

impl Glow {
    /// Matter of density `density` at the radius `r`, which measures the frequency `nu`, that of the local frame's
    /// observer being 1. `g`: nu(camera) / nu(matter); `shift`: as the effects let it show, which is in the light only.
    /// `heat`: a factor on the temperature.
    pub fn coefficients(&self, density: f64, heat: f64, r: f64, nu: f64, g: f64, shift: Shift) -> Coefficients {
        if self.power_law {
            self.power_law(density * nu, g, shift)
        } else {
            let temperature = heat * self.temperature * (r / self.reference_radius).powf(-self.temperature_slope);
            self.thermal(density * nu, temperature, shift)
        }
    }

    /// j = alpha B(T): the opaque light of matter is a blackbody's of g T. Its absorption is the same at every
    /// frequency.
    fn thermal(&self, column: f64, temperature: f64, shift: Shift) -> Coefficients {
        let absorption = (self.absorption * column).min(MOST);
        let rgb =
            BlackbodyTable::shared().shifted_blackbody(temperature, self.log_reference, shift.colour, shift.beaming);
        Coefficients { light: rgb.map(|v| (v * self.brightness * absorption).min(MOST)), intensity: 0.0, absorption }
    }

    /// j = (nu / nu_camera)^-alpha, absorption = A (nu / nu_camera)^-(2.5 + alpha): all of it at the one frequency of
    /// the camera, whatever the colour that stands for it.
    fn power_law(&self, column: f64, g: f64, shift: Shift) -> Coefficients {
        let log = g.ln();
        let intensity = (column * (log * (3.0 + self.spectral_index)).exp()).min(MOST);
        // Bounded before it is multiplied by a brightness that may be 0.
        let seen = (column * shift.beaming.powi(3) * shift.colour.powf(self.spectral_index)).min(MOST);
        let seen = (seen * self.brightness).min(MOST);
        Coefficients {
            light: self.tint.map(|v| v * seen),
            intensity,
            absorption: (self.absorption * column * (log * (ABSORPTION_INDEX + self.spectral_index)).exp()).min(MOST),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLOW: Glow = Glow {
        power_law: true,
        absorption: 0.4,
        temperature: 6000.0,
        reference_radius: 8.0,
        temperature_slope: 0.5,
        log_reference: 0.0,
        spectral_index: 1.5,
        tint: [1.0, 0.5, 0.25],
        brightness: 2.0,
    };

    fn all(g: f64) -> Shift {
        Shift { colour: g, beaming: g }
    }

    /// With nu' = nu / g: I_nu of the camera is g^3 j(nu'), and the optical depth that of nu'.
    #[test]
    fn power_laws_are_shifted_as_the_invariant_says() {
        let (g, nu, density) = (1.3_f64, 0.8, 0.2);
        let found = GLOW.coefficients(density, 1.0, 5.0, nu, g, all(g));
        let there: f64 = 1.0 / g;
        assert!((found.intensity / (g.powi(3) * density * nu * there.powf(-1.5)) - 1.0).abs() < 1e-12);
        assert!((found.absorption / (0.4 * density * nu * there.powf(-4.0)) - 1.0).abs() < 1e-12);
        assert!((found.light[1] / found.intensity - 1.0).abs() < 1e-12 && found.light[0] == 2.0 * found.light[1]);
        // Effects change light, not what there is.
        let flat = GLOW.coefficients(density, 1.0, 5.0, nu, g, Shift { colour: 1.0, beaming: 1.0 });
        assert_eq!((flat.intensity, flat.absorption), (found.intensity, found.absorption));
        assert!((flat.light[1] / (density * nu) - 1.0).abs() < 1e-12);
    }

    /// However large the shift and the numbers are: an infinite coefficient behind an opaque cell would be NaN.
    #[test]
    fn coefficients_are_finite() {
        let bright = Glow { absorption: 1e6, brightness: 1e6, spectral_index: 4.0, ..GLOW };
        for glow in [bright, Glow { power_law: false, temperature: 500.0, temperature_slope: 2.0, ..bright }] {
            for g in [1e-100, 1.0, 1e100] {
                let found = glow.coefficients(1.0, 1.0, 1e-3, 1.0 / g, g, all(g));
                assert!(found.light.into_iter().chain([found.intensity, found.absorption]).all(f64::is_finite), "{g}");
            }
        }
    }

    /// Light over absorption is a blackbody's of g T; at the reference radius, at rest, its luminance is the
    /// brightness.
    #[test]
    fn thermal_matter_has_a_blackbody_for_its_source() {
        let table = BlackbodyTable::shared();
        let glow = Glow { power_law: false, log_reference: table.ln_luminance(6000.0), ..GLOW };
        let luminance = |s: Coefficients| 0.2126 * s.light[0] + 0.7152 * s.light[1] + 0.0722 * s.light[2];
        let rest = glow.coefficients(0.3, 1.0, 8.0, 1.0, 1.0, all(1.0));
        assert!((luminance(rest) / rest.absorption - 2.0).abs() < 1e-3, "{rest:?}");
        assert!((rest.absorption - 0.12).abs() < 1e-15 && rest.intensity == 0.0);
        let seen = glow.coefficients(0.3, 1.1, 2.0, 0.5, 0.7, all(0.7));
        let expected = table.shade(0.7 * 1.1 * 12_000.0, 6000.0);
        for (light, expected) in seen.light.iter().zip(expected) {
            assert!((light / seen.absorption / 2.0 / expected - 1.0).abs() < 1e-9, "{seen:?}");
        }
    }
}
