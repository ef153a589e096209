//! The accretion disk of a scene: where it lies, and its light at a crossing. Mirrored by `shaders/emit/disk.wgsl`.

use super::crossing::{Crossing, Emission, Shift};
use super::disk::Disk;
use super::turbulence::Turbulence;
use crate::physics::blackbody::BlackbodyTable;
use crate::physics::disk_flux::TemperatureProfile;
use crate::physics::orbit::isco;

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
