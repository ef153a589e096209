// SPDX-License-Identifier: MIT OR Apache-2.0
//! One window and the way frames get into it. Frames of the window's own device are not waited for: their numbers are
//! taken when they have run. Locks: its own before the tracer's.

use crate::allocate::{reserve, with_room};
use crate::attempt;
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{self, Acquired, Adapter, Device, FrameTarget, Search, Submission, Swapchain, Texture};
use crate::image::PixelFormat;
use crate::scene::{Projection, Region, Scene};
use crate::tracer::{FrameRequest, FrameStats, StatsBoard, Tile};
use crate::tracers::{SharedTracer, Tracer};
use crate::window::claim::Claim;
use crate::window::memory::{self, MemoryWindow};
use crate::window::{NativeWindow, Pacer, PresentMode, Window};
use parking_lot::Mutex;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The most frames whose numbers are not taken yet: more than a window's images hold back.
const MAX_UNREAD: usize = 4;
/// The most steps of one frame that are under way.
const AHEAD: usize = 3;

/// The outcome of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShowOutcome {
    Presented,
    /// The window is 0 x 0, minimised or hidden: nothing was presented.
    Skipped,
}

/// A window that a renderer shows its frames in.
pub struct Surface {
    inner: Mutex<Inner>,
}

struct Inner {
    /// `None` once it has ended: then `end` says why. Goes before the window.
    presentation: Option<Presentation>,
    end: &'static str,
    /// Goes before the claim.
    window: Option<Window>,
    _claim: Option<Claim>,
    size: [u32; 2],
    mode: PresentMode,
    /// Submitted frames whose numbers are not taken yet, oldest first.
    unread: VecDeque<UnreadFrame>,
}

/// How frames get into the window.
enum Presentation {
    /// Traced and presented by the tracer's device, to which nobody else may submit while images are made or go.
    Direct(Screen, SharedTracer),
    /// Traced elsewhere, and uploaded to a device that can present.
    Uploaded(Screen, Vec<u8>),
    /// Traced, and put there as memory, in every mode when the pacer says so: softbuffer waits for a silent compositor
    /// without a limit.
    Memory(MemoryWindow, Vec<u8>, Option<Box<dyn Pacer>>),
}

/// A window's images, and the texture that they are filled from.
struct Screen {
    texture: Option<Texture>,
    /// Dropped after the texture, as it holds the device.
    swapchain: Swapchain,
    /// The pacer. With one, VSYNC is MAILBOX underneath, and each frame waits until the pacer says so.
    pacer: Option<Box<dyn Pacer>>,
}

struct UnreadFrame {
    steps: VecDeque<Submission>,
    /// Dropped after the steps.
    device: Arc<Device>,
    stats: FrameStats,
    /// Time from the call's beginning to its end.
    call: Duration,
}

/// A GPU tracer, and what it runs on.
pub struct WindowTracer<'a> {
    pub adapter: &'a Adapter,
    pub device: Arc<Device>,
    pub tracer: SharedTracer,
}

/// A frame to be shown: the scene, what traces it, and where its numbers go.
pub struct ShowRequest<'a> {
    pub scene: &'a Scene,
    pub tracer: &'a SharedTracer,
    pub stats: &'a StatsBoard,
}

impl Surface {
    /// `tracing`: with a GPU tracer. `validation` of a device that is opened for presenting.
    ///
    /// Errors: INVALID_ARGUMENT for a window that is not there; INVALID_STATE for one that has a surface; UNSUPPORTED
    /// where nothing can present to it, with every reason; for a size beyond what the device's images have.
    pub fn new(
        native: NativeWindow,
        size: [u32; 2],
        mode: PresentMode,
        tracing: Option<WindowTracer<'_>>,
        validation: bool,
    ) -> Result<Self> {
        let window = Window::open(native)?;
        let claim = Claim::new(window.claim_key())?;
        let presentation = Presentation::find(&window, tracing, validation).map_err(|error| match window.exists() {
            true => error,
            false => Error::argument("the window has gone while its surface was being made"),
        })?;
        presentation.check_size(size)?;
        Ok(Self {
            inner: Mutex::new(Inner {
                presentation: Some(presentation),
                end: "",
                window: Some(window),
                _claim: Some(claim),
                size,
                mode,
                unread: VecDeque::new(),
            }),
        })
    }

    /// The window's new size in pixels; 0 x 0: minimised. Errors: UNSUPPORTED beyond what the device's images have;
    /// SURFACE_LOST.
    pub fn resize(&self, size: [u32; 2]) -> Result<()> {
        let mut inner = self.inner.lock();
        inner.presentation()?.check_size(size)?;
        match &mut inner.presentation {
            Some(Presentation::Direct(screen, _) | Presentation::Uploaded(screen, _)) if size != [0, 0] => {
                screen.window_changed()
            }
            Some(Presentation::Memory(_, _, Some(pacer))) if size != [0, 0] => pacer.forget(),
            _ => {}
        }
        inner.size = size;
        Ok(())
    }

    /// Errors: SURFACE_LOST.
    pub fn set_present_mode(&self, mode: PresentMode) -> Result<()> {
        let mut inner = self.inner.lock();
        inner.presentation()?;
        inner.mode = mode;
        Ok(())
    }

    pub fn has_ended(&self) -> bool {
        self.inner.lock().presentation.is_none()
    }

    /// Ends it, for a reason: later calls are SURFACE_LOST. The window is free for another.
    pub fn end(&self, reason: &'static str) {
        self.inner.lock().end(reason);
    }

    /// Renders the scene into the window. Errors: as `Renderer::render`; SURFACE_LOST, then and ever after, when the
    /// window is gone.
    pub fn show(&self, show_request: &ShowRequest<'_>) -> Result<ShowOutcome> {
        let mut inner = self.inner.lock();
        // Drivers report a window that is destroyed during a frame by many errors. A lost device is one of its own.
        let shown = inner.show(show_request).map_err(|error| {
            let is_gone = inner.window.as_ref().is_some_and(Window::is_gone);
            if is_gone && error.kind != ErrorKind::DeviceLost { window_gone() } else { error }
        });
        if shown.as_ref().is_err_and(|error| error.kind == ErrorKind::SurfaceLost) {
            inner.end("its window is gone, or took no frame");
        }
        shown
    }
}

impl Inner {
    fn presentation(&mut self) -> Result<&mut Presentation> {
        let end = self.end;
        self.presentation
            .as_mut()
            .ok_or_else(|| Error::new(ErrorKind::SurfaceLost, format!("the surface was lost: {end}")))
    }

    fn end(&mut self, reason: &'static str) {
        if self.presentation.is_some() {
            self.end = reason;
        }
        match self.presentation.take() {
            Some(Presentation::Direct(screen, tracer)) => {
                let _tracer = tracer.lock();
                drop(screen);
            }
            presentation => drop(presentation),
        }
        self.unread.clear();
        self.window = None;
        self._claim = None;
    }

    fn show(&mut self, show_request: &ShowRequest<'_>) -> Result<ShowOutcome> {
        let begun = Instant::now();
        self.presentation()?;
        if self.window.as_ref().is_some_and(Window::is_gone) {
            return Err(window_gone());
        }
        if self.size.contains(&0) {
            return Ok(ShowOutcome::Skipped);
        }
        let window = self.window.as_ref().ok_or_else(|| Error::internal("a surface without its window"))?;
        // X11 windows know their size better than a host whose events are still to come.
        let (given, mode) = (self.size, self.mode);
        if let Some(pacer) = self.presentation.as_mut().and_then(|presentation| presentation.pacer(mode))
            && !pacer.wait()?
        {
            return Ok(ShowOutcome::Skipped);
        }
        let shown =
            match self.presentation.as_mut().ok_or_else(|| Error::internal("a surface without a presentation"))? {
                Presentation::Direct(screen, tracer) => {
                    let Some((image, size)) = screen.acquire(window, given, mode, Some(tracer))? else {
                        return Ok(ShowOutcome::Skipped);
                    };
                    let traced = screen.trace(show_request, &image, size);
                    let shown = traced.and_then(|steps| screen.show(image, mode).map(|()| steps));
                    Some(screen.recreate_on_error(shown)?)
                }
                Presentation::Uploaded(screen, pixels) => {
                    let size = window.size().unwrap_or(given);
                    screen.check_size(size)?;
                    let request = frame_request(show_request.scene, size, PixelFormat::Rgba8Srgb);
                    let stats = render_to_memory(show_request, &request, pixels)?;
                    let Some((image, _)) = screen.acquire(window, given, mode, None)? else {
                        return Ok(ShowOutcome::Skipped);
                    };
                    let uploaded = screen.upload(&request, pixels);
                    let shown = uploaded.and_then(|()| screen.present(image, mode));
                    screen.recreate_on_error(shown)?;
                    show_request.stats.publish(stats, begun.elapsed());
                    None
                }
                Presentation::Memory(memory, pixels, pacer) => {
                    let size = match window.size() {
                        Some(size) => size,
                        None if !window.exists() => return Err(window_gone()),
                        None => given,
                    };
                    check_memory_size(size)?;
                    let request = frame_request(show_request.scene, size, PixelFormat::Bgra8Srgb);
                    let stats = render_to_memory(show_request, &request, pixels)?;
                    let stretched = stretched(&request, pixels, size)?;
                    if let Some(pacer) = pacer {
                        pacer.ask()?;
                    }
                    memory.present(window, size, stretched.as_deref().unwrap_or(pixels))?;
                    show_request.stats.publish(stats, begun.elapsed());
                    None
                }
            };
        window.drop_errors();
        if let Some((device, steps, stats)) = shown {
            self.unread.push_back(UnreadFrame { device, steps, stats, call: begun.elapsed() });
        }
        self.take_numbers(show_request.stats)?;
        Ok(ShowOutcome::Presented)
    }

    /// Takes the numbers of the frames that have run.
    fn take_numbers(&mut self, board: &StatsBoard) -> Result<()> {
        while let Some(first) = self.unread.front() {
            let done = match first.steps.back() {
                Some(last) => last.is_done(&first.device)?,
                None => true,
            };
            if !done && self.unread.len() <= MAX_UNREAD {
                break;
            }
            let Some(mut frame) = self.unread.pop_front() else { break };
            for step in frame.steps {
                step.finish(&frame.device, &mut frame.stats, &mut |_, _, _| Ok(()))?;
            }
            frame.stats.device_bytes = frame.device.bytes();
            frame.stats.readback_ns = 0;
            board.publish(frame.stats, frame.call);
        }
        Ok(())
    }
}

fn window_gone() -> Error {
    Error::new(ErrorKind::SurfaceLost, "the surface's window is gone")
}

/// The whole frame of a window of `size`, as large as the scene's quality has it traced; a cube has a shape of its own.
pub fn frame_request(scene: &Scene, size: [u32; 2], format: PixelFormat) -> FrameRequest {
    let scaled = size.map(|side| ((f64::from(side) * scene.quality.render_scale).round() as u32).max(1));
    let [width, height] = match scene.camera.projection {
        Projection::Cube => {
            let side = (scaled[0] / 6).min(scaled[1]).max(1);
            [6 * side, side]
        }
        _ => scaled,
    };
    let region = Region { full_width: width, full_height: height, x: 0, y: 0 };
    FrameRequest { width, height, region, format, transparent: false }
}

/// Rows of 4-byte pixels without gaps. Errors: as `Renderer::render`; OUT_OF_MEMORY.
fn render_to_memory(
    show_request: &ShowRequest<'_>,
    request: &FrameRequest,
    pixels: &mut Vec<u8>,
) -> Result<FrameStats> {
    let row = request.width as usize * 4;
    let bytes = row * request.height as usize;
    pixels.clear();
    reserve(pixels, bytes, "a window's frame")?;
    pixels.resize(bytes, 0);
    let mut sink = |tile: Tile, packed: &[u8], row_bytes: usize| {
        let part = tile.x as usize * 4..(tile.x + tile.width) as usize * 4;
        for (out, line) in pixels.chunks_exact_mut(row).skip(tile.y as usize).zip(packed.chunks(row_bytes)) {
            if let (Some(out), Some(line)) = (out.get_mut(part.clone()), line.get(..part.len())) {
                out.copy_from_slice(line);
            }
        }
        Ok(())
    };
    show_request.tracer.lock().render(show_request.scene, request, &mut sink, &mut |_| true)
}

/// `pixels` in the window's size, if the frame has another; bilinear, as the sampler of window/present.wgsl. Errors:
/// OUT_OF_MEMORY.
fn stretched(request: &FrameRequest, pixels: &[u8], size: [u32; 2]) -> Result<Option<Vec<u8>>> {
    let [width, height] = size.map(|side| side as usize);
    let (from_width, from_height) = (request.width as usize, request.height as usize);
    if [from_width, from_height] == [width, height] {
        return Ok(None);
    }
    let mut out = with_room(width * height * 4, "a window's stretched frame")?;
    // The pixel before a place, the one after, and how far the place is from the first.
    let place = |i: usize, to: usize, from: usize| {
        let at = ((i as f32 + 0.5) * from as f32 / to as f32 - 0.5).clamp(0.0, (from - 1) as f32);
        let before = at as usize;
        (before, (before + 1).min(from - 1), at - before as f32)
    };
    let (texels, _) = pixels.as_chunks::<4>();
    for y in 0..height {
        let (above, below, down) = place(y, height, from_height);
        for x in 0..width {
            let (left, right, across) = place(x, width, from_width);
            let texel = |row: usize, column: usize| texels.get(row * from_width + column).copied().unwrap_or_default();
            let corners = [texel(above, left), texel(above, right), texel(below, left), texel(below, right)];
            let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
            out.extend((0..4).map(|c| {
                let [a, b, c, d] = corners.map(|corner| f32::from(corner[c]));
                (mix(mix(a, b, across), mix(c, d, across), down) + 0.5) as u8
            }));
        }
    }
    Ok(Some(out))
}

fn pacer_of(window: &Window) -> Option<Box<dyn Pacer>> {
    window.pacer().unwrap_or_else(|error| {
        log::warn!("frames may wait for as long as their window is hidden: {}", error.message);
        None
    })
}

impl Presentation {
    /// The pacer, which says when frames of the mode are shown, if the driver does not.
    fn pacer(&mut self, mode: PresentMode) -> Option<&mut Box<dyn Pacer>> {
        match self {
            Self::Direct(screen, _) | Self::Uploaded(screen, _) => screen.pacer(mode),
            Self::Memory(_, _, pacer) => pacer.as_mut(),
        }
    }

    fn find(window: &Window, tracing: Option<WindowTracer<'_>>, validation: bool) -> Result<Self> {
        let _attempt = attempt::begin();
        let mut reasons = Vec::new();
        let tried = tracing.as_ref().map(|tracing| tracing.adapter);
        if let Some(WindowTracer { adapter, device, tracer }) = tracing {
            match Swapchain::new(adapter, device, window) {
                Ok(swapchain) => return Ok(Self::Direct(Screen::new(swapchain, window), tracer)),
                Err(error) if error.kind == ErrorKind::Unsupported => reasons.push(error.message),
                Err(error) => return Err(error),
            }
        }
        let others = gpu::adapters(Search::Native, validation).into_iter();
        for adapter in others.filter(|adapter| !tried.is_some_and(|tried| adapter.is_same(tried))) {
            let opened = adapter.check_presents(window).and_then(|()| Device::open(&adapter));
            match opened.and_then(|device| Swapchain::new(&adapter, Arc::new(device), window)) {
                Ok(swapchain) => {
                    log::info!("frames of this window are presented by {}", adapter.info.name);
                    return Ok(Self::Uploaded(Screen::new(swapchain, window), Vec::new()));
                }
                Err(error) => reasons.push(error.message),
            }
        }
        match MemoryWindow::new(window) {
            Ok(memory) => {
                log::info!("frames of this window are put there as memory ({})", reasons.join("; "));
                Ok(Self::Memory(memory, Vec::new(), pacer_of(window)))
            }
            Err(error) => {
                reasons.push(error.message);
                Err(Error::unsupported(format!("nothing here presents to the window: {}", reasons.join("; "))))
            }
        }
    }

    fn check_size(&self, size: [u32; 2]) -> Result<()> {
        match self {
            Self::Direct(screen, _) | Self::Uploaded(screen, _) => screen.check_size(size),
            Self::Memory(..) => check_memory_size(size),
        }
    }
}

/// Errors: UNSUPPORTED.
fn check_size([width, height]: [u32; 2], limit: u32) -> Result<()> {
    if width <= limit && height <= limit {
        return Ok(());
    }
    Err(Error::unsupported(format!("surface size is {width} x {height}; here each side can be {limit} at most")))
}

/// Errors: UNSUPPORTED.
fn check_memory_size(size: [u32; 2]) -> Result<()> {
    check_size(size, memory::MAX_SIDE)?;
    let [width, height] = size;
    if u64::from(width) * u64::from(height) <= memory::MAX_PIXELS {
        return Ok(());
    }
    let most = memory::MAX_PIXELS;
    Err(Error::unsupported(format!("surface size is {width} x {height}; here it can have {most} pixels at most")))
}

/// A window's image, and its size.
type Image = (wgpu::SurfaceTexture, [u32; 2]);

impl Screen {
    /// Errors: UNSUPPORTED.
    fn check_size(&self, size: [u32; 2]) -> Result<()> {
        check_size(size, self.swapchain.device().limits().max_texture_dimension_2d)
    }

    fn new(swapchain: Swapchain, window: &Window) -> Self {
        let pacer = if swapchain.offers(PresentMode::Mailbox) { pacer_of(window) } else { None };
        Self { swapchain, texture: None, pacer }
    }

    fn window_changed(&mut self) {
        self.swapchain.window_changed();
        // The driver drops frames of a window that changes, and one that the host hid has nothing to show before its
        // next frame: compositors may be silent then.
        if let Some(pacer) = &mut self.pacer {
            pacer.forget();
        }
    }

    fn pacer(&mut self, mode: PresentMode) -> Option<&mut Box<dyn Pacer>> {
        self.pacer.as_mut().filter(|_| mode == PresentMode::Vsync)
    }

    /// The window's next image, and its size; `None`: none now. `tracer`: who else submits to the device. Errors:
    /// SURFACE_LOST; as [`Swapchain::acquire`].
    fn acquire(
        &mut self,
        window: &Window,
        given: [u32; 2],
        mode: PresentMode,
        tracer: Option<&SharedTracer>,
    ) -> Result<Option<Image>> {
        let mode = if self.pacer(mode).is_some() { PresentMode::Mailbox } else { mode };
        for _ in 0..2 {
            if !self.swapchain.is_configured(mode) {
                // The size is what X11 says; elsewhere, and if the window has just gone, what the host says.
                let size = window.size().unwrap_or(given).map(|side| side.max(1));
                self.check_size(size)?;
                let _tracer = tracer.map(|tracer| tracer.lock());
                let configured = self.swapchain.configure(size, mode);
                if configured.is_err() && !window.exists() {
                    return Err(window_gone());
                }
                configured?;
            }
            match self.swapchain.acquire()? {
                Acquired::Image(image) => {
                    let size = [image.texture.width(), image.texture.height()];
                    return Ok(Some((image, size)));
                }
                Acquired::None if window.exists() => return Ok(None),
                Acquired::Outdated if window.exists() => {}
                Acquired::None | Acquired::Outdated | Acquired::Lost => return Err(window_gone()),
            }
        }
        // The window changes faster than its images can be made.
        Ok(None)
    }

    /// A texture of the frame's size.
    fn texture(&mut self, request: &FrameRequest, host_fills: bool) -> Result<&Texture> {
        let size = [request.width, request.height];
        if self.texture.as_ref().is_none_or(|texture| texture.size() != size) {
            // The old texture goes first: both together need not fit.
            self.texture = None;
            self.texture = Some(self.swapchain.device().screen(size, host_fills)?);
        }
        self.texture.as_ref().ok_or_else(|| Error::internal("a screen without its texture"))
    }

    /// Submits the frame for an image of `size`, and the filling of the image with it.
    fn trace(
        &mut self,
        show_request: &ShowRequest<'_>,
        image: &wgpu::SurfaceTexture,
        size: [u32; 2],
    ) -> Result<(Arc<Device>, VecDeque<Submission>, FrameStats)> {
        let request = frame_request(show_request.scene, size, PixelFormat::Rgba8Srgb);
        let device = self.swapchain.device().clone();
        self.texture(&request, false)?;
        let Self { swapchain, texture: Some(texture), .. } = self else {
            return Err(Error::internal("a screen without its texture"));
        };
        let mut fill = |encoder: &mut wgpu::CommandEncoder| swapchain.fill(encoder, image, texture);
        let mut tracer = show_request.tracer.lock();
        let Tracer::Gpu(tracer) = &mut *tracer else {
            return Err(Error::internal("a window of a GPU on another tracer"));
        };
        let mut frame = tracer.begin(show_request.scene, &request, FrameTarget::screen(texture))?;
        let mut stats = frame.stats();
        let mut steps = VecDeque::new();
        while let Some(step) = tracer.submit_and(&mut frame, &mut fill)? {
            steps.push_back(step);
            if steps.len() > AHEAD
                && let Some(first) = steps.pop_front()
            {
                first.finish(&device, &mut stats, &mut |_, _, _| Ok(()))?;
            }
        }
        Ok((device, steps, stats))
    }

    /// Brings a frame from memory into the texture.
    fn upload(&mut self, request: &FrameRequest, pixels: &[u8]) -> Result<()> {
        let device = self.swapchain.device().clone();
        device.write_rows(self.texture(request, true)?, 0, pixels)
    }

    /// Fills the image with what was uploaded, and shows it.
    fn present(&mut self, image: wgpu::SurfaceTexture, mode: PresentMode) -> Result<()> {
        let texture = self.texture.as_ref().ok_or_else(|| Error::internal("a screen without its texture"))?;
        let device = self.swapchain.device();
        let mut encoder = device.encoder("present")?;
        self.swapchain.fill(&mut encoder, &image, texture)?;
        device.submit(encoder)?;
        self.show(image, mode)
    }

    /// After a failure the image that was taken and not shown is lost to its window: images are made anew.
    fn recreate_on_error<T>(&mut self, shown: Result<T>) -> Result<T> {
        if shown.is_err() {
            self.swapchain.window_changed();
        }
        shown
    }

    /// Shows an image that is being filled.
    fn show(&mut self, image: wgpu::SurfaceTexture, mode: PresentMode) -> Result<()> {
        if let Some(pacer) = self.pacer(mode) {
            pacer.ask()?;
        }
        self.swapchain.show(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_keeps_its_shape_in_any_window() {
        let mut scene = Scene::plain();
        for (size, scale) in
            [([1280, 720], 1.0), ([1280, 720], 0.33), ([600, 100], 1.0), ([9, 900], 1.0), ([1, 1], 0.5)]
        {
            scene.quality.render_scale = scale;
            scene.camera.projection = Projection::Cube;
            let cube = frame_request(&scene, size, PixelFormat::Rgba8Srgb);
            assert!(scene.lens(&cube.region).is_ok(), "{size:?}");
            scene.camera.projection = Projection::Equirect;
            let other = frame_request(&scene, size, PixelFormat::Rgba8Srgb);
            let area = |r: &FrameRequest| u64::from(r.width) * u64::from(r.height);
            assert!(area(&cube) <= area(&other).max(6));
            assert!(size != [600, 100] || (cube.width, cube.height) == (600, 100));
        }
    }
}
