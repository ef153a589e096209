// SPDX-License-Identifier: MIT OR Apache-2.0
//! The things that the readers and writers of all kinds of files share: limits, errors, memory, and the thread that
//! they run on.

use crate::error::{Error, ErrorKind, Result};
use crate::image::memory::{MAX_SIDE, PixelFormat};
use crate::platform::block_file_size_signal;
use crate::thread_state::begin_own_thread;
use std::fmt::Display;

/// The most bytes of pixels that a file may become: those of a 16384 x 16384 RGBA32F image.
pub(super) const MAX_LOAD_BYTES: u64 = 4 << 30;

/// The bytes for readers, tables and messages: small allocations, which cannot be refused.
const SMALL_BYTES: u64 = 1 << 20;

/// The address space that a thread takes as it begins: its stack of 2 MiB, and the heap of 64 MiB that glibc sets apart
/// for it.
const THREAD_BYTES: u64 = 72 << 20;

/// The error for EXR files in a library without the cargo feature `exr`.
#[cfg(not(feature = "exr"))]
pub(super) const WITHOUT_EXR: &str = "this library was built without EXR (its cargo feature exr)";

/// Errors of files name the path; `load` and `save` put it before these words.
pub(super) fn io_error(why: impl Display) -> Error {
    Error::new(ErrorKind::Io, why.to_string())
}

/// `error`, which happened while `doing` something with the file `path`.
pub(super) fn about(doing: &str, path: &std::path::Path, error: &Error) -> Error {
    Error::new(error.kind, format!("cannot {doing} {}: {}", path.display(), error.message))
}

/// The number of pixels of a file of this size that is to become `format`. Errors: IO for an empty one, or one past
/// the limits.
pub(super) fn pixel_count(width: u64, height: u64, format: PixelFormat) -> Result<usize> {
    if width == 0 || height == 0 {
        return Err(io_error(format!("it claims {width} x {height} pixels")));
    }
    let side = u64::from(MAX_SIDE);
    if width > side || height > side {
        return Err(io_error(format!("it claims {width} x {height} pixels; a side may have at most {side}")));
    }
    // At most 2^40 pixels.
    let bytes = width * height * format.bytes_per_pixel() as u64;
    match usize::try_from(bytes) {
        Ok(bytes) if bytes as u64 <= MAX_LOAD_BYTES => Ok(bytes / format.bytes_per_pixel()),
        _ => Err(io_error(format!(
            "it claims {width} x {height} pixels, {bytes} bytes as {format}; at most {MAX_LOAD_BYTES} are read"
        ))),
    }
}

/// An empty vector with room for `count` values. Errors: OUT_OF_MEMORY.
pub(super) fn reserve<T>(count: usize) -> Result<Vec<T>> {
    let mut room = Vec::new();
    match room.try_reserve_exact(count) {
        Ok(()) => Ok(room),
        Err(_) => Err(no_memory(count as u128 * size_of::<T>() as u128)),
    }
}

/// `count` zeros, which take no memory of the machine's until they are written: a claim that no data follow costs
/// nothing. Errors: OUT_OF_MEMORY.
pub(super) fn zeros<T: bytemuck::Zeroable>(count: usize) -> Result<Vec<T>> {
    bytemuck::allocation::try_zeroed_vec(count).map_err(|()| no_memory(count as u128 * size_of::<T>() as u128))
}

/// Fails unless `bytes` more bytes could be had right now. Codecs allocate in ways that end the process where there
/// is no memory; therefore the most that one may need is allocated, and freed again, before it starts. Errors:
/// OUT_OF_MEMORY.
pub fn probe(bytes: u64) -> Result<()> {
    match usize::try_from(bytes) {
        Ok(bytes) => reserve::<u8>(bytes).map(drop),
        Err(_) => Err(no_memory(bytes.into())),
    }
}

fn no_memory(bytes: u128) -> Error {
    Error::new(ErrorKind::OutOfMemory, format!("there are no {bytes} bytes of memory for it"))
}

/// Runs `work` on a thread that ends with it, for three reasons. Panics in a decoder are that file's error. Memory
/// that codecs keep for each thread (exr: as much as its largest block) is freed at once. And a write past the host's
/// RLIMIT_FSIZE is an error here, while elsewhere SIGXFSZ ends the process. Errors: OUT_OF_MEMORY for no thread; IO
/// for a panic; those of `work`.
pub(super) fn on_own_thread<T: Send>(work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    // A thread whose beginning lacks memory ends the process, in the standard library.
    probe(THREAD_BYTES)?;
    std::thread::scope(|scope| {
        let body = || {
            begin_own_thread();
            block_file_size_signal();
            probe(SMALL_BYTES)?;
            work()
        };
        // Panics on threads of this name are kept from stderr (`capi::entry`).
        match std::thread::Builder::new().name("bhr-file".into()).spawn_scoped(scope, body) {
            Err(error) => Err(Error::new(ErrorKind::OutOfMemory, format!("there is no thread for it: {error}"))),
            Ok(thread) => thread.join().unwrap_or_else(|payload| {
                // Dropping an unknown payload may panic.
                std::mem::forget(payload);
                Err(io_error("the codec failed on it"))
            }),
        }
    })
}
