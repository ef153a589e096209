// SPDX-License-Identifier: MIT OR Apache-2.0
//! A glowing haze about the hole, the simplest emitter with depth: density e^(-r^2 / 2 R^2), at rest as the local ZAMO
//! is. It has no colour of its own and no place in the C API: it is there for the tests of light through matter.
//! Mirrored by `shaders/emit/haze.wgsl`.

use super::medium::Medium;
use crate::physics::geodesic::{Constants, State};
use crate::physics::orbit::zamo_frequency;
use crate::physics::trace::Part;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haze {
    /// R, in M; above 0.
    pub radius: f64,
    /// Light per M of its own length that matter of density 1 sends, as it measures it: linear Rec. 709, 0 and more.
    pub brightness: f64,
    /// Optical depth per M of its own length at density 1; 0 and more.
    pub absorption: f64,
}

impl Haze {
    /// Adds the haze along a part of a ray. `frequency_ratio`: nu(camera) / nu(local frame).
    pub fn along(&self, part: &Part<'_>, frequency_ratio: f64, medium: &mut Medium) {
        medium.add_part(part, |there| self.matter(part.constants, there, frequency_ratio));
    }

    /// Emission and absorption per unit of affine length at a place. Light with the same power at every frequency,
    /// I_nu ~ nu^0: I_nu / nu^3 being the same for all observers, the camera sees g^3 of what matter emits along its
    /// own length, which is nu(matter) d lambda; the optical depth is the same for all. (Rybicki & Lightman 1979, eqs.
    /// 4.110 to 4.113.)
    pub fn matter(&self, c: &Constants, there: &State, frequency_ratio: f64) -> ([f64; 3], f64) {
        let cos = there.n.z / there.n.length();
        let nu = zamo_frequency(c.a, there.u, cos, c.energy, c.angular_momentum) / c.nu_local;
        let density = (-0.5 / (there.u * self.radius).powi(2)).exp();
        let g = frequency_ratio / nu;
        ([self.brightness * density * g * g * g * nu; 3], self.absorption * density * nu)
    }
}
