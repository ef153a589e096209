// SPDX-License-Identifier: MIT OR Apache-2.0
//! Claims on files, by which several programs share the work on one list. Knows no frames.

use crate::ending::Ending;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

/// A lock on a file, which tells other programs that it is being made. The system ends it with this program, however
/// that ends.
pub struct Claim {
    path: PathBuf,
    lock: Option<File>,
}

impl Claim {
    /// Claims a file for this program; `None`: another one is making it. Errors: the lock's file cannot be made;
    /// `alone`, and the file system has no locks. Without `alone` such a file system lets every program make every
    /// file, which does no harm where files are replaced as a whole and have the same bytes.
    pub fn on(file: &Path, alone: bool) -> Result<Option<Self>, Ending> {
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(".lock");
        let path = file.with_file_name(name);
        loop {
            if let Tried::Said(claim) = Self::attempt(&path, alone)? {
                return Ok(claim);
            }
        }
    }

    fn attempt(path: &Path, alone: bool) -> Result<Tried, Ending> {
        // Another user's, who was killed, may be read at least, which is enough for a lock.
        let open = OpenOptions::new().create(true).truncate(false).write(true).open(path);
        let lock = open.or_else(|error| File::open(path).map_err(|_| error));
        let lock = lock.map_err(|error| Ending::io(path, error))?;
        match lock.try_lock() {
            Err(TryLockError::WouldBlock) => Ok(Tried::Said(None)),
            Err(TryLockError::Error(error)) if alone => {
                Err(Ending::io(path, format!("it cannot be locked, which a video needs: {error}")))
            }
            // Between the opening and the lock its holder may have removed it, and a third program made another.
            Ok(()) if !is_at(&lock, path) => Ok(Tried::Again),
            Ok(()) | Err(TryLockError::Error(_)) => {
                Ok(Tried::Said(Some(Self { path: path.to_owned(), lock: Some(lock) })))
            }
        }
    }
}

enum Tried {
    Said(Option<Claim>),
    /// The lock is on a file that has gone.
    Again,
}

/// Whether a file is the one that stands under a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |found: std::io::Result<std::fs::Metadata>| found.ok().map(|found| (found.dev(), found.ino()));
    let file = id(file.metadata());
    file.is_some() && file == id(std::fs::metadata(path))
}

/// Elsewhere files that are open keep their names until they are closed.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

impl Drop for Claim {
    fn drop(&mut self) {
        // Removed before it is unlocked: who waits for it then has a file that is none's, and finds the frame there.
        let _ = std::fs::remove_file(&self.path);
        drop(self.lock.take());
    }
}
