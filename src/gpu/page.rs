// SPDX-License-Identifier: MIT OR Apache-2.0
//! The GPU tracer in a page, where nothing may wait: adapter and device are awaited, and so is what was submitted.
//! Frames go straight into the textures of canvases.

use super::device::adapter::{Adapter, device_descriptor};
use super::device::wgpu_device::Device;
use super::frame::plan::setup::FrameTarget;
use super::frame::tracer::GpuTracer;
use super::kernel::variant::StoredFormat;
use crate::error::{Error, ErrorKind, Result};
use std::future::poll_fn;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};

fn none(why: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::NoAdapter, format!("WebGPU: {why}"))
}

impl GpuTracer {
    /// Opens the adapter that the browser gives. Errors: `NoAdapter`.
    pub async fn of_page() -> Result<Self> {
        let descriptor = wgpu::InstanceDescriptor {
            backends: wgpu::Backends::BROWSER_WEBGPU,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        };
        let instance = wgpu::Instance::new(descriptor);
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let raw = instance.request_adapter(&options).await.map_err(none)?;
        let adapter = Adapter::of_host(raw, instance, None).map_err(none)?;
        let descriptor = device_descriptor(adapter.raw()?);
        let opened = adapter.raw()?.request_device(&descriptor).await.map_err(none)?;
        let device = Device::of(&adapter, descriptor.required_limits, opened);
        Self::on(adapter, device)
    }
}

impl Device {
    /// Until all that was submitted has run, or the device is gone, and the browser has told of all buffers whose
    /// mapping was asked for before. Errors: `DeviceLost`; what the browser found wrong meanwhile.
    pub async fn ran(&self) -> Result<()> {
        #[derive(Default)]
        struct State {
            is_done: bool,
            waker: Option<Waker>,
        }
        let state = Arc::new(Mutex::new(State::default()));
        let told = state.clone();
        self.queue()?.on_submitted_work_done(move || {
            let mut state = told.lock().unwrap_or_else(PoisonError::into_inner);
            state.is_done = true;
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        });
        poll_fn(|context| {
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            if state.is_done {
                return Poll::Ready(());
            }
            state.waker = Some(context.waker().clone());
            Poll::Pending
        })
        .await;
        self.check()
    }
}

/// A canvas of a page, whose textures frames are written into.
pub struct Canvas {
    surface: wgpu::Surface<'static>,
    /// Width and height that it was configured for.
    size: Option<[u32; 2]>,
}

/// A canvas' texture, until the page's task ends: then the browser shows it.
pub struct CanvasTexture {
    view: wgpu::TextureView,
    texture: wgpu::SurfaceTexture,
}

impl CanvasTexture {
    pub fn target(&self) -> FrameTarget<'_> {
        FrameTarget::Image(&self.view, StoredFormat::Rgba8)
    }

    /// The frame is in it: it is to be shown. Errors: `DeviceLost`.
    pub fn show(self, device: &Device) -> Result<()> {
        device.queue()?.present(self.texture);
        Ok(())
    }
}

impl Canvas {
    /// Errors: `SurfaceLost` for a canvas that has another context.
    pub fn new(tracer: &GpuTracer, element: wgpu::web_sys::HtmlCanvasElement) -> Result<Self> {
        let instance =
            tracer.adapter().instance().ok_or_else(|| Error::internal("a page's adapter has an instance"))?;
        let surface = instance
            .create_surface(wgpu::SurfaceTarget::Canvas(element))
            .map_err(|error| Error::new(ErrorKind::SurfaceLost, format!("the canvas: {error}")))?;
        Ok(Self { surface, size: None })
    }

    /// The texture for the next frame, of such a size. Errors: `SurfaceLost`; as [`Device::scoped`].
    pub fn texture(&mut self, device: &Device, [width, height]: [u32; 2]) -> Result<CanvasTexture> {
        if self.size != Some([width, height]) {
            let config = wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::STORAGE_BINDING,
                format: wgpu::TextureFormat::Rgba8Unorm,
                width,
                height,
                present_mode: wgpu::PresentMode::Fifo,
                desired_maximum_frame_latency: 2,
                alpha_mode: wgpu::CompositeAlphaMode::Opaque,
                view_formats: Vec::new(),
                color_space: wgpu::SurfaceColorSpace::Auto,
            };
            device.scoped("the canvas", |raw| self.surface.configure(raw, &config))?;
            self.size = Some([width, height]);
        }
        use wgpu::CurrentSurfaceTexture::{Suboptimal, Success};
        match self.surface.get_current_texture() {
            Success(texture) | Suboptimal(texture) => {
                let view = texture.texture.create_view(&Default::default());
                Ok(CanvasTexture { view, texture })
            }
            _ => Err(Error::new(ErrorKind::SurfaceLost, "the canvas gives no texture")),
        }
    }
}
