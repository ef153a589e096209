// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes instances of Vulkan that make no surfaces of Wayland, and says when they are needed.
//!
//! Mesa's layer VK_LAYER_MESA_device_select, which is on by default, connects to the Wayland display of the environment
//! whenever an instance with VK_KHR_wayland_surface is asked for its devices. Where the environment has no runtime
//! folder libwayland then prints an error to stderr, and where it hands a connected socket on (WAYLAND_SOCKET) the
//! layer takes that away from the host. So bhr's instances go without that extension there.

use ash::khr;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use wgpu::hal;
use wgpu::hal::Instance;
use wgpu::hal::api::Vulkan;
use wgpu::hal::vulkan::CreateInstanceCallback;

/// An instance, and the adapters it has.
pub(super) type InstanceAndAdapters = (Option<wgpu::Instance>, Vec<wgpu::Adapter>);

/// The bytes of a socket's path, with the zero at its end (sockaddr_un).
const LONGEST_PATH: usize = 108;

/// Whether another library of this process may connect to the Wayland display of the environment without printing
/// an error and without taking a socket that was meant for the host.
pub(super) fn may_try_wayland() -> bool {
    let [socket, display, folder] = ["WAYLAND_SOCKET", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"].map(std::env::var_os);
    is_quiet(socket.as_deref(), display.as_deref(), folder.as_deref())
}

/// The three variables are read in the way of wl_display_connect: the socket's number goes before the display's
/// name, wayland-0 where there is none, which is a path or stands in the runtime folder, whose path begins with a
/// slash.
fn is_quiet(socket: Option<&OsStr>, display: Option<&OsStr>, folder: Option<&OsStr>) -> bool {
    if socket.is_some() {
        return false;
    }
    let name = display.unwrap_or(OsStr::new("wayland-0")).as_bytes();
    let path = match (name, folder.map(OsStr::as_bytes)) {
        ([b'/', ..], _) => name.len(),
        (_, Some(folder @ [b'/', ..])) => folder.len() + 1 + name.len(),
        _ => return false,
    };
    path < LONGEST_PATH
}

/// Makes an instance and asks it, in the way of wgpu but for the extension. `None`: no system without Wayland needs it.
pub(super) fn vulkan_without_wayland(flags: wgpu::InstanceFlags) -> Option<InstanceAndAdapters> {
    let descriptor = hal::InstanceDescriptor {
        name: "wgpu",
        flags,
        memory_budget_thresholds: wgpu::MemoryBudgetThresholds::default(),
        backend_options: wgpu::BackendOptions::default(),
        telemetry: None,
        display: None,
    };
    let trim: Box<CreateInstanceCallback<'_>> =
        Box::new(|args| args.extensions.retain(|name| *name != khr::wayland_surface::NAME));
    // SAFETY: wgpu asks of the callback that it takes no feature away, as it counts on those it has enabled; it
    // looks for this extension in the list that the callback leaves, whenever it makes a surface of Wayland.
    let made = unsafe { hal::vulkan::Instance::init_with_callback(&descriptor, Some(trim)) };
    let hal = match made {
        Ok(hal) => hal,
        Err(error) => {
            log::debug!("no instance of Vulkan: {error:?}");
            return Some((None, Vec::new()));
        }
    };
    // SAFETY: the instance is alive, and goes into the wgpu instance that these adapters are then made for.
    unsafe {
        let exposed = hal.enumerate_adapters(None);
        let instance = wgpu::Instance::from_hal::<Vulkan>(hal);
        let list = exposed.into_iter().map(|mut one| {
            // Instances that come from outside have VALIDATION_INDIRECT_CALL, and would compile pipelines for
            // indirect dispatches when a device is opened; bhr makes none.
            one.capabilities.downlevel.flags.remove(wgpu::DownlevelFlags::INDIRECT_EXECUTION);
            instance.create_adapter_from_hal(one)
        });
        let list = list.collect();
        Some((Some(instance), list))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wayland_is_tried_where_a_connection_is_quiet_and_takes_nothing_from_the_host() {
        let quiet = |socket: Option<&str>, display: Option<&str>, folder: Option<&str>| {
            is_quiet(socket.map(OsStr::new), display.map(OsStr::new), folder.map(OsStr::new))
        };
        for display in [None, Some("wayland-1"), Some("")] {
            assert!(quiet(None, display, Some("/run/user/1000")), "{display:?}");
            for folder in [None, Some(""), Some("run")] {
                assert!(!quiet(None, display, folder), "{display:?} {folder:?}");
            }
        }
        assert!(quiet(None, Some("/run/wayland-7"), None));
        assert!(!quiet(Some("7"), Some("wayland-0"), Some("/run/user/1000")));
        let folder = |length: usize| format!("/{}", "x".repeat(length - 1));
        assert!(quiet(None, None, Some(&folder(LONGEST_PATH - 1 - "/wayland-0".len()))));
        assert!(!quiet(None, None, Some(&folder(LONGEST_PATH - "/wayland-0".len()))));
    }
}
