// SPDX-License-Identifier: MIT OR Apache-2.0
//! Claims on files, by which several programs share the work on one list. Knows no frames.

use crate::ending::Ending;
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

/// A lock on a file, which tells other programs that it is being made. The system ends it with this program, however
/// that ends.
pub struct Claim {
    path: PathBuf,
    lock: Option<File>,
}

impl Claim {
    /// Claims a file for this program; `None`: another one is making it. File systems without locks let every program
    /// make every file: the bytes are the same. Errors: the lock's file cannot be made.
    pub fn on(file: &Path) -> Result<Option<Self>, Ending> {
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(".lock");
        let path = file.with_file_name(name);
        // Another user's, who was killed, may be read at least, which is enough for a lock.
        let open = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let lock = open.or_else(|error| File::open(&path).map_err(|_| error));
        let lock = lock.map_err(|error| Ending::io(&path, error))?;
        match lock.try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => Ok(None),
            Ok(()) | Err(std::fs::TryLockError::Error(_)) => Ok(Some(Self { path, lock: Some(lock) })),
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // Removed before it is unlocked: who waits for it then has a file that is none's, and finds the frame there.
        let _ = std::fs::remove_file(&self.path);
        drop(self.lock.take());
    }
}
