// SPDX-License-Identifier: MIT OR Apache-2.0
//! The GPU tracer: wgpu compute, f32. Owns the device, the pipelines and the readback. Mirrors the CPU tracer in what
//! a frame shows; knows no host memory (tiles go to a sink) and nothing of C. Its rooms, each above those before it:
//! `device`, `kernel`, `lens`, `frame`; beside the last two `window`.

mod device;
mod kernel;
mod lens;
mod window;
mod frame;
mod gl_tracer;
#[cfg(target_arch = "wasm32")]
mod page;
#[cfg(test)]
mod layouts;
#[cfg(test)]
mod twins;

pub use device::adapter::{Adapter, Search, absence, adapters, check_built, forget_drivers};
pub use device::buffer::Buffer;
#[doc(hidden)]
pub use device::driver_lock;
pub use device::external::{
    AdapterIds, HOST_POINTER, HostVulkan, MemoryInfo, NOT_RUN, OPAQUE_FD, QueueLock, Release, ReleaseGuard,
    Requirements, SemaphoreKind, SemaphoreOrigin, Sharing, TargetOrigin, TargetShape, shares_nothing,
};
#[cfg(test)]
pub(crate) use device::gl_thread::GlThread;
pub(crate) use device::gl_thread::park;
pub use device::pipeline::{Kernel, Loops, ProvenFinite};
pub(crate) use device::process_end;
pub use device::readback::{MappedReadback, PendingReadback, Readback};
pub use device::semaphores::{FrameSync, GpuSemaphore, SemaphoreUse};
pub use device::sharing::{host_adapter, vulkan_requirements};
pub use device::target::{GpuTarget, TargetResource};
pub use device::texture::Texture;
pub use device::timer::{GpuTimer, read_time};
pub use device::wgpu_device::{Device, Loss, set_hangs_after};
pub use frame::passes::outputs_beside::OutputTo;
pub use frame::plan::setup::FrameTarget;
pub use frame::resources::occluder::check_occluder;
pub use frame::resources::sky_target::check_sky;
pub use frame::submission::begun_frame::{BegunFrame, ExtraCommands};
pub use frame::submission::handed::Handed;
pub use frame::submission::under_way::Submission;
pub use frame::tracer::GpuTracer;
pub use gl_tracer::GlTracer;
#[doc(hidden)]
pub use kernel::fragments::join_wgsl;
pub use kernel::kernels::KernelWaits;
#[doc(hidden)]
pub use kernel::wgsl::shader_sources;
#[cfg(target_arch = "wasm32")]
pub use page::{Canvas, CanvasTexture, in_tasks};
#[doc(hidden)]
pub use window::present::Presenter;
pub use window::swapchain::{Acquired, Swapchain};
