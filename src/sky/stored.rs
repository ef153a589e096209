// SPDX-License-Identifier: MIT OR Apache-2.0
//! The host's picture of the sky as a scene keeps it: in texels, or in blocks that devices read as they are; and such
//! pictures from files.

use super::compressed::CompressedMap;
use super::map::SkyMap;
use crate::error::{Error, Result};
use crate::image::{self, FromFile, ImageRef, KeptFile, Layout};
use parking_lot::Mutex;
use std::path::Path;
use std::sync::OnceLock;

/// A picture of the whole sky in the memory of the context.
pub struct StoredMap {
    stored: Stored,
    /// The blocks in texels, once a tracer has asked for them.
    unpacked: OnceLock<SkyMap>,
    /// Held while they are unpacked.
    unpacking: Mutex<()>,
}

enum Stored {
    Texels(SkyMap),
    Blocks(CompressedMap),
}

/// A map with the file that it is from.
pub type MapFile = KeptFile<StoredMap>;

impl std::fmt::Debug for StoredMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StoredMap").field("in_blocks", &self.blocks().is_some()).finish_non_exhaustive()
    }
}

impl From<SkyMap> for StoredMap {
    fn from(map: SkyMap) -> Self {
        Self::of(Stored::Texels(map))
    }
}

impl From<CompressedMap> for StoredMap {
    fn from(map: CompressedMap) -> Self {
        Self::of(Stored::Blocks(map))
    }
}

impl StoredMap {
    fn of(stored: Stored) -> Self {
        Self { stored, unpacked: OnceLock::new(), unpacking: Mutex::new(()) }
    }

    /// The map in texels, which is kept from the first call on. Errors: OUT_OF_MEMORY.
    pub fn texels(&self) -> Result<&SkyMap> {
        let blocks = match &self.stored {
            Stored::Texels(map) => return Ok(map),
            Stored::Blocks(blocks) => blocks,
        };
        let _unpacking = self.unpacking.lock();
        if let Some(map) = self.unpacked.get() {
            return Ok(map);
        }
        let map = blocks.unpacked()?;
        Ok(self.unpacked.get_or_init(|| map))
    }

    /// Columns and rows of its finest level.
    pub fn size(&self) -> [u32; 2] {
        let finest = match &self.stored {
            Stored::Texels(map) => map.levels().first().map(|level| level.size),
            Stored::Blocks(blocks) => blocks.levels().first().map(|level| level.size),
        };
        finest.unwrap_or([0, 0])
    }

    /// The map in blocks, where it is kept so.
    pub fn blocks(&self) -> Option<&CompressedMap> {
        match &self.stored {
            Stored::Texels(_) => None,
            Stored::Blocks(blocks) => Some(blocks),
        }
    }

    /// Writes the map to a KTX2 file in blocks of BC6H, with all its levels. Errors: UNSUPPORTED for another ending
    /// than .ktx2; IO; OUT_OF_MEMORY.
    pub fn save(&self, path: &Path) -> Result<()> {
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ktx2")) {
            return Err(Error::unsupported(format!("{}: sky maps are written to .ktx2 files", path.display())));
        }
        let made;
        let levels = match &self.stored {
            Stored::Texels(map) => {
                made = CompressedMap::of(map)?;
                made.levels()
            }
            Stored::Blocks(blocks) => blocks.levels(),
        };
        image::save_blocks(levels, true, path)
    }
}

impl FromFile for StoredMap {
    /// Errors: as [`image::load`] and [`SkyMap::new`].
    fn from_file(path: &Path) -> Result<Self> {
        if let Some(file) = image::load_blocks(path)? {
            return Ok(CompressedMap::new(file)?.into());
        }
        let loaded = image::load(path)?;
        let layout = Layout::packed(loaded.format, loaded.width, loaded.height);
        Ok(SkyMap::new(&ImageRef::new(layout, loaded.pixels.as_bytes())?)?.into())
    }
}
