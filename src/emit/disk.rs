// SPDX-License-Identifier: MIT OR Apache-2.0
//! The accretion disk as the host states it: geometrically thin, in the equatorial plane, on circular geodesics. Plain
//! data.

use crate::error::{Error, Number, Result, out_of_range};

/// The ring at whose radius the disk has its stated temperature and brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum DiskReference {
    /// The hottest ring of the Page-Thorne profile, wherever the disk's edges are.
    Hottest = 0,
    /// The ring that halves the area, r^2 = (inner^2 + outer^2) / 2, the outermost quarter of a soft outer edge's
    /// fading left out.
    Median = 1,
}

/// How the light of the disk depends on the angle to its normal, as its matter sees it. The flux is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum EmissionLaw {
    /// Alike in all directions.
    Isotropic = 0,
    /// By the law of an atmosphere that scatters by electrons (`physics::limb_darkening`).
    LimbDarkened = 1,
}

/// Radii in units of M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Matter orbits towards -phi.
    pub retrograde: bool,
    /// 0 (default): as far in as matter shines. That is the ISCO, inside which matter has no stable circular orbit, or
    /// the horizon, if it `plunges`.
    pub inner_radius: f64,
    /// Default 17.
    pub outer_radius: f64,
    /// Temperature of the ring that `reference` says, K, 500 .. 1e9. Default 3500.
    pub temperature: f64,
    /// 0 .. 1. Default 1.
    pub opacity: f64,
    /// >= 0; the luminance of that ring at rest. Default 0.6.
    pub brightness: f64,
    /// 0 smooth .. 1. Default 1.
    pub turbulence: f64,
    pub seed: u64,
    /// Default: the median ring.
    pub reference: DiskReference,
    /// 0 sharp .. 1, default 0.4: the share of the way from the outer edge to the inner one over which the disk fades
    /// out, and the flux, over that of the hottest ring, below which it is translucent at its inner edge.
    pub edge_softness: f64,
    /// Default: isotropic.
    pub emission_law: EmissionLaw,
    /// Matter shines on its way from the ISCO to the horizon, too. Default: false.
    pub plunges: bool,
}

impl Default for Disk {
    fn default() -> Self {
        Self {
            retrograde: false,
            inner_radius: 0.0,
            outer_radius: 17.0,
            temperature: 3500.0,
            opacity: 1.0,
            brightness: 0.6,
            turbulence: 1.0,
            seed: 0,
            reference: DiskReference::Median,
            edge_softness: 0.4,
            emission_law: EmissionLaw::Isotropic,
            plunges: false,
        }
    }
}

impl Disk {
    /// Largest outer radius, in M: beyond it f32 tracers could not place the crossing.
    pub const MAX_RADIUS: f64 = 1e6;
    /// Largest brightness: the light stays finite in every pixel format that can hold it.
    pub const MAX_BRIGHTNESS: f64 = 1e6;

    /// Errors: a number not finite or outside its range, outer_radius <= inner_radius.
    pub fn check(&self) -> Result<()> {
        let range = |name: &str, value: f64, low: f64, high: f64| {
            if value >= low && value <= high {
                return Ok(());
            }
            Err(out_of_range(&format!("disk {name}"), value, low, high))
        };
        range("inner_radius", self.inner_radius, 0.0, Self::MAX_RADIUS)?;
        range("outer_radius", self.outer_radius, 0.0, Self::MAX_RADIUS)?;
        if self.outer_radius <= self.inner_radius {
            return Err(Error::argument(format!(
                "disk outer_radius is {}; it must be greater than inner_radius, {}",
                Number(self.outer_radius),
                Number(self.inner_radius)
            )));
        }
        range("temperature", self.temperature, 500.0, 1e9)?;
        range("opacity", self.opacity, 0.0, 1.0)?;
        range("brightness", self.brightness, 0.0, Self::MAX_BRIGHTNESS)?;
        range("turbulence", self.turbulence, 0.0, 1.0)?;
        range("edge_softness", self.edge_softness, 0.0, 1.0)
    }
}
