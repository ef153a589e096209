// SPDX-License-Identifier: MIT OR Apache-2.0
//! File descriptors of hosts: copies for the driver to take over, and a look at what is behind one before a driver
//! reads from it. Knows no Vulkan.

use crate::error::{Error, ErrorKind, Result};

/// A copy of a descriptor of the host's, closed when it is dropped unless the driver has it.
pub(in crate::gpu) struct CopiedDescriptor {
    number: i32,
    of: i32,
}

impl CopiedDescriptor {
    /// Errors: INVALID_ARGUMENT for one that is not open; OUT_OF_MEMORY.
    pub fn new(of: i32) -> Result<Self> {
        // SAFETY: a plain system call on a number.
        let number = unsafe { libc::fcntl(of, libc::F_DUPFD_CLOEXEC, 3) };
        if number >= 0 {
            return Ok(Self { number, of });
        }
        let error = std::io::Error::last_os_error();
        match error.raw_os_error() {
            Some(libc::EMFILE | libc::ENFILE) => {
                Err(Error::new(ErrorKind::OutOfMemory, format!("handle fd {of} cannot be kept: {error}")))
            }
            _ => Err(Error::argument(format!("handle fd is {of}, which is not open: {error}"))),
        }
    }

    pub fn number(&self) -> i32 {
        self.number
    }

    /// Leaves the descriptor to the driver, which closes it from now on.
    pub fn taken(self) {
        std::mem::forget(self);
    }
}

impl Drop for CopiedDescriptor {
    fn drop(&mut self) {
        // Some drivers close what they refuse (Mesa 22.3's llvmpipe), and the number may be another file's by now.
        let file = |fd| stat(fd).map(|found| (found.st_dev, found.st_ino)).ok();
        if file(self.number).is_some_and(|copy| file(self.of) == Some(copy)) {
            // SAFETY: it is open, and the copy that was made here.
            unsafe { libc::close(self.number) };
        }
    }
}

fn stat(fd: i32) -> std::io::Result<libc::stat> {
    // SAFETY: any bytes are a stat.
    let mut found = unsafe { std::mem::zeroed::<libc::stat>() };
    // SAFETY: a plain system call on a number, and a struct that lives here.
    match unsafe { libc::fstat(fd, &mut found) } {
        0 => Ok(found),
        _ => Err(std::io::Error::last_os_error()),
    }
}

/// The kind of file that a driver passes something as, by a descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gpu) struct FileKind {
    format: libc::mode_t,
    /// The device that a device's file is; the file system that another one is on.
    device: libc::dev_t,
}

impl FileKind {
    pub fn of(fd: i32) -> Option<Self> {
        let found = stat(fd).ok()?;
        let format = found.st_mode & libc::S_IFMT;
        Some(Self { format, device: if format == libc::S_IFCHR { found.st_rdev } else { found.st_dev } })
    }

    /// That of a descriptor which is closed then.
    pub fn of_own(fd: i32) -> Option<Self> {
        let kind = Self::of(fd);
        // SAFETY: the caller's own, which nobody else knows.
        unsafe { libc::close(fd) };
        kind
    }
}

/// A driver is never asked to import another kind of file than its own. NVIDIA's (580) gave no memory any more after
/// imports of such files were tried (tests/interop/bad.c); that they were the cause is likely, not proven. `own` is
/// `None` where the driver's kind is not known.
///
/// Errors: INVALID_ARGUMENT.
pub(in crate::gpu) fn check_kind(fd: i32, own: Option<FileKind>, what: &str) -> Result<()> {
    match (FileKind::of(fd), own) {
        (Some(found), Some(own)) if found != own => {
            Err(Error::argument(format!("handle fd {fd} is no {what} of this driver: it is another kind of file")))
        }
        _ => Ok(()),
    }
}

/// Errors: INVALID_ARGUMENT for a descriptor that cannot be memory. (llvmpipe's is a regular file; it reads from any,
/// and waits for ever for a pipe's bytes.)
pub(in crate::gpu) fn check_descriptor(fd: i32, size: u64, llvmpipe: bool) -> Result<()> {
    let found = stat(fd).map_err(|error| Error::argument(format!("handle fd is {fd}, which is not open: {error}")))?;
    let kind = found.st_mode & libc::S_IFMT;
    if [libc::S_IFIFO, libc::S_IFSOCK, libc::S_IFDIR].contains(&kind) || (llvmpipe && kind != libc::S_IFREG) {
        return Err(Error::argument(format!("handle fd {fd} is no memory: a pipe, a socket or a folder")));
    }
    if llvmpipe && u64::try_from(found.st_size).unwrap_or(0) < size {
        return Err(Error::argument(format!(
            "memory allocation_size is {size}; what is behind handle fd {fd} has {} bytes",
            found.st_size
        )));
    }
    Ok(())
}
