// SPDX-License-Identifier: MIT OR Apache-2.0
//! Unix: Linux, the BSDs, Android and Apple's systems, where all of them have the same calls; and what some of them
//! have besides.

#[cfg(not(target_os = "android"))]
mod cancellation;
mod descriptors;
mod files;
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "x86", target_arch = "aarch64")))]
mod stack;
#[cfg(target_os = "linux")]
mod threads;

/// The functions that the lines below do not name.
pub use super::bare::*;
#[cfg(not(target_os = "android"))]
pub use cancellation::Uncancelled;
pub use descriptors::{close_descriptor, copy_descriptor, descriptor_facts};
pub use files::{
    close_file, is_same_file, keep_mode, may_follow_link, never_wider, open_without_waiting, path_of_bytes, sync_folder,
};
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "x86", target_arch = "aarch64")))]
pub use stack::{on_enough_stack, on_host_stack};
#[cfg(target_os = "linux")]
pub use threads::{around_thread_end, lower_priority};

use std::ffi::{CStr, c_void};
use std::ptr::{NonNull, null_mut};

pub fn at_exit(handler: extern "C" fn()) {
    // SAFETY: the handler lives as long as the process, as the library is never unmapped.
    unsafe { libc::atexit(handler) };
}

pub fn library_function(library: &CStr, function: &CStr) -> Result<NonNull<c_void>, NotFound> {
    // SAFETY: both are C strings. The host's own copy is found when it has loaded the library, whose beginning is as
    // sound as that of any of the system's.
    let found = unsafe {
        let library = libc::dlopen(library.as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL);
        if library.is_null() {
            return Err(NotFound::Library);
        }
        libc::dlsym(library, function.as_ptr())
    };
    NonNull::new(found).ok_or(NotFound::Function)
}

/// The signal of a file that grows past the limit goes to the thread that writes; blocked, the write fails with
/// EFBIG, and the pending signal ends with the thread.
pub fn block_file_size_signal() {
    // SAFETY: a signal set of this function's own, and the mask of this thread.
    unsafe {
        let mut signals: libc::sigset_t = std::mem::zeroed();
        libc::sigemptyset(&mut signals);
        libc::sigaddset(&mut signals, libc::SIGXFSZ);
        libc::pthread_sigmask(libc::SIG_BLOCK, &signals, null_mut());
    }
}

/// The allocator may hold as much that was freed, but does not give it to every thread: glibc's new threads take theirs
/// from the system, and end the process where it has none.
pub fn can_be_mapped(bytes: usize) -> bool {
    let access = libc::PROT_READ | libc::PROT_WRITE;
    // SAFETY: a new mapping anywhere, which nobody knows of and nobody touches before it goes.
    unsafe {
        let place = libc::mmap(null_mut(), bytes, access, libc::MAP_PRIVATE | libc::MAP_ANON, -1, 0);
        place != libc::MAP_FAILED && libc::munmap(place, bytes) == 0
    }
}
