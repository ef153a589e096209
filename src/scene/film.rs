//! How linear radiance becomes 8-bit pixels, as the host states it. The curves are in `crate::film`.

use crate::error::{Error, Result};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ToneMap {
    None = 0,
    Aces = 1,
    Agx = 2,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Default `Aces`.
    pub tone_map: ToneMap,
    /// Stops, -20 .. 20. Default 0.
    pub exposure_ev: f64,
    /// Glare, 0 off (default) .. 1: see `crate::film::bloom`.
    pub bloom: f64,
}

impl Default for Film {
    fn default() -> Self {
        Self { tone_map: ToneMap::Aces, exposure_ev: 0.0, bloom: 0.0 }
    }
}

impl Film {
    /// Errors: exposure or bloom out of range.
    pub fn check(&self) -> Result<()> {
        if !(-20.0..=20.0).contains(&self.exposure_ev) {
            return Err(Error::argument(format!("film exposure_ev is {}; it must lie in [-20, 20]", self.exposure_ev)));
        }
        if !(0.0..=1.0).contains(&self.bloom) {
            return Err(Error::argument(format!("film bloom is {}; it must lie in [0, 1]", self.bloom)));
        }
        Ok(())
    }
}
