// SPDX-License-Identifier: MIT OR Apache-2.0
//! Hot spots: glowing blobs on circular geodesics in the equatorial plane, or in free fall, as the host states them.
//! Plain data.

use super::volume::range;
use crate::error::{Error, Number, Result};
use crate::physics::world_line::Body;

/// Lengths in units of M. A spot is rigid: it keeps its shape, e^(-d^2 / 2 size^2) with d the distance from its centre
/// in chart coordinates. All of one on a circle turns with the angular velocity of its centre; all of one in free fall
/// has the velocity of its centre, as the rain observer of each place sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HotSpot {
    /// Whether the spot moves towards -phi.
    pub retrograde: bool,
    /// Whether its light is a blackbody's instead of a power law of the frequency.
    pub thermal: bool,
    /// The radius of its orbit. Inside the ISCO, where orbits are not stable, it is taken to be at the ISCO. Default 8.
    pub radius: f64,
    /// Its Gaussian width. Default 0.8.
    pub size: f64,
    /// The azimuth of its centre at scene time 0, rad. Default 0.
    pub azimuth: f64,
    /// Optical depth per M of its own length at its centre. Default 0.
    pub absorption: f64,
    /// K. Default 10000.
    pub temperature: f64,
    /// The index of a power law: emission ~ nu^-alpha, absorption ~ nu^-(2.5 + alpha). Default 1.
    pub spectral_index: f64,
    /// The colour of a power law, linear Rec. 709. Default white.
    pub tint: [f64; 3],
    /// Default 1.
    pub brightness: f64,
    /// The centre at an event, if it falls freely instead of along the circle of `radius`: in scene axes and lengths
    /// as hosts state it, in the hole's axes and M as `Volumes` shows it. Default `None`.
    pub free: Option<Body>,
}

impl Default for HotSpot {
    fn default() -> Self {
        Self {
            retrograde: false,
            thermal: false,
            radius: 8.0,
            size: 0.8,
            azimuth: 0.0,
            absorption: 0.0,
            temperature: 10_000.0,
            spectral_index: 1.0,
            tint: [1.0; 3],
            brightness: 1.0,
            free: None,
        }
    }
}

impl HotSpot {
    /// Most hot spots of a scene.
    pub const MOST: usize = 8;
    /// The density is cut off at so many sizes from the centre, where it is 2e-11.
    pub const CUT: f64 = 7.0;
    /// Largest size, over the radius.
    pub const LARGEST: f64 = 0.25;
    /// Smallest size, over the radius: smaller spots would need more samples than a ray takes.
    pub const SMALLEST: f64 = 0.005;

    /// Errors: a number not finite or outside its range; of a spot on a circle, a size of more than a quarter of the
    /// radius, or of less than a two-hundredth.
    pub fn check(&self) -> Result<()> {
        let check = |name: &str, value: f64, limits: [f64; 2]| range("hot spot", name, value, limits);
        check("radius", self.radius, [1.0, 1e3])?;
        check("size", self.size, [0.05, Self::LARGEST * 1e3])?;
        if self.free.is_none() {
            self.check_size()?;
        }
        check("azimuth", self.azimuth, [-1e6, 1e6])?;
        check("absorption", self.absorption, [0.0, 1e6])?;
        check("temperature", self.temperature, [500.0, 1e9])?;
        check("spectral_index", self.spectral_index, [-4.0, 4.0])?;
        for (name, value) in ["tint[0]", "tint[1]", "tint[2]"].into_iter().zip(self.tint) {
            check(name, value, [0.0, 1.0])?;
        }
        check("brightness", self.brightness, [0.0, 1e6])?;
        self.free.map_or(Ok(()), |body| Self::check_body(&body))
    }

    fn check_size(&self) -> Result<()> {
        if self.size > Self::LARGEST * self.radius {
            return Err(Error::argument(format!(
                "hot spot size is {}; it must be at most {} of radius, {}",
                Number(self.size),
                Self::LARGEST,
                Number(self.radius)
            )));
        }
        if self.size < Self::SMALLEST * self.radius {
            return Err(Error::argument(format!(
                "hot spot size is {}; it must be at least {} of radius, {}",
                Number(self.size),
                Self::SMALLEST,
                Number(self.radius)
            )));
        }
        Ok(())
    }

    fn check_body(body: &Body) -> Result<()> {
        let numbers = [("position", body.position), ("velocity", body.velocity)];
        for (name, vector) in numbers {
            if !vector.is_finite() {
                let [x, y, z] = vector.to_array().map(Number);
                return Err(Error::argument(format!("hot spot {name} is ({x}, {y}, {z}); it must be finite")));
            }
        }
        if body.velocity.length_squared() >= 1.0 {
            let speed = Number(body.velocity.length());
            return Err(Error::argument(format!("hot spot velocity is {speed}; it must be below 1, that of light")));
        }
        if !body.time.is_finite() {
            return Err(Error::argument(format!("hot spot time is {}; it must be finite", Number(body.time))));
        }
        Ok(())
    }
}
