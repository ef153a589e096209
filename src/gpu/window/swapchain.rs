// SPDX-License-Identifier: MIT OR Apache-2.0
//! A window's images, from wgpu: which device can present to which window, their format, and taking and presenting
//! one. Everything that wgpu can say or do about them becomes an [`Acquired`] or an [`Error`]. Knows nothing of
//! scenes.

use super::present::Presenter;
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::device::adapter::Adapter;
use crate::gpu::device::interfaces::of_layer;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::window::{Handles, PresentMode, Window};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// The images of one window.
pub struct Swapchain {
    surface: wgpu::Surface<'static>,
    presenter: Presenter,
    format: wgpu::TextureFormat,
    alpha: wgpu::CompositeAlphaMode,
    modes: Vec<wgpu::PresentMode>,
    configured: Option<PresentMode>,
    /// Goes after all that was made with it.
    device: Arc<Device>,
}

/// The answer of a swapchain that was asked for its next image.
pub enum Acquired {
    Image(wgpu::SurfaceTexture),
    /// None now: the window is hidden or busy.
    None,
    /// The window has changed; configure and ask again.
    Outdated,
    /// The window is gone.
    Lost,
}

/// wgpu's surface for a window. Errors: UNSUPPORTED where the adapter's interface has none for it.
fn surface_of(adapter: &Adapter, window: &Window) -> Result<wgpu::Surface<'static>> {
    let refused = |why: &dyn std::fmt::Display| {
        Error::unsupported(format!("{} cannot present to the window: {why}", adapter.info.name))
    };
    // Mesa's software drivers put images of depth 24 into windows, which others refuse.
    if let Some(depth) = window.depth()
        && adapter.info.software
        && depth != 24
    {
        return Err(refused(&format!("its depth is {depth}, not 24")));
    }
    let target = match window.handles() {
        Handles::Raw(display, window) => {
            wgpu::SurfaceTargetUnsafe::RawHandle { raw_display_handle: Some(display), raw_window_handle: window }
        }
        Handles::MetalLayer(layer) => of_layer(layer).ok_or_else(|| refused(&"it is a layer of Metal's"))?,
    };
    let instance = adapter.instance().ok_or_else(|| refused(&"OpenGL is used for tracing only"))?;
    // SAFETY: the window was found there when it was opened; `Window` keeps bhr's own X11 connection, and the host its
    // window, until after the surface, by the header.
    let made = catch_unwind(AssertUnwindSafe(|| unsafe { instance.create_surface_unsafe(target) }));
    let surface = made.map_err(|_| refused(&"the driver failed"))?.map_err(|error| refused(&error))?;
    if adapter.raw()?.is_surface_supported(&surface) && !surface.get_capabilities(adapter.raw()?).formats.is_empty() {
        return Ok(surface);
    }
    Err(refused(&"the adapter does not drive its display"))
}

impl Adapter {
    /// Errors: UNSUPPORTED when the adapter cannot present to the window, with the reason.
    pub fn check_presents(&self, window: &Window) -> Result<()> {
        surface_of(self, window).map(|_| ())
    }
}

/// Formats in order of preference: codes as they are, else those that the GPU encodes.
fn rank(format: wgpu::TextureFormat) -> u32 {
    use wgpu::TextureFormat::*;
    match format {
        Bgra8Unorm | Rgba8Unorm => 0,
        Bgra8UnormSrgb | Rgba8UnormSrgb => 1,
        Rgb10a2Unorm => 2,
        _ => 3,
    }
}

fn of_wgpu(mode: PresentMode) -> wgpu::PresentMode {
    match mode {
        PresentMode::Vsync => wgpu::PresentMode::Fifo,
        PresentMode::Immediate => wgpu::PresentMode::Immediate,
        PresentMode::Mailbox => wgpu::PresentMode::Mailbox,
    }
}

impl Swapchain {
    /// For a device that was opened on `adapter`. Errors: UNSUPPORTED when it cannot present to the window.
    pub fn new(adapter: &Adapter, device: Arc<Device>, window: &Window) -> Result<Self> {
        let surface = surface_of(adapter, window)?;
        let capabilities = surface.get_capabilities(adapter.raw()?);
        let format = capabilities.formats.iter().copied().min_by_key(|format| rank(*format));
        let format = format.ok_or_else(|| Error::unsupported("the window has no format"))?;
        let opaque = capabilities.alpha_modes.contains(&wgpu::CompositeAlphaMode::Opaque);
        Ok(Self {
            presenter: Presenter::new(&device, format)?,
            surface,
            device,
            format,
            alpha: if opaque { wgpu::CompositeAlphaMode::Opaque } else { wgpu::CompositeAlphaMode::Auto },
            modes: capabilities.present_modes,
            configured: None,
        })
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Whether the window has the mode itself, without falling back.
    pub fn offers(&self, mode: PresentMode) -> bool {
        self.modes.contains(&of_wgpu(mode))
    }

    pub fn is_configured(&self, mode: PresentMode) -> bool {
        self.configured == Some(mode)
    }

    /// Notes that the swapchain has to be configured anew, because the window has changed.
    pub fn window_changed(&mut self) {
        self.configured = None;
    }

    /// Makes images of `size`, each side at least 1; an absent mode falls back to VSYNC. Waits for the device's work,
    /// and no other thread may submit any meanwhile. Errors: as [`Device::scoped`].
    pub fn configure(&mut self, size: [u32; 2], mode: PresentMode) -> Result<()> {
        self.configured = None;
        let configuration = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: self.format,
            color_space: wgpu::SurfaceColorSpace::Auto,
            width: size[0],
            height: size[1],
            present_mode: if self.offers(mode) { of_wgpu(mode) } else { wgpu::PresentMode::Fifo },
            desired_maximum_frame_latency: 2,
            alpha_mode: self.alpha,
            view_formats: Vec::new(),
        };
        let _turn = self.device.turns.take();
        self.device.guarded("sizing a window's images", |device| self.surface.configure(device, &configuration))?;
        self.configured = Some(mode);
        Ok(())
    }

    /// The next image, waiting for it for a second at most. Errors: as [`Device::scoped`].
    pub fn acquire(&mut self) -> Result<Acquired> {
        if self.configured.is_none() {
            return Ok(Acquired::Outdated);
        }
        use wgpu::CurrentSurfaceTexture as Current;
        let current = self.device.guarded("asking for a window's image", |_| self.surface.get_current_texture())?;
        Ok(match current {
            Current::Success(image) => Acquired::Image(image),
            Current::Suboptimal(image) => {
                // This frame is shown as it is, the next one in images that fit.
                self.configured = None;
                Acquired::Image(image)
            }
            Current::Timeout | Current::Occluded => Acquired::None,
            Current::Outdated => {
                self.configured = None;
                Acquired::Outdated
            }
            Current::Lost => {
                self.device.check_loss_anew()?;
                Acquired::Lost
            }
            Current::Validation => {
                self.device.check_loss_anew()?;
                return Err(Error::new(ErrorKind::SurfaceLost, "the window's image was refused by validation"));
            }
        })
    }

    /// Records the filling of `image` with `screen`, stretched to it. Errors: as [`Device::scoped`].
    pub fn fill(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        image: &wgpu::SurfaceTexture,
        screen: &Texture,
    ) -> Result<()> {
        let view = self.device.scoped("a window's image", |_| image.texture.create_view(&Default::default()))?;
        let size = [image.texture.width(), image.texture.height()];
        self.presenter.draw(&self.device, encoder, screen, &view, size, None)
    }

    /// Shows an image whose filling has been submitted. Errors: as [`Device::scoped`].
    pub fn show(&self, image: wgpu::SurfaceTexture) -> Result<()> {
        let queue = self.device.queue()?;
        let _turn = self.device.turns.take();
        self.device.guarded("presenting", |_| queue.present(image))
    }
}
