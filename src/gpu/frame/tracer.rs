// SPDX-License-Identifier: MIT OR Apache-2.0
//! The GPU tracer itself: one device, and what frames and rays keep on it.

use crate::error::{Error, ErrorKind, Result};
use crate::gpu::device::adapter::Adapter;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::from_scene::Planner;
use crate::gpu::frame::resources::frame_buffers::FrameBuffers;
use crate::gpu::frame::resources::output_buffers::OutputBuffers;
use crate::gpu::frame::resources::ray_buffers::RayBuffers;
use crate::gpu::frame::resources::tables::Tables;
use crate::gpu::kernel::kernels::{KernelWaits, Kernels};
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::tracer::Backend;
use std::collections::HashSet;
use std::sync::Arc;

/// Traces on one device.
pub struct GpuTracer {
    pub(in crate::gpu) kernels: Kernels,
    /// The kernels of each kind of frame whose followers were anticipated.
    pub(in crate::gpu) anticipated: HashSet<Vec<KernelKey>>,
    /// Made when light is first shaded.
    pub(in crate::gpu) tables: Option<Tables>,
    pub(in crate::gpu) buffers: FrameBuffers,
    pub(in crate::gpu) ray_buffers: RayBuffers,
    pub(in crate::gpu) output_buffers: OutputBuffers,
    /// Goes after all that was made with it.
    pub(in crate::gpu) device: Arc<Device>,
    pub(in crate::gpu) adapter: Arc<Adapter>,
}

impl GpuTracer {
    /// Opens a device, on GL for threads without a GL context ([`Device::open`]). The first frame's pipelines are
    /// being made from now on, its sky follows with it. Errors: as `Device::open`.
    pub fn new(adapter: Adapter) -> Result<Self> {
        let device = Device::open(&adapter)?;
        Self::on(adapter, device)
    }

    /// On a device that is open. Errors: `NoAdapter` where it makes no pipelines.
    pub(in crate::gpu) fn on(adapter: Adapter, device: Device) -> Result<Self> {
        let device = Arc::new(device);
        // All of a GL device shares one context, which two threads cannot use at once; a page has one thread.
        let threads = !matches!(adapter.info.backend, Backend::Gl | Backend::WebGpu);
        let kernels = Kernels::new(device.clone(), threads, adapter.info.software);
        // Some GL drivers promise compute shaders and then translate none (seen on the H200): better known now. And a
        // device's first pipeline is made alone (`driver_lock`): the smallest, so that the large ones are made side by
        // side.
        kernels.get(KernelKind::Count).map_err(|error| Error::new(ErrorKind::NoAdapter, error.message))?;
        let mut tracer = Self {
            adapter: Arc::new(adapter),
            device,
            kernels,
            anticipated: HashSet::new(),
            tables: None,
            buffers: Default::default(),
            ray_buffers: Default::default(),
            output_buffers: Default::default(),
        };
        tracer.expect_first_frame();
        Ok(tracer)
    }

    /// For tests: waits until the pipelines that are made in the background are there, and tells how often frames
    /// found some missing.
    pub fn settled_waits(&self) -> KernelWaits {
        self.kernels.settle();
        self.kernels.waits()
    }

    /// Plans frames for the device.
    pub(in crate::gpu) fn planner(&self) -> Planner<'_> {
        Planner {
            info: &self.adapter.info,
            maps_storage: self.device.maps_storage(),
            block_side: self.device.limits().max_texture_dimension_3d,
        }
    }

    pub fn adapter(&self) -> &Arc<Adapter> {
        &self.adapter
    }

    pub fn device(&self) -> Arc<Device> {
        self.device.clone()
    }
}
