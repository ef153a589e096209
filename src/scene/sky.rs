// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky at infinity, as the host states it. The stars themselves are in `crate::sky`.

use crate::error::{Error, Number, Result, out_of_range};
use crate::sky::StarField;
use glam::DQuat;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// `Sky::STARS` and the other bits of `BHR_SKY_*`; 0: black.
    pub flags: u32,
    /// >= 0. Default 1.
    pub stars_brightness: f64,
    /// >= 0. Default 1.
    pub map_brightness: f64,
    /// Unit quaternion: sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) -> scene axes.
    pub orientation: DQuat,
    /// Seed of the procedural stars: any number. Default 0.
    pub seed: u64,
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            flags: Self::STARS | Self::MILKY_WAY,
            stars_brightness: 1.0,
            map_brightness: 1.0,
            orientation: DQuat::IDENTITY,
            seed: 0,
        }
    }
}

impl Sky {
    /// The real sky: the embedded star catalogue.
    pub const STARS: u32 = 1;
    /// A random sky of a million stars; with STARS, only those that are fainter than the catalogue's.
    pub const PROCEDURAL: u32 = 2;
    /// The embedded Milky Way glow.
    pub const MILKY_WAY: u32 = 4;
    /// The host's picture: `Scene::sky_map`.
    pub const MAP: u32 = 8;
    /// The coordinate grid.
    pub const GRID: u32 = 16;
    pub const MAX_BRIGHTNESS: f64 = 1e6;

    /// No stars, no glow.
    pub fn black() -> Self {
        Self { flags: 0, ..Self::default() }
    }

    /// Errors: unknown flags; brightness out of range; orientation not of unit length
    /// to within 1e-3.
    pub fn check(&self) -> Result<()> {
        let known = Self::STARS | Self::PROCEDURAL | Self::MILKY_WAY | Self::MAP | Self::GRID;
        if self.flags & !known != 0 {
            return Err(Error::argument(format!("sky flags are {:#x}; the known bits are {known:#x}", self.flags)));
        }
        for (name, value) in [("stars_brightness", self.stars_brightness), ("map_brightness", self.map_brightness)] {
            if !(0.0..=Self::MAX_BRIGHTNESS).contains(&value) {
                return Err(out_of_range(&format!("sky {name}"), value, 0.0, Self::MAX_BRIGHTNESS));
            }
        }
        let length = self.orientation.length();
        if !length.is_finite() || (length - 1.0).abs() > 1e-3 {
            let length = Number(length);
            return Err(Error::argument(format!("sky orientation has length {length}; it must be a unit quaternion")));
        }
        Ok(())
    }

    /// `None`: no stars.
    pub fn star_field(&self) -> Option<StarField> {
        match (self.flags & Self::STARS != 0, self.flags & Self::PROCEDURAL != 0) {
            (true, true) => Some(StarField::Continued(self.seed)),
            (false, true) => Some(StarField::Procedural(self.seed)),
            (true, false) => Some(StarField::Catalogue),
            (false, false) => None,
        }
    }
}
