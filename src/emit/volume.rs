// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth as the host states it: where it is, how it moves, how it shines. Plain data.

use crate::error::{Error, Number, Result, out_of_range};

/// Where the matter is. c = cos th, R = r sin th, z = r c; `emit::shape` has the densities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Shape {
    /// About the equatorial plane, between two radii, with soft edges.
    Disk = 0,
    /// A ring about the axis.
    Torus = 1,
    /// About the hole.
    Halo = 2,
    /// Two hollow cones about the axis, which close up with distance.
    Jet = 3,
}

/// How the matter moves (`physics::flow`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum FlowLaw {
    /// On circles, plunging inside the ISCO; `sub_keplerian` and `infall` change that.
    Keplerian = 0,
    /// By a law of angular momentum, without radial motion.
    AngularMomentum = 1,
    /// Outwards from the inner radius.
    Outflow = 2,
}

/// Radii in units of M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Matter moves towards -phi.
    pub retrograde: bool,
    /// A power law of the frequency instead of a blackbody's light.
    pub power_law: bool,
    pub shape: Shape,
    pub flow: FlowLaw,
    /// DISK, JET: the inner edge; OUTFLOW: where matter is at rest. 0 (default): the ISCO.
    pub inner_radius: f64,
    /// The radius beyond which there is no matter, whatever the shape. Default 17.
    pub outer_radius: f64,
    /// TORUS: of the ring; HALO: the scale; JET: where it opens by `opening`. Default 8.
    pub radius: f64,
    /// TORUS: the Gaussian width in R. Default 2.
    pub width: f64,
    /// The Gaussian width in cos th; TORUS: in z, over `radius`. Default 0.05.
    pub thickness: f64,
    /// JET: half the angle of the cone at `radius`, rad. Default 0.3.
    pub opening: f64,
    /// DISK, JET: density ~ r^-slope. Default 0.7.
    pub slope: f64,
    /// Optical depth per M of the matter's own length at density 1. Default 3.
    pub absorption: f64,
    /// K, at the inner radius (DISK, JET) or at `radius`. Default 4800.
    pub temperature: f64,
    /// T ~ r^-temperature_slope. Default 0.35.
    pub temperature_slope: f64,
    /// The index of a power law: emission ~ nu^-alpha, absorption ~ nu^-(2.5 + alpha). Default 1.
    pub spectral_index: f64,
    /// The colour of a power law, linear Rec. 709. Default white.
    pub tint: [f64; 3],
    /// Default 1.
    pub brightness: f64,
    /// The share of the Keplerian angular momentum. Default 1.
    pub sub_keplerian: f64,
    /// 0 circular (default) .. 1 free fall.
    pub infall: f64,
    /// l0 of ANGULAR_MOMENTUM. Default 1.
    pub angular_momentum: f64,
    /// OUTFLOW: far away, in c. Default 0.9.
    pub speed: f64,
    /// The contrast of the structure that moves along (`emit::clouds`), 0: none. Default 1.
    pub turbulence: f64,
    /// Density ~ pattern^clumping. Default 1.8.
    pub clumping: f64,
    /// T ~ pattern^heating. Default 0.15.
    pub heating: f64,
    pub seed: u64,
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            retrograde: false,
            power_law: false,
            shape: Shape::Disk,
            flow: FlowLaw::Keplerian,
            inner_radius: 0.0,
            outer_radius: 17.0,
            radius: 8.0,
            width: 2.0,
            thickness: 0.05,
            opening: 0.3,
            slope: 0.7,
            absorption: 3.0,
            temperature: 4800.0,
            temperature_slope: 0.35,
            spectral_index: 1.0,
            tint: [1.0; 3],
            brightness: 1.0,
            sub_keplerian: 1.0,
            infall: 0.0,
            angular_momentum: 1.0,
            speed: 0.9,
            turbulence: 1.0,
            clumping: 1.8,
            heating: 0.15,
            seed: 0,
        }
    }
}

/// Names the emitter in messages about a number outside its range.
pub(super) fn range(what: &str, name: &str, value: f64, [low, high]: [f64; 2]) -> Result<()> {
    if value >= low && value <= high { Ok(()) } else { Err(out_of_range(&format!("{what} {name}"), value, low, high)) }
}

impl Volume {
    /// Most volumes of a scene.
    pub const MOST: usize = 4;
    /// Least inner radius that is stated, M: the powers of its ratio to other radii are numbers of single precision.
    pub const MIN_INNER: f64 = 1e-6;
    /// Largest radius, M.
    pub const MAX_RADIUS: f64 = 1e4;
    /// The narrowest ring, over its radius: narrower ones would need more samples than a ray takes.
    pub const NARROWEST: f64 = 0.01;

    /// Errors: a number not finite or outside its range, outer_radius <= inner_radius, a torus narrower than a
    /// hundredth of its radius.
    pub fn check(&self) -> Result<()> {
        let check = |name: &str, value: f64, limits: [f64; 2]| range("volume", name, value, limits);
        if self.inner_radius != 0.0 && !(Self::MIN_INNER..=Self::MAX_RADIUS).contains(&self.inner_radius) {
            return Err(Error::argument(format!(
                "volume inner_radius is {}; it must lie in [{}, {}], or be 0 for the ISCO",
                Number(self.inner_radius),
                Self::MIN_INNER,
                Self::MAX_RADIUS
            )));
        }
        check("outer_radius", self.outer_radius, [0.0, Self::MAX_RADIUS])?;
        if self.outer_radius <= self.inner_radius {
            return Err(Error::argument(format!(
                "volume outer_radius is {}; it must be greater than inner_radius, {}",
                Number(self.outer_radius),
                Number(self.inner_radius)
            )));
        }
        check("radius", self.radius, [0.1, Self::MAX_RADIUS])?;
        check("width", self.width, [1e-3, Self::MAX_RADIUS])?;
        if self.shape == Shape::Torus && self.width < Self::NARROWEST * self.radius {
            return Err(Error::argument(format!(
                "volume width is {}; it must be at least {} of radius, {}",
                Number(self.width),
                Self::NARROWEST,
                Number(self.radius)
            )));
        }
        check("thickness", self.thickness, [0.01, 1e6])?;
        check("opening", self.opening, [0.01, 1.5])?;
        check("slope", self.slope, [0.0, 4.0])?;
        check("absorption", self.absorption, [0.0, 1e6])?;
        check("temperature", self.temperature, [500.0, 1e9])?;
        check("temperature_slope", self.temperature_slope, [0.0, 2.0])?;
        check("spectral_index", self.spectral_index, [-4.0, 4.0])?;
        for (name, value) in ["tint[0]", "tint[1]", "tint[2]"].into_iter().zip(self.tint) {
            check(name, value, [0.0, 1.0])?;
        }
        check("brightness", self.brightness, [0.0, 1e6])?;
        check("sub_keplerian", self.sub_keplerian, [0.0, 1.0])?;
        check("infall", self.infall, [0.0, 1.0])?;
        check("angular_momentum", self.angular_momentum, [0.0, 1.0])?;
        check("speed", self.speed, [0.0, 0.995])?;
        check("turbulence", self.turbulence, [0.0, 1.0])?;
        check("clumping", self.clumping, [0.5, 3.0])?;
        check("heating", self.heating, [0.0, 0.5])
    }
}
