// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether the libraries that wgpu loads may be handed to it. The stand-ins of ash, for functions that a Vulkan loader
//! does not have, panic in a foreign frame: nothing can catch that, and the process ends. On Windows libraries are
//! found in safe folders first. Asks them for nothing else.

use crate::platform::{NotFound, SYSTEM, System, library_function};
use std::ffi::{CStr, c_char, c_void};
use std::ptr::null_mut;

/// The loader, by the name that ash has for it, where it is a file of its own.
const LOADER: Option<&CStr> = match SYSTEM {
    System::FreeDesktop => Some(c"libvulkan.so.1"),
    System::Windows => Some(c"vulkan-1.dll"),
    _ => None,
};

/// The function of the loader's that finds all others.
const GET_PROC_ADDR: &CStr = c"vkGetInstanceProcAddr";

/// The DLLs of Windows that wgpu looks for by their names alone, which would be in the current folder and in those of
/// PATH as well; each with a function of it. Here they are found before, where nobody else puts files; those that are
/// not there wgpu is not asked for.
fn libraries(backend: wgpu::Backends) -> &'static [(&'static CStr, &'static CStr)] {
    match backend {
        _ if SYSTEM != System::Windows => &[],
        wgpu::Backends::VULKAN => &[(c"vulkan-1.dll", GET_PROC_ADDR)],
        wgpu::Backends::DX12 => &[(c"d3d12.dll", c"D3D12CreateDevice"), (c"dxgi.dll", c"CreateDXGIFactory2")],
        wgpu::Backends::GL => &[(c"opengl32.dll", c"wglCreateContext")],
        _ => &[],
    }
}

/// Why wgpu is not to be asked for adapters of an interface; `None` where it is.
pub(in crate::gpu) fn obstacle(backend: wgpu::Backends) -> Option<String> {
    if let Some(why) = libraries(backend).iter().find_map(|(library, function)| {
        let missing = library_function(library, function).err()?;
        let library = library.to_string_lossy();
        Some(match missing {
            NotFound::Library => format!("{library} is not there"),
            NotFound::Function => format!("{library} has no {}", function.to_string_lossy()),
        })
    }) {
        return Some(why);
    }
    (backend == wgpu::Backends::VULKAN && !is_usable())
        .then(|| "what is installed as its loader has no functions".into())
}

/// Whether Windows' compiler FXC is there, whose DLL wgpu looks for by its name, too.
pub(in crate::gpu) fn has_fxc() -> bool {
    SYSTEM != System::Windows || library_function(c"d3dcompiler_47.dll", c"D3DCompile").is_ok()
}

/// Why a search has found no adapter of Vulkan.
pub(in crate::gpu) fn absence() -> &'static str {
    let loader = if SYSTEM == System::FreeDesktop { LOADER } else { None };
    let Some(loader) = loader else { return "no Vulkan loader, or no driver behind it" };
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
fn is_usable() -> bool {
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
