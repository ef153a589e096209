// SPDX-License-Identifier: MIT OR Apache-2.0
//! Windows.

#[cfg(all(target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod late;

/// The functions that this file does not have.
pub use super::bare::*;

use std::ffi::{OsString, c_void};
use std::os::windows::ffi::OsStringExt;
use std::path::PathBuf;
use std::ptr::{from_ref, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};

#[link(name = "kernel32")]
unsafe extern "system" {
    fn GetModuleHandleExW(flags: u32, address: *const c_void, module: *mut *mut c_void) -> i32;
    fn GetModuleFileNameW(module: *mut c_void, name: *mut u16, size: u32) -> u32;
}

/// Characters of the longest path.
const LONGEST_PATH: usize = 32_768;

const GET_MODULE_HANDLE_EX_FLAG_PIN: u32 = 1;
const GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT: u32 = 2;
const GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS: u32 = 4;

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
