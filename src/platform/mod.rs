// SPDX-License-Identifier: MIT OR Apache-2.0
//! Systems behind one face: what the library asks of the system itself, and not of the files, windows or drivers that
//! other rooms are about. Each function here is there on every system. Knows nothing of bhr.

#[cfg(windows)]
mod windows;

#[cfg(windows)]
pub use windows::stay_mapped;

/// Keeps the library in the process for good: threads of its own and of drivers run on in it. ELF's linker flag
/// `nodelete` (build.rs) does that without a call.
#[cfg(not(windows))]
pub fn stay_mapped() {}
