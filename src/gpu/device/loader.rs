// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether the Vulkan loader of this system may be handed to ash, whose stand-ins for functions that are missing panic
//! in a foreign frame: nothing can catch that, and the process ends. Asks the loader for nothing else.

/// Why a search has found no adapter of Vulkan.
#[cfg(all(unix, not(target_vendor = "apple"), not(target_os = "android")))]
pub(in crate::gpu) fn absence() -> &'static str {
    // SAFETY: as below.
    let library = unsafe { libc::dlopen(c"libvulkan.so.1".as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL) };
    if library.is_null() {
        return "the Vulkan loader, libvulkan.so.1, is not installed or does not load; Debian and Ubuntu: libvulkan1";
    }
    if !is_usable() {
        return "the library libvulkan.so.1 is no Vulkan loader; Debian and Ubuntu: libvulkan1";
    }
    "the Vulkan loader knows no driver that has a device with compute shaders; Debian and Ubuntu: mesa-vulkan-drivers, \
     or the GPU's own driver"
}

/// Elsewhere the system brings the loader.
#[cfg(not(all(unix, not(target_vendor = "apple"), not(target_os = "android"))))]
pub(in crate::gpu) fn absence() -> &'static str {
    "no Vulkan loader, or no driver behind it"
}

/// False for a library that has not even the functions which every loader has had from the first: a stub of a
/// development kit, or a left-over. True without a loader, which ash takes well.
#[cfg(all(unix, not(target_vendor = "apple"), not(target_os = "android")))]
pub(in crate::gpu) fn is_usable() -> bool {
    use std::ffi::{CStr, c_char, c_void};
    use std::ptr::null_mut;
    type GetProcAddr = unsafe extern "system" fn(instance: *mut c_void, name: *const c_char) -> *const c_void;
    const NEEDED: [&CStr; 3] =
        [c"vkCreateInstance", c"vkEnumerateInstanceExtensionProperties", c"vkEnumerateInstanceLayerProperties"];
    // SAFETY: the library that ash loads, by the name that ash has for it, as sound as any of the system's. It stays
    // loaded, as with ash's own instances, which are kept. The type is the function's (Vulkan 1.0, 4.1), and NULL the
    // instance for these names.
    unsafe {
        let library = libc::dlopen(c"libvulkan.so.1".as_ptr(), libc::RTLD_NOW | libc::RTLD_LOCAL);
        if library.is_null() {
            return true;
        }
        let found = libc::dlsym(library, c"vkGetInstanceProcAddr".as_ptr());
        // ash says so itself.
        if found.is_null() {
            return true;
        }
        let get = std::mem::transmute::<*mut c_void, GetProcAddr>(found);
        NEEDED.iter().all(|name| !get(null_mut(), name.as_ptr()).is_null())
    }
}

/// Elsewhere the system brings the loader.
#[cfg(not(all(unix, not(target_vendor = "apple"), not(target_os = "android"))))]
pub(in crate::gpu) fn is_usable() -> bool {
    true
}
