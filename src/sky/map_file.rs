// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of the sky from files, kept while their files are as they were: a scene that is loaded again and again, as by
//! an editor's undo, reads its map once. Knows no text.

use super::map::SkyMap;
use crate::error::Result;
use crate::image::{self, ImageRef, Layout};
use std::fs::Metadata;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// A map with the file that it is from.
#[derive(Clone)]
pub struct MapFile {
    path: PathBuf,
    stamp: Option<(u64, SystemTime)>,
    map: Arc<SkyMap>,
}

/// The size and the time of the last change, where the system tells it.
fn stamp(path: &Path) -> Option<(u64, SystemTime)> {
    let of = |found: Metadata| Some((found.len(), found.modified().ok()?));
    std::fs::metadata(path).ok().and_then(of)
}

impl MapFile {
    /// Reads a map, unless `kept` is of the same file, which has not changed since. Errors: as [`image::load`] and
    /// [`SkyMap::new`].
    pub fn load(path: &Path, kept: Option<&Self>) -> Result<Self> {
        let stamp = stamp(path);
        if let Some(kept) = kept.filter(|kept| kept.path == path && stamp.is_some() && kept.stamp == stamp) {
            return Ok(kept.clone());
        }
        let loaded = image::load(path)?;
        let layout = Layout::packed(loaded.format, loaded.width, loaded.height);
        let map = SkyMap::new(&ImageRef::new(layout, loaded.pixels.as_bytes())?)?;
        Ok(Self { path: path.to_owned(), stamp, map: Arc::new(map) })
    }

    pub fn map(&self) -> &Arc<SkyMap> {
        &self.map
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a scene's map is this one.
    pub fn is_of(&self, shown: &Arc<SkyMap>) -> bool {
        Arc::ptr_eq(&self.map, shown)
    }
}
