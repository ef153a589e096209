// SPDX-License-Identifier: MIT OR Apache-2.0
//! What files hold that scenes name, kept while the files are as they were: a scene that is loaded again and again, as
//! by an editor's undo, reads its files once. Knows no text.

use crate::error::Result;
use std::fs::Metadata;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// A type that is read from a file.
pub trait FromFile: Sized {
    /// Errors: IO and OUT_OF_MEMORY; those of the type.
    fn from_file(path: &Path) -> Result<Self>;
}

/// A value with the file that it is from.
pub struct KeptFile<T> {
    path: PathBuf,
    stamp: Option<(u64, SystemTime)>,
    value: Arc<T>,
}

impl<T> Clone for KeptFile<T> {
    fn clone(&self) -> Self {
        Self { path: self.path.clone(), stamp: self.stamp, value: self.value.clone() }
    }
}

/// The size and the time of the last change, where the system tells it.
fn stamp(path: &Path) -> Option<(u64, SystemTime)> {
    let of = |found: Metadata| Some((found.len(), found.modified().ok()?));
    std::fs::metadata(path).ok().and_then(of)
}

impl<T: FromFile> KeptFile<T> {
    /// Reads a file, unless `kept` is of the same one, which has not changed since. Errors: as [`FromFile::from_file`].
    pub fn load(path: &Path, kept: Option<&Self>) -> Result<Self> {
        let stamp = stamp(path);
        if let Some(kept) = kept.filter(|kept| kept.path == path && stamp.is_some() && kept.stamp == stamp) {
            return Ok(kept.clone());
        }
        Ok(Self { path: path.to_owned(), stamp, value: Arc::new(T::from_file(path)?) })
    }
}

impl<T> KeptFile<T> {
    pub fn value(&self) -> &Arc<T> {
        &self.value
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a scene's value is this one.
    pub fn is_of(&self, shown: &Arc<T>) -> bool {
        Arc::ptr_eq(&self.value, shown)
    }
}
