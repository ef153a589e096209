// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether the Vulkan loader of this system may be handed to ash, whose stand-ins for functions that are missing panic
//! in a foreign frame: nothing can catch that, and the process ends. Asks the loader for nothing else.

use crate::platform::{NotFound, SYSTEM, System, library_function};
use std::ffi::{CStr, c_char, c_void};
use std::ptr::null_mut;

/// The loader, by the name that ash has for it, where it is a package that users install; elsewhere the system or the
/// driver brings it.
const LOADER: Option<&CStr> = match SYSTEM {
    System::FreeDesktop => Some(c"libvulkan.so.1"),
    _ => None,
};

/// The function of the loader's that finds all others.
const GET_PROC_ADDR: &CStr = c"vkGetInstanceProcAddr";

/// Why a search has found no adapter of Vulkan.
pub(in crate::gpu) fn absence() -> &'static str {
    let Some(loader) = LOADER else { return "no Vulkan loader, or no driver behind it" };
    if library_function(loader, GET_PROC_ADDR) == Err(NotFound::Library) {
        return "the Vulkan loader, libvulkan.so.1, is not installed or does not load; Debian and Ubuntu: libvulkan1";
    }
    if !is_usable() {
        return "the library libvulkan.so.1 is no Vulkan loader; Debian and Ubuntu: libvulkan1";
    }
    "the Vulkan loader knows no driver that has a device with compute shaders; Debian and Ubuntu: mesa-vulkan-drivers, \
     or the GPU's own driver"
}

/// False for a library that has not even the functions which every loader has had from the first: a stub of a
/// development kit, or a left-over. True without a loader, and without the function that finds others, which ash takes
/// well. It stays loaded, as with ash's own instances, which are kept.
pub(in crate::gpu) fn is_usable() -> bool {
    type GetProcAddr = unsafe extern "system" fn(instance: *mut c_void, name: *const c_char) -> *const c_void;
    const NEEDED: [&CStr; 3] =
        [c"vkCreateInstance", c"vkEnumerateInstanceExtensionProperties", c"vkEnumerateInstanceLayerProperties"];
    let Some(Ok(found)) = LOADER.map(|loader| library_function(loader, GET_PROC_ADDR)) else { return true };
    // SAFETY: the type is the function's (Vulkan 1.0, 4.1), and NULL the instance for these names.
    unsafe {
        let get = std::mem::transmute::<*mut c_void, GetProcAddr>(found.as_ptr());
        NEEDED.iter().all(|name| !get(null_mut(), name.as_ptr()).is_null())
    }
}
