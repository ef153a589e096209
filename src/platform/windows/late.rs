// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions of opengl32.dll and dxgi.dll, which servers and containers may not have. wgpu names them as imports, and
//! Windows loads no library of which an import is missing. So the linker takes those of this file instead (`--wrap`, in
//! build.rs), which look for their DLL when they are called, and fail without it as they do where there is no driver.

use std::arch::global_asm;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicPtr, Ordering};

#[link(name = "kernel32")]
unsafe extern "system" {
    fn GetProcAddress(module: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// The HRESULT of a module that is not there.
const MODULE_NOT_FOUND: i32 = 0x8007_007e_u32.cast_signed();

/// The function, which `known` keeps; NULL where the DLL is not there, and the system's last error says so.
fn find(dll: &CStr, function: &CStr, known: &AtomicPtr<c_void>) -> *mut c_void {
    let found = known.load(Ordering::Relaxed);
    if !found.is_null() {
        return found;
    }
    // SAFETY: C strings; what the DLL does as it is loaded is as sound as with an import. It stays loaded.
    let found = unsafe {
        match super::load(dll) {
            module if module.is_null() => module,
            module => GetProcAddress(module, function.as_ptr()),
        }
    };
    known.store(found, Ordering::Relaxed);
    found
}

#[cfg(target_arch = "x86_64")]
macro_rules! jump {
    () => {
        "jmp {0}"
    };
}

#[cfg(target_arch = "aarch64")]
macro_rules! jump {
    () => {
        "b {0}"
    };
}

/// A function, and its result where it is not there. A symbol of assembly is not exported from the library.
macro_rules! late {
    ($dll:literal, $text:literal, $name:ident($($argument:ident: $type:ty),*) -> $result:ty, $missing:expr) => {
        #[allow(non_snake_case, reason = "the name of Windows' function")]
        unsafe extern "system" fn $name($($argument: $type),*) -> $result {
            static KNOWN: AtomicPtr<c_void> = AtomicPtr::new(null_mut());
            type Function = unsafe extern "system" fn($($type),*) -> $result;
            let found = find($dll, $text, &KNOWN);
            if found.is_null() {
                return $missing;
            }
            // SAFETY: the function has this type (Windows' headers), and its caller keeps to what it asks for.
            unsafe { std::mem::transmute::<*mut c_void, Function>(found)($($argument),*) }
        }

        global_asm!(
            ".text",
            concat!(".globl __wrap_", stringify!($name)),
            concat!("__wrap_", stringify!($name), ":"),
            jump!(),
            sym $name
        );
    };
}

late!(
    c"dxgi.dll",
    c"CreateDXGIFactory1",
    CreateDXGIFactory1(id: *const c_void, made: *mut *mut c_void) -> i32,
    MODULE_NOT_FOUND
);
late!(c"opengl32.dll", c"wglCreateContext", wglCreateContext(device: *mut c_void) -> *mut c_void, null_mut());
late!(c"opengl32.dll", c"wglDeleteContext", wglDeleteContext(context: *mut c_void) -> i32, 0);
late!(c"opengl32.dll", c"wglGetCurrentContext", wglGetCurrentContext() -> *mut c_void, null_mut());
late!(c"opengl32.dll", c"wglGetProcAddress", wglGetProcAddress(name: *const c_char) -> *mut c_void, null_mut());
late!(c"opengl32.dll", c"wglMakeCurrent", wglMakeCurrent(device: *mut c_void, context: *mut c_void) -> i32, 0);
