// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of Unix: links, modes and owners.

use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::os::fd::IntoRawFd;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt, PermissionsExt, fchown};
use std::path::{Path, PathBuf};

pub fn path_of_bytes(bytes: &[u8]) -> Option<PathBuf> {
    Some(OsStr::from_bytes(bytes).into())
}

/// In folders such as /tmp anyone may leave a link in the way of a file that is about to be written. There only links
/// of this user and of the folder's owner are followed, as Linux does it with fs.protected_symlinks.
pub fn may_follow_link(link: &Metadata, folder: &Path) -> io::Result<bool> {
    let folder = fs::metadata(folder)?;
    // The folder is sticky, and all may write in it.
    let shared = folder.mode() & 0o1002 == 0o1002;
    // SAFETY: it has no conditions.
    let user = unsafe { libc::geteuid() };
    Ok(!shared || link.uid() == user || link.uid() == folder.uid())
}

pub fn open_without_waiting(options: &mut OpenOptions) {
    options.custom_flags(libc::O_NONBLOCK);
}

pub fn is_same_file(a: &Metadata, b: &Metadata) -> bool {
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

pub fn never_wider(options: &mut OpenOptions, before: Option<&Metadata>) {
    if let Some(before) = before {
        // The file has another group until `keep_mode`.
        options.mode(before.mode() & 0o707);
    }
}

pub fn keep_mode(file: &File, before: Option<&Metadata>) -> io::Result<()> {
    let Some(before) = before else { return Ok(()) };
    // The owner is set where this process may; else the file becomes its own, as any new file does, and its group's if
    // need be: that group is not given the rights of the group before it.
    let _ = fchown(file, Some(before.uid()), Some(before.gid())).or_else(|_| fchown(file, None, Some(before.gid())));
    let now = file.metadata()?;
    let mode = before.mode() & if now.gid() == before.gid() { 0o777 } else { 0o707 };
    match now.mode() & 0o7777 == mode {
        true => Ok(()),
        false => file.set_permissions(fs::Permissions::from_mode(mode)),
    }
}

pub fn close_file(file: File) -> io::Result<()> {
    // SAFETY: a descriptor that nothing else owns any more. It is closed whatever this returns.
    match unsafe { libc::close(file.into_raw_fd()) } {
        0 => Ok(()),
        _ => match io::Error::last_os_error() {
            error if error.kind() == ErrorKind::Interrupted => Ok(()),
            error => Err(error),
        },
    }
}

/// Errors stay with the system, as does a folder that may not be read.
pub fn sync_folder(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}
