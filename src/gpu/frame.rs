//! A frame on the GPU: tile by tile, sample by sample, records -> shade (-> bloom) -> develop -> readback, or a
//! window's texture. A frame is prepared ([`GpuTracer::begin`]), submitted step by step, and each step read when it
//! has run, so that readback overlaps the work of the next steps and frames. Knows no host memory: finished tiles go
//! to the sink.

use super::bloom::LIGHT_BYTES;
use super::export::{EXPORT_BYTES, imported};
use super::frame_buffers::Size;
use super::kernel_key::{FilmLook, KernelKey, Look, PixelTarget, Source, Variant};
use super::kernels::Kernels;
use super::lens_kerr::Wanted;
use super::records::{Making, Shared};
use super::refine::EdgeList;
use super::stages::{Stages, Taking};
use super::steps::{Step, Steps};
use super::submission::{Submitted, pass_of};
use super::tables::Tables;
use super::tiles::{MEMORY, Plan};
use super::uniforms::FrameUniform;
use super::{GpuTracer, Texture, for_f32, variant};
use crate::allocate::collected;
use crate::error::{Error, ErrorKind, Result};
use crate::film::FilmParams;
use crate::film::bloom::Bloom;
use crate::physics::trace::Settings;
use crate::renderer::{Backend, FrameRequest, FrameStats, Progress, Tile, TileSink};
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::{KerrWorth, Lensing, Projection, Region, Scene, View};
use glam::DVec3;
use std::collections::VecDeque;

/// Largest side of a tile with the border that is traced, pixels. The list of edges of a tile this large is all but
/// the 128 MiB that each device can bind.
const MAX_TILE_SIDE: u32 = 4096;
/// Bytes of a pixel's radiance.
const RADIANCE_BYTES: u64 = 16;

/// How a frame's shading is compiled.
pub(super) struct Looks {
    pub(super) look: Look,
    /// Of the kernel that ends shading.
    pub(super) film: FilmLook,
    /// Of development, in frames with bloom.
    pub(super) developed: Option<FilmLook>,
    pub(super) several_samples: bool,
    /// Whether pixels are put row by row into the host's memory.
    pub(super) rows: bool,
}

/// Where a frame's pixels go.
#[derive(Clone, Copy)]
pub enum FrameTarget<'a> {
    /// To the host, through staging buffers.
    Host,
    /// Into a texture as large as the frame: a window's.
    Screen(&'a Texture),
}

/// A frame that is prepared and whose steps are being submitted, one after another and before those of any other frame.
pub struct BegunFrame {
    pub(super) stages: Stages,
    pub(super) request: FrameRequest,
    pub(super) target: PixelTarget,
    pub(super) samples: u32,
    pub(super) projection: Projection,
    pub(super) source: Source,
    pub(super) steps: Steps,
    pub(super) bloom: Option<Bloom>,
    /// Submitted so far.
    pub(super) submitted: u64,
}

/// Records commands of its own.
pub type Recording<'a> = dyn FnMut(&mut wgpu::CommandEncoder) -> Result<()> + 'a;

/// What a frame is set up with before its tiles run.
pub(super) struct Setup {
    pub(super) making: Making,
    pub(super) looks: Looks,
    pub(super) samples: u32,
    pub(super) uniform: FrameUniform,
    pub(super) film: FilmParams,
    pub(super) bloom: Option<Bloom>,
}

/// Steps under way at once while a frame is rendered for a caller who waits: one is read while the next runs.
const AHEAD: usize = 2;

impl GpuTracer {
    /// Errors: as `Renderer::render`.
    pub fn render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let rendered = self.try_render(scene, request, sink, progress);
        if rendered.is_err() {
            self.forget();
        }
        rendered
    }

    fn try_render(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        sink: &mut TileSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let mut frame = self.begin(scene, request, FrameTarget::Host)?;
        let mut stats = frame.stats();
        let total = frame.count();
        let mut under_way = VecDeque::new();
        let mut done = 0;
        while done < total {
            if under_way.len() < AHEAD
                && let Some(step) = self.submit(&mut frame)?
            {
                under_way.push_back(step);
                continue;
            }
            let Some(step) = under_way.pop_front() else { break };
            step.finish(&self.device, &mut stats, sink)?;
            done += 1;
            // At the last one the frame is complete: nothing is left to cancel.
            if !progress(done as f64 / total as f64) && done < total {
                return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame"));
            }
        }
        stats.device_bytes = self.device.bytes();
        Ok(stats)
    }

    /// Makes all that frames of the scene like this one need, and frames like `window` on a screen, and keeps it.
    /// Errors: as `Renderer::render`.
    pub fn prepare(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        window: Option<&FrameRequest>,
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        let mut keys = self.set_up(scene, request, self.host_pixels(scene))?.kernels();
        if let Some(window) = window {
            keys.extend(self.set_up(scene, window, PixelTarget::Screen)?.kernels());
        }
        let wanted = self.kernels.begin(&keys);
        self.kernels.finish(wanted)?;
        // Some drivers put their part of a pipeline off until it runs; and a frame needs buffers, tables and a sky as
        // well.
        self.render(scene, request, &mut |_, _, _| Ok(()), progress).map(|_| ())
    }

    /// How many pipelines are not there that such a frame would run in a window; for tests. Errors: as
    /// `Renderer::render`.
    pub fn missing_on_screen(&self, scene: &Scene, request: &FrameRequest) -> Result<usize> {
        Ok(self.kernels.missing(&self.set_up(scene, request, PixelTarget::Screen)?.kernels()).len())
    }

    /// Prepares a frame. What is not submitted of it afterwards must be followed by [`Self::forget`]. Errors: as
    /// `Renderer::render`; the tables of lenses are then forgotten.
    pub fn begin(&mut self, scene: &Scene, request: &FrameRequest, target: FrameTarget<'_>) -> Result<BegunFrame> {
        let begun = self.try_begin(scene, request, target);
        if begun.is_err() {
            self.forget();
        }
        begun
    }

    fn try_begin(&mut self, scene: &Scene, request: &FrameRequest, target: FrameTarget<'_>) -> Result<BegunFrame> {
        let kind = match target {
            FrameTarget::Screen(_) => PixelTarget::Screen,
            FrameTarget::Host => self.host_pixels(scene),
        };
        let mut setup = self.set_up(scene, request, kind)?;
        let needed = setup.kernels();
        let wanted = self.kernels.begin(&needed);
        let samples = setup.samples;
        let pixel_bytes = if kind == PixelTarget::Screen { 0 } else { request.format.bytes_per_pixel() as u64 };
        let sums = if samples > 1 { 2 * RADIANCE_BYTES } else { 0 };
        // A pixel looked up takes as long as a step or two; of a Kerr lens some may have to be integrated, all of them
        // in a view of nothing but the shadow's edge.
        let ray_steps = match setup.making.source {
            Source::Traced => scene.expected_steps(),
            Source::Schwarzschild { .. } => 2,
            Source::Kerr { .. } => 8,
        };
        // Packed pixels have two staging buffers.
        let bytes = setup.making.bytes_per_pixel() + sums + 3 * pixel_bytes + EdgeList::BYTES_PER_PIXEL;
        let steps = self.steps(scene, request, &setup, bytes, ray_steps);

        let tables = Tables::prepare(&mut self.tables, &self.device, scene)?;
        setup.uniform.map_sizes = tables.map_sizes();
        let packed = if kind == PixelTarget::Packed { pixel_bytes } else { 0 };
        let size = Size { tile: steps.largest(), pixel_bytes: packed, several_samples: samples > 1 };
        if let Some((bloom, light)) = setup.bloom.as_ref().zip(steps.light()) {
            self.buffers.bloom.prepare(&self.device, bloom, light)?;
        }
        self.buffers.prepare(&self.device, size, &setup, self.adapter.info.software)?;
        let software = self.adapter.info.software;
        // Meanwhile the sky and the buffers were made.
        self.kernels.finish(wanted)?;
        let stages = self.buffers.stages(&self.device, &self.kernels, tables, &setup, target, software)?;
        let source = setup.making.source;
        let bloom = setup.bloom;
        let projection = scene.camera.projection;
        let request = *request;
        self.anticipate(scene, &request, kind, needed);
        Ok(BegunFrame { stages, request, target: kind, samples, projection, source, steps, bloom, submitted: 0 })
    }

    /// `bytes` that a pixel of a tile takes, and steps of its ray.
    fn steps(&self, scene: &Scene, request: &FrameRequest, setup: &Setup, bytes: u64, ray_steps: u64) -> Steps {
        let longest = self.device.limits().max_texture_dimension_2d;
        let side = longest.min(MAX_TILE_SIDE);
        let (samples, size) = (setup.samples, [request.width, request.height]);
        let Some(bloom) = &setup.bloom else {
            return Steps::plain(Plan::new(request, bytes, side, ray_steps, samples), samples);
        };
        let light = LIGHT_BYTES * size.map(u64::from).iter().product::<u64>();
        let fits = size.iter().all(|side| *side <= longest) && light <= MEMORY;
        if fits && scene.quality.keep_light.unwrap_or(true) {
            return Steps::kept(Plan::new(request, bytes, side, ray_steps, samples), samples, bloom);
        }
        Steps::twice(request, samples, bloom, |request, pixels| {
            let side = (u64::from(side) / pixels.isqrt()) as u32;
            Plan::new(request, (bytes + LIGHT_BYTES) * pixels, side, ray_steps * pixels, samples)
        })
    }

    /// Starts the frame's next step, if one is left. Errors: whatever the device reports; the tables of lenses are
    /// then forgotten.
    pub fn submit(&mut self, frame: &mut BegunFrame) -> Result<Option<Submitted>> {
        self.submit_and(frame, &mut |_| Ok(()))
    }

    /// [`Self::submit`]; the frame's last step ends with what `then` records. Errors: those of `then` as well.
    pub fn submit_and(&mut self, frame: &mut BegunFrame, then: &mut Recording<'_>) -> Result<Option<Submitted>> {
        let submitted = self.buffers.submit(&self.device, frame, then);
        if submitted.is_err() {
            self.forget();
        }
        submitted
    }

    /// After a frame that failed or was left before its first step, nobody knows what the tables of lenses hold.
    pub fn forget(&mut self) {
        self.buffers.forget();
    }

    /// How pixels for the host's memory are put.
    pub(super) fn host_pixels(&self, scene: &Scene) -> PixelTarget {
        if self.maps_pixels(scene) { PixelTarget::Rows } else { PixelTarget::Packed }
    }

    /// Whether kernels put pixels into the host's memory themselves, which hides the copy behind the tracing (a device
    /// of wgpu's runs one thing after another). Other interfaces than Vulkan may keep such memory out of kernels'
    /// reach, or reach it slowly.
    fn maps_pixels(&self, scene: &Scene) -> bool {
        let info = &self.adapter.info;
        let pays = info.backend == Backend::Vulkan && !info.software;
        self.device.maps_storage() && scene.quality.mapped_pixels.unwrap_or(pays)
    }

    pub(super) fn set_up(&self, scene: &Scene, request: &FrameRequest, target: PixelTarget) -> Result<Setup> {
        let lens = scene.lens(&request.region)?;
        let settings = for_f32(scene.pixel_settings());
        let samples = if scene.view == View::Light { scene.quality.samples_per_pixel } else { 1 };
        let film = FilmParams::new(&scene.film, scene.view, request.format, request.transparent);
        let bloom = Bloom::new(scene, request.format, [request.width, request.height])?;
        // On hardware, whose branches cost little, all but the usual projection and film share kernels, so that a host
        // that goes through them does not wait for the driver's compiler each time. Their frames pay up to 3 % for it
        // (H200). Software drivers run both sides of every branch.
        let shares = scene.quality.shares_kernels.unwrap_or(!self.adapter.info.software);
        let film_look = FilmLook::new(&scene.film, scene.view, request.format, target);
        let (usual_view, usual_film) = (scene.camera.projection == Projection::Perspective, film_look.is_usual());
        // Where one kernel both looks and develops, what is unusual in either is left open in both.
        let both = bloom.is_none() && samples == 1;
        let own_view = !shares || (usual_view && (usual_film || !both));
        let own_film = !shares || (usual_film && (usual_view || !both));
        let developed = if own_film { film_look } else { film_look.of_any() };
        let projection = own_view.then_some(scene.camera.projection);
        let looks = Looks {
            look: Look {
                light: scene.view == View::Light,
                stars: scene.shows_stars() && !request.transparent,
                milky_way: scene.shows_milky_way() && !request.transparent,
                map: scene.shown_map().is_some() && !request.transparent,
                grid: scene.shows_grid() && !request.transparent,
                all_effects: scene.effects.all_light(),
                disk: scene.disk_u().is_some(),
                opaque: scene.disk.is_some_and(|disk| disk.opacity == 1.0),
                footprints: scene.turbulence().is_some(),
                projection,
                refines: scene.view == View::Light && scene.quality.refines,
            },
            film: if bloom.is_some() { FilmLook::of_light() } else { developed },
            developed: bloom.is_some().then_some(developed),
            several_samples: samples > 1,
            rows: target == PixelTarget::Rows,
        };
        let making = self.making(scene, &lens, &settings, &request.region, projection);
        let uniform = FrameUniform::new(scene, &lens, &settings)?;
        Ok(Setup { making, looks, samples, uniform, film, bloom })
    }

    /// How the records of a frame are made.
    fn making(
        &self,
        scene: &Scene,
        lens: &Lens,
        settings: &Settings,
        region: &Region,
        projection: Option<Projection>,
    ) -> Making {
        let eye = lens.observer.frame;
        let pattern = scene.turbulence().is_some();
        let (delay, moving) = (settings.delay, lens.observer.beta != DVec3::ZERO);
        let pixels = u64::from(region.full_width) * u64::from(region.full_height);
        let source = match scene.lensing(&eye, pixels, KerrWorth::GPU) {
            Lensing::Traced => Source::Traced,
            Lensing::Schwarzschild => Source::Schwarzschild { delay, moving },
            Lensing::Kerr => Source::Kerr { delay, pattern, moving, rest: false },
        };
        // An opaque disk hides all but its first crossing.
        let crossings = if settings.opaque_u.is_some() { 1 } else { settings.max_crossings as u32 };
        let inside = eye.r <= 2.0;
        let disk_u = scene.disk_u();
        Making {
            source,
            variant: Variant { azimuth: pattern, projection, ..variant(scene, settings, inside) },
            // wgpu makes no array texture of one layer on GL.
            crossings: if self.adapter.info.backend == Backend::Gl { crossings.max(2) } else { crossings },
            eye,
            wanted: Wanted {
                orders: if disk_u.is_some() { settings.max_crossings as u32 } else { 0 },
                disk_u: disk_u.unwrap_or([1.0, 0.0]),
                pattern,
                delay,
            },
        }
    }

    /// The records of a frame, row by row; for tests. Errors: as `render`; INTERNAL for more than one tile holds.
    pub fn ray_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let records = self.try_records(scene, request);
        if records.is_err() {
            self.forget();
        }
        records
    }

    fn try_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let setup = self.set_up(scene, request, PixelTarget::Packed)?;
        let tile = [request.width, request.height];
        let device = &self.device;
        let size = Size { tile, pixel_bytes: EXPORT_BYTES, several_samples: false };
        self.buffers.prepare(device, size, &setup, self.adapter.info.software)?;
        let buffers = &mut self.buffers;
        let (fixed, sized) = buffers
            .fixed
            .as_ref()
            .zip(buffers.sized.as_ref())
            .ok_or_else(|| Error::internal("a frame without buffers"))?;
        let (frame, pass) = (fixed.frame.buffer.as_entire_binding(), fixed.pass());
        let (common, exported) = ([frame.clone(), pass.clone()], [sized.packed.as_entire_binding()]);
        let shared = Shared { frame: frame.clone(), pass: pass.clone(), step_sum: fixed.step_sum.as_entire_binding() };
        let records = buffers.makers.stages(device, &self.kernels, &setup.making, &shared)?;
        let group = buffers.makers.group(setup.making.source)?;
        let take = |kernels: &Kernels, source| {
            kernels.get(KernelKey::export(source, setup.looks.look))?.stage(device, &[&common, &group, &exported])
        };
        let taking = Taking::new(&self.kernels, &setup.making, self.adapter.info.software, take)?;

        let whole = Tile { x: 0, y: 0, width: request.width, height: request.height };
        let fixed = buffers.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed
            .passes
            .write(device, bytemuck::bytes_of(&pass_of(request, whole, (0, 1), scene.camera.projection, 0, [0, 0])))?;
        let mut encoder = device.encoder("records")?;
        buffers.makers.reset(setup.making.source, &fixed.step_sum, &mut encoder);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            records.encode(&mut pass, true, 0, tile);
            taking.dispatch(&mut pass, 0, tile);
        }
        let bytes = u64::from(request.width) * u64::from(request.height) * EXPORT_BYTES;
        let copied = buffers.readback.copy(device, &mut encoder, &sized.packed, bytes)?;
        let submission = device.submit(encoder)?;
        copied.read(device, &submission, |bytes| {
            collected(bytes.chunks_exact(EXPORT_BYTES as usize).map(imported), "the records of a frame's rays")
        })
    }
}

impl BegunFrame {
    /// Of steps.
    pub fn count(&self) -> u64 {
        self.steps.count()
    }

    /// Whether no step is left.
    pub fn is_submitted(&self) -> bool {
        self.submitted == self.count()
    }

    /// Of a frame of which nothing has run yet.
    pub fn stats(&self) -> FrameStats {
        let rays = u64::from(self.request.width) * u64::from(self.request.height) * u64::from(self.samples);
        FrameStats { rays, ..FrameStats::default() }
    }

    /// The next one.
    pub(super) fn next(&self) -> Option<Step> {
        (!self.is_submitted()).then(|| self.steps.step(self.submitted))
    }
}
