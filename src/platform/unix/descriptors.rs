// SPDX-License-Identifier: MIT OR Apache-2.0
//! File descriptors: copies, and what is behind them.

use crate::platform::bare::{DescriptorFacts, FileForm, NoCopy};
use std::io;

pub fn descriptor_facts(descriptor: i32) -> io::Result<DescriptorFacts> {
    // SAFETY: any bytes are a stat.
    let mut found = unsafe { std::mem::zeroed::<libc::stat>() };
    // SAFETY: a plain system call on a number, and a struct that lives here.
    if unsafe { libc::fstat(descriptor, &mut found) } != 0 {
        return Err(io::Error::last_os_error());
    }
    // The types of these fields are each system's own.
    let form = match found.st_mode & libc::S_IFMT {
        libc::S_IFREG => FileForm::Regular,
        libc::S_IFDIR => FileForm::Folder,
        libc::S_IFIFO => FileForm::Pipe,
        libc::S_IFSOCK => FileForm::Socket,
        libc::S_IFCHR => FileForm::CharacterDevice,
        other => FileForm::Other(other as _),
    };
    Ok(DescriptorFacts {
        form,
        device: found.st_dev as _,
        inode: found.st_ino as _,
        stands_for: found.st_rdev as _,
        bytes: found.st_size.try_into().unwrap_or(0),
    })
}

pub fn copy_descriptor(descriptor: i32) -> Result<i32, NoCopy> {
    // SAFETY: a plain system call on a number.
    let number = unsafe { libc::fcntl(descriptor, libc::F_DUPFD_CLOEXEC, 3) };
    if number >= 0 {
        return Ok(number);
    }
    let error = io::Error::last_os_error();
    match error.raw_os_error() {
        Some(libc::EMFILE | libc::ENFILE) => Err(NoCopy::TooMany(error)),
        _ => Err(NoCopy::NotOpen(error)),
    }
}

pub fn close_descriptor(descriptor: i32) {
    // SAFETY: the caller's own.
    unsafe { libc::close(descriptor) };
}
