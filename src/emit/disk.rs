//! The accretion disk: geometrically thin, in the equatorial plane, on circular geodesics. As the host states it, where
//! it lies, and its light at a crossing. Mirrored by `shaders/emit/disk.wgsl`.

use super::turbulence::Turbulence;
use super::{Crossing, Emission, Shift};
use crate::error::{Error, Result};
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::disk_flux::TemperatureProfile;
use crate::physics::orbit::isco;

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

/// The disk of a scene: where it lies, and whether it has structure.
#[derive(Clone, Copy, Debug)]
pub struct ThinDisk {
    pub disk: Disk,
    /// 1/r of its outer and inner edge.
    pub u: [f64; 2],
    /// Spin as its matter meets it: its own sense of motion is +ph.
    pub matter_spin: f64,
    /// `None`: it is smooth.
    pub turbulence: Option<Turbulence>,
}

impl ThinDisk {
    /// The smooth disk about a hole of spin `spin`; no matter orbits inside the ISCO. `None`: all of it lies there.
    pub fn new(disk: &Disk, spin: f64) -> Option<Self> {
        let matter_spin = if disk.retrograde { -spin } else { spin };
        let inner = disk.inner_radius.max(isco(matter_spin));
        let u = [1.0 / disk.outer_radius, 1.0 / inner];
        (inner < disk.outer_radius).then_some(Self { disk: *disk, u, matter_spin, turbulence: None })
    }

    /// Whether nothing behind it is seen.
    pub fn is_opaque(&self) -> bool {
        self.disk.opacity == 1.0
    }
}

/// The disk with the tables of its light.
pub struct DiskLight {
    disk: ThinDisk,
    colours: &'static BlackbodyTable,
    profile: TemperatureProfile,
    /// ln Y of the hottest place.
    log_reference: f64,
}

impl DiskLight {
    pub fn new(disk: ThinDisk) -> Self {
        let colours = BlackbodyTable::shared();
        let log_reference = colours.ln_luminance(disk.disk.temperature);
        Self { disk, colours, profile: TemperatureProfile::new(disk.matter_spin), log_reference }
    }

    /// The light that a crossing on the disk adds to a ray of which the share `open` comes this far.
    pub fn at_crossing(&self, crossing: &Crossing, shift: Shift, open: f64) -> Emission {
        let ThinDisk { disk, turbulence, .. } = &self.disk;
        let rgb = self.light(crossing.u, shift);
        let structure = turbulence.map_or(1.0, |t| t.brightness(crossing.place, crossing.footprint));
        let opacity = disk.opacity * crossing.share;
        Emission { light: rgb.map(|v| open * opacity * structure * v), opacity }
    }

    /// Linear radiance of the opaque, smooth disk at 1/r = u.
    pub fn light(&self, u: f64, shift: Shift) -> [f64; 3] {
        let disk = &self.disk.disk;
        let temperature = disk.temperature * self.profile.at(1.0 / u);
        self.colours
            .shifted_blackbody(temperature, self.log_reference, shift.colour, shift.beaming)
            .map(|v| v * disk.brightness)
    }
}
