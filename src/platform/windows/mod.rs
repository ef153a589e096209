// SPDX-License-Identifier: MIT OR Apache-2.0
//! Windows.

#[cfg(all(target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod late;

/// The functions that this file does not have.
pub use super::bare::*;

use std::ffi::c_void;
use std::ptr::{from_ref, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};

#[link(name = "kernel32")]
unsafe extern "system" {
    fn GetModuleHandleExW(flags: u32, address: *const c_void, module: *mut *mut c_void) -> i32;
}

const GET_MODULE_HANDLE_EX_FLAG_PIN: u32 = 1;
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
