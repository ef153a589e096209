// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of the sky from files.

use super::map::SkyMap;
use crate::error::Result;
use crate::image::{self, FromFile, ImageRef, KeptFile, Layout};
use std::path::Path;

/// A map with the file that it is from.
pub type MapFile = KeptFile<SkyMap>;

impl FromFile for SkyMap {
    /// Errors: as [`image::load`] and [`SkyMap::new`].
    fn from_file(path: &Path) -> Result<Self> {
        let loaded = image::load(path)?;
        let layout = Layout::packed(loaded.format, loaded.width, loaded.height);
        Self::new(&ImageRef::new(layout, loaded.pixels.as_bytes())?)
    }
}
