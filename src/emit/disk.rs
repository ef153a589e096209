//! The accretion disk as the host states it: geometrically thin, in the equatorial plane, on circular geodesics. Plain
//! data.

use crate::error::{Error, Result};

/// Radii in units of M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Matter orbits towards -phi.
    pub retrograde: bool,
    /// 0: the ISCO (default). Matter inside the ISCO has no circular orbit and does not shine: what lies there is not
    /// drawn.
    pub inner_radius: f64,
    /// Default 20.
    pub outer_radius: f64,
    /// Temperature at the hottest radius of the Page-Thorne profile, K, 500 .. 1e9. Default 6500.
    pub temperature: f64,
    /// 0 .. 1. Default 1.
    pub opacity: f64,
    /// >= 0. Default 1: the hottest ring at rest has luminance 1.
    pub brightness: f64,
    /// 0 smooth (default) .. 1.
    pub turbulence: f64,
    pub seed: u64,
}

impl Default for Disk {
    fn default() -> Self {
        Self {
            retrograde: false,
            inner_radius: 0.0,
            outer_radius: 20.0,
            temperature: 6500.0,
            opacity: 1.0,
            brightness: 1.0,
            turbulence: 0.0,
            seed: 0,
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
            Err(Error::argument(format!("disk {name} is {value}; it must lie in [{low}, {high}]")))
        };
        range("inner_radius", self.inner_radius, 0.0, Self::MAX_RADIUS)?;
        range("outer_radius", self.outer_radius, 0.0, Self::MAX_RADIUS)?;
        if self.outer_radius <= self.inner_radius {
            return Err(Error::argument(format!(
                "disk outer_radius is {}; it must be greater than inner_radius, {}",
                self.outer_radius, self.inner_radius
            )));
        }
        range("temperature", self.temperature, 500.0, 1e9)?;
        range("opacity", self.opacity, 0.0, 1.0)?;
        range("brightness", self.brightness, 0.0, Self::MAX_BRIGHTNESS)?;
        range("turbulence", self.turbulence, 0.0, 1.0)
    }
}
