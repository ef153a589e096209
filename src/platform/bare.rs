// SPDX-License-Identifier: MIT OR Apache-2.0
//! A system of which nothing is known: every function of the face, as far as it goes without one. Each says what it is
//! to do where the system can. A system's own file begins with all of these and puts its own in their places.

use std::ffi::CStr;
use std::fs::{File, Metadata, OpenOptions};
use std::io;
use std::num::NonZeroIsize;
use std::path::{Path, PathBuf};
use std::ptr::NonNull;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

// ---- time ----

/// A clock that only goes forward.
pub use std::time::Instant;

/// Waits at most so long for what comes. Errors: it has not come, or never will.
pub fn receive_within<T>(from: &Receiver<T>, time: Duration) -> Result<T, RecvTimeoutError> {
    from.recv_timeout(time)
}

// ---- windows ----

/// Whether a window of Windows, by its HWND, is still there, as far as the system tells: numbers are used again, and a
/// new window may have that of one that has gone.
pub fn window_exists(_window: NonZeroIsize) -> bool {
    true
}

/// The program or DLL, by its HINSTANCE, that has made a window of Windows.
pub fn program_of_window(_window: NonZeroIsize) -> Option<NonZeroIsize> {
    None
}

// ---- the process ----

/// The number of the process, another one in each.
pub use std::process::id as process_id;

/// Keeps the library in the process for good: threads of its own and of drivers run on in it. ELF's linker flag
/// `nodelete` (build.rs) does that without a call.
pub fn stay_mapped() {}

/// Has `handler` run when the process ends by exit() or by returning from main, before the handlers that were there
/// already. Here nothing runs: a system may have ended all other threads by then, as Windows has.
pub fn at_exit(_handler: extern "C" fn()) {}

/// Whether the process ends and its other threads were ended where they were, as Windows does before libraries hear of
/// the end: a lock that one of them had stays locked, and what they were to do is never done.
pub fn other_threads_are_gone() -> bool {
    false
}

/// A function of a library that is looked for in the system's way, and stays loaded. Errors: what is not there.
pub fn library_function(_library: &CStr, _function: &CStr) -> Result<NonNull<std::ffi::c_void>, NotFound> {
    Err(NotFound::Library)
}

/// Where a host lays libraries that this one is to find: the folder of this library, and that of the host's program.
/// None where the system's loader looks for libraries in places of its own.
pub fn folders_of_libraries() -> Vec<PathBuf> {
    Vec::new()
}

/// The part that [`library_function`] does not find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotFound {
    Library,
    Function,
}

// ---- threads ----

/// This thread is not cancelled (pthread_cancel) for as long as this value lives. Nobody cancels a thread here.
pub struct Uncancelled;

impl Uncancelled {
    pub fn begin() -> Self {
        Self
    }
}

/// Does `work` on this thread where it has stack enough for anything that the library does. `work` must not unwind. An
/// error gives it back: there is no memory for a stack. Here threads have what they have: on macOS and Windows 512 KiB
/// at least, unless their host wants less.
pub fn on_enough_stack<T, F: FnOnce() -> T>(work: F) -> Result<T, F> {
    Ok(work())
}

/// The bytes of stack that this thread, or this fiber, has left. None where the system does not say, and where
/// [`on_enough_stack`] sees to it that there are enough.
pub fn stack_left() -> Option<usize> {
    None
}

/// Runs code of the host's on the host's stack, where the thread was given another. `code` must not unwind.
pub fn on_host_stack<T>(code: impl FnOnce() -> T) -> T {
    code()
}

/// To be called by a thread before it uses a library that has handlers for the end of threads: `before` runs on it
/// before those handlers, and `after` when they are done. All calls of a process must name the same two functions.
pub fn around_thread_end(_before: fn(), _after: fn()) {}

/// Lowers the priority of this thread by so many of the steps that `nice` counts.
pub fn lower_priority(_steps: i32) {}

/// From now on a write of this thread's past the limit of files' sizes is an error, and no signal.
pub fn block_file_size_signal() {}

// ---- memory ----

/// Whether the system would give this much memory just now, to any thread.
pub fn can_be_mapped(bytes: usize) -> bool {
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}

// ---- files ----

/// A path as the system has it, of any bytes where they may be such; here they are UTF-8, or there is none.
pub fn path_of_bytes(bytes: &[u8]) -> Option<PathBuf> {
    std::str::from_utf8(bytes).ok().map(PathBuf::from)
}

/// Whether a program should follow a symbolic link in a folder to where it is to write.
pub fn may_follow_link(_link: &Metadata, _folder: &Path) -> io::Result<bool> {
    Ok(true)
}

/// Has a file opened without waiting: a FIFO does not hold the caller up.
pub fn open_without_waiting(_options: &mut OpenOptions) {}

/// Whether both are the same file; true where nothing tells.
pub fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// A file that these options create in the place of another is at no time accessible to more users than that one.
pub fn never_wider(_options: &mut OpenOptions, _before: Option<&Metadata>) {}

/// Gives a file the mode of the one before it and, where the process may, its owner.
pub fn keep_mode(_: &File, _before: Option<&Metadata>) -> io::Result<()> {
    Ok(())
}

/// Closes the file as dropping it does, but returns the error, which a drop ignores.
pub fn close_file(file: File) -> io::Result<()> {
    drop(file);
    Ok(())
}

/// Brings the names in a folder to the disk, as far as the system does that.
pub fn sync_folder(_: &Path) {}

// ---- file descriptors, by which hosts pass memory and semaphores ----

/// The facts about what is behind a descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DescriptorFacts {
    pub form: FileForm,
    /// The file system and the number of the file on it.
    pub device: u64,
    pub inode: u64,
    /// The device that a device's file stands for.
    pub stands_for: u64,
    pub bytes: u64,
}

/// Forms of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileForm {
    Regular,
    Folder,
    Pipe,
    Socket,
    /// A device that is read byte by byte, as GPUs are.
    CharacterDevice,
    /// Another one, by the system's number.
    Other(u32),
}

/// A descriptor that could not be copied.
#[derive(Debug)]
pub enum NoCopy {
    /// The process, or the system, has no more.
    TooMany(io::Error),
    NotOpen(io::Error),
}

fn no_descriptors() -> io::Error {
    io::Error::new(io::ErrorKind::Unsupported, "file descriptors are there on Unix only")
}

/// Errors: the system's reason; one that is not open.
pub fn descriptor_facts(_descriptor: i32) -> io::Result<DescriptorFacts> {
    Err(no_descriptors())
}

/// A descriptor of the same file, which is closed in programs that this process becomes.
pub fn copy_descriptor(_descriptor: i32) -> Result<i32, NoCopy> {
    Err(NoCopy::NotOpen(no_descriptors()))
}

/// Closes a descriptor that is the caller's.
pub fn close_descriptor(_descriptor: i32) {}
