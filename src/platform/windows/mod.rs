// SPDX-License-Identifier: MIT OR Apache-2.0
//! Windows.

#[cfg(all(target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod late;

/// The functions that this file does not have.
pub use super::bare::*;

use std::ffi::{CStr, OsString, c_char, c_void};
use std::num::NonZeroIsize;
use std::os::windows::ffi::OsStringExt;
use std::path::PathBuf;
use std::ptr::{NonNull, from_ref, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};

#[link(name = "kernel32")]
unsafe extern "system" {
    fn GetModuleHandleExW(flags: u32, address: *const c_void, module: *mut *mut c_void) -> i32;
    fn GetModuleFileNameW(module: *mut c_void, name: *mut u16, size: u32) -> u32;
    fn GetCurrentThreadStackLimits(low: *mut usize, high: *mut usize);
    fn LoadLibraryExA(name: *const c_char, file: *mut c_void, flags: u32) -> *mut c_void;
    fn GetProcAddress(module: *mut c_void, name: *const c_char) -> *mut c_void;
}

#[link(name = "user32")]
unsafe extern "system" {
    fn IsWindow(window: isize) -> i32;
    #[cfg_attr(target_pointer_width = "32", link_name = "GetWindowLongW")]
    fn GetWindowLongPtrW(window: isize, index: i32) -> isize;
}

#[link(name = "ntdll")]
unsafe extern "system" {
    fn RtlDllShutdownInProgress() -> u8;
}

/// Characters of the longest path.
const LONGEST_PATH: usize = 32_768;

/// The index by which GetWindowLongPtr gives a window's HINSTANCE.
const GWLP_HINSTANCE: i32 = -6;

const GET_MODULE_HANDLE_EX_FLAG_PIN: u32 = 1;
const GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT: u32 = 2;
const GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS: u32 = 4;

/// The folders of the program, of the system, and those that the host has added by AddDllDirectory: neither the current
/// folder nor those of PATH, where anybody may have put a file of the name.
const LOAD_LIBRARY_SEARCH_DEFAULT_DIRS: u32 = 0x1000;

/// Loads a library by its name, for good; NULL where it is not there. One that the process has by this name already,
/// from wherever the host took it, is the one.
fn load(library: &CStr) -> *mut c_void {
    // SAFETY: a C string; what the library does as it is loaded is as sound as with an import.
    unsafe { LoadLibraryExA(library.as_ptr(), null_mut(), LOAD_LIBRARY_SEARCH_DEFAULT_DIRS) }
}

/// A later search for the library by its name, whoever makes it, ends with this one.
pub fn library_function(library: &CStr, function: &CStr) -> Result<NonNull<c_void>, NotFound> {
    let module = load(library);
    if module.is_null() {
        return Err(NotFound::Library);
    }
    // SAFETY: a module that stays, and a C string.
    NonNull::new(unsafe { GetProcAddress(module, function.as_ptr()) }).ok_or(NotFound::Function)
}

pub fn other_threads_are_gone() -> bool {
    // SAFETY: reads a state of the process.
    unsafe { RtlDllShutdownInProgress() != 0 }
}

pub fn window_exists(window: NonZeroIsize) -> bool {
    // SAFETY: any number will do.
    unsafe { IsWindow(window.get()) != 0 }
}

pub fn program_of_window(window: NonZeroIsize) -> Option<NonZeroIsize> {
    // SAFETY: any number will do; that of no window gives 0.
    NonZeroIsize::new(unsafe { GetWindowLongPtrW(window.get(), GWLP_HINSTANCE) })
}

static PINNED: AtomicBool = AtomicBool::new(false);

/// After a FreeLibrary that unmaps the library, threads of its own and of drivers would run into memory that is no
/// longer there. Where it is linked into a program, that is what stays.
pub fn stay_mapped() {
    if PINNED.load(Ordering::Relaxed) {
        return;
    }
    let mut module = null_mut();
    // SAFETY: the address is one of this library's, and `module` takes a handle that is not to be given back.
    let pinned = unsafe {
        GetModuleHandleExW(
            GET_MODULE_HANDLE_EX_FLAG_PIN | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
            from_ref(&PINNED).cast(),
            &raw mut module,
        )
    };
    // Where Windows refuses, the next call asks again.
    PINNED.store(pinned != 0, Ordering::Relaxed);
}

pub fn stack_left() -> Option<usize> {
    let (mut low, mut high) = (0, 0);
    // SAFETY: two numbers to be written: the bounds of the whole stack, as far as it may grow.
    unsafe { GetCurrentThreadStackLimits(&raw mut low, &raw mut high) };
    let here = (&raw const low).addr();
    (low..high).contains(&here).then(|| here - low)
}

/// Where a host lays libraries that this one is to find: the folder of this library, and that of the host's program.
pub fn folders_of_libraries() -> Vec<PathBuf> {
    let folder = |file: PathBuf| file.parent().map(PathBuf::from);
    [own_file(), std::env::current_exe().ok()].into_iter().flatten().filter_map(folder).collect()
}

/// The file that this code is in: the DLL, or the program that bhr is linked into.
fn own_file() -> Option<PathBuf> {
    let (mut module, mut name) = (null_mut(), vec![0; LONGEST_PATH]);
    // SAFETY: the address is one of this library's, and `module` takes a handle that is not to be given back; `name`
    // has the size that is said.
    let length = unsafe {
        GetModuleHandleExW(
            GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
            from_ref(&PINNED).cast(),
            &raw mut module,
        );
        GetModuleFileNameW(module, name.as_mut_ptr(), LONGEST_PATH as u32)
    };
    // Without a module the name is that of the program; a name that is cut has the whole size.
    let name = name.get(..length as usize).filter(|name| !name.is_empty() && name.len() < LONGEST_PATH)?;
    Some(OsString::from_wide(name).into())
}
