//! Files that appear whole or not at all: each is written in the same folder under another name, brought to the disk,
//! then renamed.

use super::io_error;
use crate::error::Result;
use std::borrow::Cow;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Links to links that are followed, as many as Linux does.
const MAX_LINKS: u32 = 40;
/// Most names that are tried for the temporary file. Where process numbers repeat, as in containers, files that
/// earlier processes left have the first names.
const MAX_NAMES: u32 = 10_000;

/// Lets `fill` write a file, gets it back, and puts it in the place of `path`. Errors: IO, and nothing is changed;
/// those of `fill`.
pub(super) fn with(path: &Path, fill: impl FnOnce(File) -> Result<File>) -> Result<()> {
    let place = end_of_links(path)?;
    let before = fs::metadata(&place).ok();
    if let Some(before) = &before {
        refuse_as_target(before)?;
    }
    let (temporary, file) = create_beside(&place, before.as_ref())?;
    let written = fill(file).and_then(|file| finish(file, before.as_ref()).map_err(io_error));
    let renamed = written.and_then(|()| fs::rename(&temporary, &place).map_err(io_error));
    match renamed {
        Ok(()) => sync_folder(&place).map_err(io_error),
        Err(error) => {
            // The first error is the one to report.
            let _ = fs::remove_file(&temporary);
            Err(error)
        }
    }
}

/// The path behind all symbolic links, whether or not a file is there: a rename would replace the link.
fn end_of_links(path: &Path) -> Result<Cow<'_, Path>> {
    let mut place = Cow::Borrowed(path);
    for _ in 0..MAX_LINKS {
        if !fs::symlink_metadata(&place).is_ok_and(|there| there.is_symlink()) {
            return Ok(place);
        }
        let target = fs::read_link(&place).map_err(io_error)?;
        place = Cow::Owned(folder_of(&place).join(target));
    }
    Err(io_error(format!("it is a chain of more than {MAX_LINKS} symbolic links")))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Renaming would replace what opening for writing refuses.
fn refuse_as_target(there: &Metadata) -> Result<()> {
    let why = match (there.is_dir(), there.is_file(), there.permissions().readonly()) {
        (true, _, _) => "it is a directory",
        (_, false, _) => "it is no regular file",
        (_, _, true) => "it is read-only",
        _ => return Ok(()),
    };
    Err(io_error(why))
}

/// A new file in the folder of `place`, under a name that does not depend on `place`'s: that may be as long as names
/// can be.
fn create_beside(place: &Path, before: Option<&Metadata>) -> Result<(PathBuf, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    if place.file_name().is_none() {
        return Err(io_error("it names no file"));
    }
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    never_wider(&mut options, before);
    for _ in 0..MAX_NAMES {
        let name = format!(".bhr-{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let temporary = folder_of(place).join(name);
        match options.open(&temporary) {
            Ok(file) => return Ok((temporary, file)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(io_error(error)),
        }
    }
    Err(io_error(format!("its folder holds {MAX_NAMES} left-over files .bhr-*.tmp")))
}

/// The new file is at no time accessible to more users than the old one.
#[cfg(unix)]
fn never_wider(options: &mut OpenOptions, before: Option<&Metadata>) {
    use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
    if let Some(before) = before {
        options.mode(before.mode() & 0o777);
    }
}

#[cfg(not(unix))]
fn never_wider(_: &mut OpenOptions, _: Option<&Metadata>) {}

/// Gives the file the mode of the one before it, brings it to the disk and closes it: quotas and network file systems
/// tell some errors only then.
fn finish(file: File, before: Option<&Metadata>) -> io::Result<()> {
    keep_mode(&file, before)?;
    synced(file.sync_all())?;
    close(file)
}

#[cfg(unix)]
fn keep_mode(file: &File, before: Option<&Metadata>) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let Some(before) = before else { return Ok(()) };
    // A process that may not give files away keeps the file as its own, like any new file.
    let _ = fchown(file, Some(before.uid()), Some(before.gid()));
    file.set_permissions(fs::Permissions::from_mode(before.mode() & 0o777))
}

#[cfg(not(unix))]
fn keep_mode(_: &File, _: Option<&Metadata>) -> io::Result<()> {
    Ok(())
}

/// These errors come from file systems that cannot sync, and say nothing about the data.
fn synced(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

/// Closes the file as dropping it does, but returns the error, which a drop ignores.
#[cfg(unix)]
fn close(file: File) -> io::Result<()> {
    use std::os::fd::IntoRawFd;
    // SAFETY: a descriptor that nothing else owns any more. It is closed whatever this returns.
    match unsafe { libc::close(file.into_raw_fd()) } {
        0 => Ok(()),
        _ => match io::Error::last_os_error() {
            error if error.kind() == ErrorKind::Interrupted => Ok(()),
            error => Err(error),
        },
    }
}

#[cfg(not(unix))]
fn close(file: File) -> io::Result<()> {
    drop(file);
    Ok(())
}

/// Brings the file's name to the disk, which is in its folder. A folder that may not be read is left to the system.
#[cfg(unix)]
fn sync_folder(place: &Path) -> io::Result<()> {
    match File::open(folder_of(place)) {
        Ok(folder) => synced(folder.sync_all()),
        Err(_) => Ok(()),
    }
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}
