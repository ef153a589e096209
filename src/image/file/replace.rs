// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that appear whole or not at all: each is written in the same folder under another name, brought to the disk,
//! then renamed.

use super::support::io_error;
use crate::error::Result;
use crate::platform::{
    close_file, is_same_file, keep_mode, may_follow_link, never_wider, open_without_waiting, sync_folder,
};
use std::borrow::Cow;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// The most links to links that are followed, as many as Linux follows.
const MAX_LINKS: u32 = 40;
/// Most names that are tried for the temporary file. Where process numbers repeat, as in containers, files that
/// earlier processes left have the first names.
const MAX_NAMES: u32 = 10_000;

/// Lets `fill` write a file, gets it back, and puts it in the place of `path`. Errors: IO, and nothing is changed;
/// those of `fill`.
pub(super) fn with(path: &Path, fill: impl FnOnce(File) -> Result<File>) -> Result<()> {
    let place = end_of_links(path)?;
    let before = older(path, &place)?;
    let (temporary, file) = create_beside(&place, before.as_ref())?;
    let file = fill(file)?;
    finish(file, before.as_ref()).map_err(io_error)?;
    temporary.rename(&place).map_err(io_error)?;
    // The name is on the disk when its folder is. The file is in its place by now: an error would say that it is not.
    sync_folder(folder_of(&place));
    Ok(())
}

/// The temporary file; it is removed where writing or renaming it fails or panics.
struct Temporary {
    path: PathBuf,
    renamed: bool,
}

impl Temporary {
    fn rename(mut self, place: &Path) -> io::Result<()> {
        fs::rename(&self.path, place)?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // The error that is told is the first one.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The path behind all symbolic links, whether or not a file is there: a rename would replace the link.
fn end_of_links(path: &Path) -> Result<Cow<'_, Path>> {
    let mut place = Cow::Borrowed(path);
    for _ in 0..MAX_LINKS {
        let Some(link) = fs::symlink_metadata(&place).ok().filter(Metadata::is_symlink) else { return Ok(place) };
        if !may_follow_link(&link, folder_of(&place)).map_err(io_error)? {
            let link = place.display();
            return Err(io_error(format!("{link} is a symbolic link of another user in a folder that all may write")));
        }
        let target = fs::read_link(&place).map_err(io_error)?;
        place = Cow::Owned(folder_of(&place).join(target));
    }
    Err(io_error(format!("it is a chain of more than {MAX_LINKS} symbolic links")))
}

/// The file at `place`, which `path` leads to, if there is one. It is opened for writing, and nothing is written: so
/// the system refuses what it would refuse any program that writes by that path (permissions, links, read-only file
/// systems, immutable files), and a rename would do.
fn older(path: &Path, place: &Path) -> Result<Option<Metadata>> {
    let before = match fs::metadata(place) {
        Ok(before) => before,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(io_error(error)),
    };
    // The kind of the file is looked at before it is opened, which devices may take for a command.
    refuse_as_target(&before)?;
    let mut options = OpenOptions::new();
    open_without_waiting(options.write(true));
    let opened = options.open(path).and_then(|file| file.metadata()).map_err(io_error)?;
    refuse_as_target(&opened)?;
    match is_same_file(&before, &opened) {
        true => Ok(Some(opened)),
        false => Err(io_error("it became another file just now")),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Renaming would replace what is no file, and what is marked read-only, which root may open all the same.
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
fn create_beside(place: &Path, before: Option<&Metadata>) -> Result<(Temporary, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    if place.file_name().is_none() {
        return Err(io_error("it names no file"));
    }
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    never_wider(&mut options, before);
    for _ in 0..MAX_NAMES {
        let name = format!(".bhr-{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = folder_of(place).join(name);
        match options.open(&path) {
            Ok(file) => return Ok((Temporary { path, renamed: false }, file)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(io_error(error)),
        }
    }
    Err(io_error(format!("its folder holds {MAX_NAMES} left-over files .bhr-*.tmp")))
}

/// Gives the file the mode of the one before it, brings it to the disk and closes it: quotas and network file systems
/// tell some errors only then.
fn finish(file: File, before: Option<&Metadata>) -> io::Result<()> {
    keep_mode(&file, before)?;
    synced(file.sync_all())?;
    close_file(file)
}

/// These errors come from file systems that cannot sync, and say nothing about the data.
fn synced(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}
