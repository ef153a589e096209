// SPDX-License-Identifier: MIT OR Apache-2.0
//! How linear radiance becomes 8-bit pixels, as the host states it. The curves are in `crate::film`.

use crate::error::{Result, out_of_range};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ToneMap {
    None = 0,
    Aces = 1,
    Agx = 2,
}

/// The colours of a picture; the maps are in `crate::film::colour_map`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ColourMap {
    /// The light's own colours.
    None = 0,
    /// The map afmhot, for its luminance.
    Afmhot = 1,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Default `Aces`.
    pub tone_map: ToneMap,
    /// Stops, -20 .. 20. Default 0.
    pub exposure_ev: f64,
    /// Glare, 0 off .. 1: see `crate::film::bloom`. Default 0.25.
    pub bloom: f64,
    /// Full width at half maximum of a telescope's beam, in frame heights, 0 off (default) .. 1.
    pub beam_fwhm: f64,
    /// Default `None`.
    pub colour_map: ColourMap,
    /// Whether frames of a region, which cannot have glare, go without it; else they fail. True (default) until a host
    /// states a film of its own: those that never asked for glare are to get their tiles.
    pub glare_is_optional: bool,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            tone_map: ToneMap::Aces,
            exposure_ev: 0.0,
            bloom: 0.25,
            beam_fwhm: 0.0,
            colour_map: ColourMap::None,
            glare_is_optional: true,
        }
    }
}

impl Film {
    /// Errors: a number out of range.
    pub fn check(&self) -> Result<()> {
        if !(-20.0..=20.0).contains(&self.exposure_ev) {
            return Err(out_of_range("film exposure_ev", self.exposure_ev, -20.0, 20.0));
        }
        for (name, value) in [("bloom", self.bloom), ("beam_fwhm", self.beam_fwhm)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(out_of_range(&format!("film {name}"), value, 0.0, 1.0));
            }
        }
        Ok(())
    }
}
