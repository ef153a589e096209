// SPDX-License-Identifier: MIT OR Apache-2.0
//! File descriptors of hosts: copies for the driver to take over, and a look at what is behind one before a driver
//! reads from it. Knows no Vulkan.

use crate::error::{Error, ErrorKind, Result};
use crate::platform::{DescriptorFacts, FileForm, NoCopy, close_descriptor, copy_descriptor, descriptor_facts};

/// A copy of a descriptor of the host's, closed when it is dropped unless the driver has it.
pub(in crate::gpu) struct CopiedDescriptor {
    number: i32,
    of: i32,
}

impl CopiedDescriptor {
    /// Errors: INVALID_ARGUMENT for one that is not open; OUT_OF_MEMORY.
    pub fn new(of: i32) -> Result<Self> {
        copy_descriptor(of).map(|number| Self { number, of }).map_err(|why| match why {
            NoCopy::TooMany(error) => {
                Error::new(ErrorKind::OutOfMemory, format!("handle fd {of} cannot be kept: {error}"))
            }
            NoCopy::NotOpen(error) => Error::argument(format!("handle fd is {of}, which is not open: {error}")),
        })
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
        let file = |fd| descriptor_facts(fd).map(|found| (found.device, found.inode)).ok();
        if file(self.number).is_some_and(|copy| file(self.of) == Some(copy)) {
            // The number is open, and the copy that was made here.
            close_descriptor(self.number);
        }
    }
}

/// The kind of file that a driver passes something as, by a descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gpu) struct FileKind {
    form: FileForm,
    /// The device that a device's file is; the file system that another one is on.
    device: u64,
}

impl FileKind {
    pub fn of(fd: i32) -> Option<Self> {
        let DescriptorFacts { form, device, stands_for, .. } = descriptor_facts(fd).ok()?;
        Some(Self { form, device: if form == FileForm::CharacterDevice { stands_for } else { device } })
    }

    /// That of a descriptor which is closed then.
    pub fn of_own(fd: i32) -> Option<Self> {
        let kind = Self::of(fd);
        close_descriptor(fd);
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
    let found = descriptor_facts(fd)
        .map_err(|error| Error::argument(format!("handle fd is {fd}, which is not open: {error}")))?;
    let form = found.form;
    if matches!(form, FileForm::Pipe | FileForm::Socket | FileForm::Folder) || (llvmpipe && form != FileForm::Regular) {
        return Err(Error::argument(format!("handle fd {fd} is no memory: a pipe, a socket or a folder")));
    }
    if llvmpipe && found.bytes < size {
        return Err(Error::argument(format!(
            "memory allocation_size is {size}; what is behind handle fd {fd} has {} bytes",
            found.bytes
        )));
    }
    Ok(())
}
