//! A frame on the GPU: tile by tile, sample by sample, records -> shade -> develop -> readback, or a window's texture. A frame is
//! prepared ([`GpuTracer::begin`]), submitted step by step, and each step read when it has run, so that readback overlaps the work
//! of the next steps and frames. Knows no host memory: finished tiles go to the sink.

use super::export::{EXPORT_BYTES, imported};
use super::kernels::{FilmLook, Kernels, Look, PixelTarget, Source, Stage, TextureKind, check_groups, pixel_groups};
use super::lens_kerr::Wanted;
use super::records::{Making, RecordMakers, RecordStages, STEP_SUM, Shared, step_sum};
use super::tables::Tables;
use super::tiles::{MAX_BATCH, Plan};
use super::uniforms::{FrameUniform, PassUniform};
use super::{Buffer, Copied, Device, GpuTimer, GpuTracer, Readback, Texture, for_f32, kernels, timer, variant};
use crate::error::{Error, ErrorKind, Result};
use crate::film::FilmParams;
use crate::physics::trace::Settings;
use crate::renderer::{Backend, FrameRequest, FrameStats, Progress, Tile, TileSink};
use crate::scene::frame::sample_offset;
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::{Lensing, Region, Scene, View};
use glam::DVec3;
use std::collections::VecDeque;
use std::ops::Range;
use std::slice;
use std::time::Instant;
use wgpu::BufferUsages as Usage;

/// Largest side of a tile, pixels.
const MAX_TILE_SIDE: u32 = 4096;
/// Bytes of a pixel's radiance.
const RADIANCE_BYTES: u64 = 16;

/// Buffers that frames of one size share; they grow and stay.
#[derive(Default)]
pub struct FrameBuffers {
    fixed: Option<FixedBuffers>,
    sized: Option<SizedBuffers>,
    makers: RecordMakers,
    readback: Readback,
    /// Where kernels put pixels row by row.
    mapped: Mapped,
    timer: Option<GpuTimer>,
}

struct FixedBuffers {
    frame: Written,
    film: Written,
    /// One `PassUniform` for each sample of a batch, `pass_stride` apart.
    passes: Written,
    step_sum: Buffer,
}

/// Staging buffers that kernels write.
struct Mapped(Readback);

impl Default for Mapped {
    fn default() -> Self {
        Self(Readback::of_kernels())
    }
}

/// A buffer of uniforms, and what was written to its begin last.
struct Written {
    buffer: Buffer,
    bytes: Vec<u8>,
}

struct SizedBuffers {
    size: Size,
    /// Samples are added by turns: from one to the other; as large as a tile only for several samples.
    radiance: [Texture; 2],
    packed: Buffer,
}

/// What the sized buffers serve: largest tile, bytes of a packed pixel (0: none are packed there).
#[derive(Clone, Copy, PartialEq, Eq)]
struct Size {
    tile: [u32; 2],
    pixel_bytes: u64,
    several_samples: bool,
}

/// A kernel that takes records: over all pixels, and over those that it deferred.
struct Taking {
    all: Stage,
    rest: Option<Stage>,
    /// Workgroups over the deferred pixels, however many they are.
    rest_groups: u32,
}

/// What turns ray records into packed pixels.
enum Shading {
    /// Of the only sample.
    Only(Taking),
    Samples {
        /// Of even and of odd samples.
        shade: [Taking; 2],
        /// After an even and after an odd last sample.
        develop: [Stage; 2],
    },
}

struct Stages {
    records: RecordStages,
    shading: Shading,
    put: Put,
}

/// Group 2 of the kernel that puts pixels.
enum Put {
    /// In the same place in every submission.
    Here(wgpu::BindGroup),
    /// In the submission's staging buffer: the group's layout, and the film.
    Staged(wgpu::BindGroupLayout, wgpu::Buffer),
}

/// How a frame's shading is compiled.
struct Looks {
    look: Look,
    film: FilmLook,
    several_samples: bool,
    /// Whether pixels are put row by row into the host's memory.
    rows: bool,
}

/// Workgroups that share the deferred pixels: enough for a large GPU's few thousand, and on a software driver, where each costs its
/// share of a loop's body however little there is to do, few.
const REST_GROUPS: u32 = 512;
const REST_GROUPS_SOFTWARE: u32 = 16;

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
    stages: Stages,
    request: FrameRequest,
    target: PixelTarget,
    samples: u32,
    source: Source,
    plan: Plan,
    /// Submitted so far.
    submitted: u64,
}

/// Records commands of its own.
pub type Recording<'a> = dyn FnMut(&mut wgpu::CommandEncoder) -> Result<()> + 'a;

/// A submission that has not been read yet.
pub struct Submitted {
    submission: wgpu::SubmissionIndex,
    /// Ticks of the passes, from `TICKS` on; the sum of the steps; packed pixels.
    copied: Copied,
    tick_bytes: u64,
    /// Whether steps were counted: none are taken where rays are looked up and nothing else.
    counts: bool,
    tile: Option<Tile>,
    row_bytes: usize,
}

/// Where a submission's staging buffer has what: ticks and pixels where queries and bindings may begin on every device.
const TICKS: u64 = 0;
const STEPS: u64 = 64;
const PIXELS: u64 = 256;

/// What a frame is set up with before its tiles run.
struct Setup {
    making: Making,
    looks: Looks,
    samples: u32,
    uniform: FrameUniform,
    film: FilmParams,
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

    /// Prepares a frame. What is not submitted of it afterwards must be followed by [`Self::forget`]. Errors: as `Renderer::render`;
    /// the tables of lenses are then forgotten.
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
            FrameTarget::Host if self.maps_pixels(scene) => PixelTarget::Rows,
            FrameTarget::Host => PixelTarget::Packed,
        };
        let mut setup = self.set_up(scene, request, kind)?;
        let samples = setup.samples;
        let pixel_bytes = if kind == PixelTarget::Screen { 0 } else { request.format.bytes_per_pixel() as u64 };
        let sums = if samples > 1 { 2 * RADIANCE_BYTES } else { 0 };
        // A pixel looked up takes as long as a step or two; of a Kerr lens some may have to be integrated, all of them in a view
        // of nothing but the shadow's edge.
        let steps = match setup.making.source {
            Source::Traced => scene.expected_steps(),
            Source::Schwarzschild { .. } => 2,
            Source::Kerr { .. } => 8,
        };
        // Packed pixels have two staging buffers.
        let bytes = setup.making.bytes_per_pixel() + sums + 3 * pixel_bytes;
        let max_side = self.device.limits().max_texture_dimension_2d.min(MAX_TILE_SIDE);
        let plan = Plan::new(request, bytes, max_side, steps, samples);

        let tables = Tables::prepare(&mut self.tables, &self.device, scene)?;
        setup.uniform.map_sizes = tables.map_sizes();
        let packed = if kind == PixelTarget::Packed { pixel_bytes } else { 0 };
        let size = Size { tile: plan.largest(), pixel_bytes: packed, several_samples: samples > 1 };
        self.buffers.prepare(&self.device, size, &setup, self.adapter.info.software)?;
        let software = self.adapter.info.software;
        let stages = self.buffers.stages(&self.device, &mut self.kernels, tables, &setup, target, software)?;
        let source = setup.making.source;
        Ok(BegunFrame { stages, request: *request, target: kind, samples, source, plan, submitted: 0 })
    }

    /// Starts the frame's next step, if one is left. Errors: whatever the device reports; the tables of lenses are then forgotten.
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

    /// Whether kernels put pixels into the host's memory themselves, which hides the copy behind the tracing (a device of wgpu's runs one
    /// thing after another). Other interfaces than Vulkan may keep such memory out of kernels' reach, or reach it slowly.
    fn maps_pixels(&self, scene: &Scene) -> bool {
        let info = &self.adapter.info;
        let pays = info.backend == Backend::Vulkan && !info.software;
        self.device.maps_storage() && scene.quality.mapped_pixels.unwrap_or(pays)
    }

    fn set_up(&self, scene: &Scene, request: &FrameRequest, target: PixelTarget) -> Result<Setup> {
        let lens = scene.lens(&request.region)?;
        let settings = for_f32(scene.pixel_settings());
        let samples = if scene.view == View::Light { scene.quality.samples_per_pixel } else { 1 };
        let film = FilmParams::new(&scene.film, scene.view, request.format, request.transparent);
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
                projection: scene.camera.projection,
            },
            film: FilmLook::new(&film, target),
            several_samples: samples > 1,
            rows: target == PixelTarget::Rows,
        };
        let making = self.making(scene, &lens, &settings, &request.region);
        let uniform = FrameUniform::new(scene, &lens, &settings)?;
        Ok(Setup { making, looks, samples, uniform, film })
    }

    /// How the records of a frame are made.
    fn making(&self, scene: &Scene, lens: &Lens, settings: &Settings, region: &Region) -> Making {
        let eye = lens.observer.frame;
        let pattern = scene.turbulence().is_some();
        let (delay, moving) = (settings.delay, lens.observer.beta != DVec3::ZERO);
        let pixels = u64::from(region.full_width) * u64::from(region.full_height);
        let source = match scene.lensing(&eye, pixels) {
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
            variant: kernels::Variant {
                azimuth: pattern,
                projection: scene.camera.projection,
                ..variant(scene, settings, inside)
            },
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
        let (scene, exported) = ([frame.clone(), pass.clone()], [sized.packed.as_entire_binding()]);
        let shared = Shared { frame: frame.clone(), pass: pass.clone(), step_sum: fixed.step_sum.as_entire_binding() };
        let records = buffers.makers.stages(device, &mut self.kernels, &setup.making, &shared)?;
        let group = buffers.makers.group(setup.making.source)?;
        let take = |kernels: &mut Kernels, source| {
            kernels.export(device, source, setup.looks.look)?.stage(device, &[&scene, &group, &exported])
        };
        let taking = Taking::new(&mut self.kernels, &setup.making, self.adapter.info.software, take)?;

        let whole = Tile { x: 0, y: 0, width: request.width, height: request.height };
        let fixed = buffers.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.passes.write(device, bytemuck::bytes_of(&pass_of(request, whole, 0, 1, 0)))?;
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
        copied.read(device, &submission, |bytes| Ok(bytes.chunks_exact(EXPORT_BYTES as usize).map(imported).collect()))
    }
}

impl Taking {
    /// `take` makes the stage that takes the records of a source.
    fn new(
        kernels: &mut Kernels,
        making: &Making,
        software: bool,
        take: impl Fn(&mut Kernels, Source) -> Result<Stage>,
    ) -> Result<Self> {
        Ok(Self {
            all: take(kernels, making.source)?,
            rest: making.rest().map(|source| take(kernels, source)).transpose()?,
            rest_groups: if software { REST_GROUPS_SOFTWARE } else { REST_GROUPS },
        })
    }

    fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2]) {
        self.all.dispatch(pass, offset, tile);
        if let Some(rest) = &self.rest {
            rest.run(pass, Some(offset), [self.rest_groups, 1]);
        }
    }
}

impl Size {
    /// Whether buffers of this size hold what the other asks for.
    fn serves(&self, other: &Self) -> bool {
        (0..2).all(|i| self.tile[i] >= other.tile[i])
            && self.pixel_bytes >= other.pixel_bytes
            && (self.several_samples || !other.several_samples)
    }
}

impl Written {
    fn new(device: &Device, label: &str, size: u64) -> Result<Self> {
        Ok(Self { buffer: device.buffer(label, size, Usage::UNIFORM | Usage::COPY_DST)?, bytes: Vec::new() })
    }

    /// Before the next submission runs, unless it is there already. Errors: as [`Device::write`].
    fn write(&mut self, device: &Device, bytes: &[u8]) -> Result<()> {
        if self.bytes != bytes {
            self.bytes.clear();
            device.write(&self.buffer, 0, bytes)?;
            self.bytes.extend_from_slice(bytes);
        }
        Ok(())
    }
}

impl FixedBuffers {
    /// The `PassUniform` that a dispatch's offset chooses.
    fn pass(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.passes.buffer,
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<PassUniform>() as u64),
        })
    }
}

impl FrameBuffers {
    /// Makes room, and writes what all tiles share.
    fn prepare(&mut self, device: &Device, size: Size, setup: &Setup, software: bool) -> Result<()> {
        if self.fixed.is_none() {
            self.fixed = Some(FixedBuffers {
                frame: Written::new(device, "frame", size_of::<FrameUniform>() as u64)?,
                film: Written::new(device, "film", size_of::<FilmParams>() as u64)?,
                passes: Written::new(device, "passes", u64::from(MAX_BATCH) * pass_stride(device))?,
                step_sum: step_sum(device)?,
            });
            // The clocks of software drivers tell nothing about their threads.
            self.timer = if software { None } else { GpuTimer::new(device, 1)? };
        }
        if !self.sized.as_ref().is_some_and(|s| s.size.serves(&size)) {
            // The old ones go first: both together need not fit.
            self.sized = None;
            let TextureKind { format, dimension } = kernels::RADIANCE;
            let summed = if size.several_samples { size.tile } else { [1, 1] };
            let radiance = || device.texture("radiance", format, dimension, summed, 1);
            let bytes = (u64::from(size.tile[0]) * u64::from(size.tile[1]) * size.pixel_bytes).max(4);
            self.sized = Some(SizedBuffers {
                size,
                radiance: [radiance()?, radiance()?],
                packed: device.buffer("packed pixels", bytes, Usage::STORAGE | Usage::COPY_SRC)?,
            });
        }
        self.makers.prepare(device, &setup.making, size.tile)?;
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.frame.write(device, bytemuck::bytes_of(&setup.uniform))?;
        fixed.film.write(device, bytemuck::bytes_of(&setup.film))
    }

    /// After a submission that failed, nobody knows what the buffers hold.
    fn forget(&mut self) {
        self.makers.forget();
        if let Some(fixed) = &mut self.fixed {
            for written in [&mut fixed.frame, &mut fixed.film, &mut fixed.passes] {
                written.bytes.clear();
            }
        }
    }

    fn stages(
        &mut self,
        device: &Device,
        kernels: &mut Kernels,
        tables: &Tables,
        setup: &Setup,
        target: FrameTarget<'_>,
        software: bool,
    ) -> Result<Stages> {
        let looks = &setup.looks;
        let (fixed, sized) =
            self.fixed.as_ref().zip(self.sized.as_ref()).ok_or_else(|| Error::internal("a frame without buffers"))?;
        let pass = fixed.pass();
        let frame = fixed.frame.buffer.as_entire_binding();
        let step_sum = fixed.step_sum.as_entire_binding();
        let shared = Shared { frame: frame.clone(), pass: pass.clone(), step_sum };
        let made = self.makers.stages(device, kernels, &setup.making, &shared)?;
        let records = self.makers.group(setup.making.source)?;
        let [light, cells, milky_way, map] = tables.textures().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let [even, odd] = sized.radiance.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let shared = [frame, pass.clone(), light, cells, milky_way, map];
        let taking = |kernels: &mut Kernels, target: &[wgpu::BindingResource<'_>]| {
            let take = |kernels: &mut Kernels, source| {
                let compiled = match looks.several_samples {
                    true => kernels.shade_sample(device, source, looks.look)?,
                    false => kernels.shade_only(device, source, looks.look, looks.film)?,
                };
                let groups: [&[_]; 3] = [&shared, &records, target];
                compiled.stage(device, if looks.several_samples { &groups } else { &groups[..2] })
            };
            Taking::new(kernels, &setup.making, software, take)
        };
        let puts = match looks.several_samples {
            true => kernels.develop(device, looks.film)?,
            false => kernels.shade_only(device, setup.making.source, looks.look, looks.film)?,
        };
        let shading = if looks.several_samples {
            let develop =
                |from: wgpu::BindingResource<'_>| puts.stage(device, &[slice::from_ref(&pass), slice::from_ref(&from)]);
            Shading::Samples {
                shade: [taking(kernels, &[odd.clone(), even.clone()])?, taking(kernels, &[even.clone(), odd.clone()])?],
                develop: [develop(even)?, develop(odd)?],
            }
        } else {
            Shading::Only(taking(kernels, &[])?)
        };
        let film = &fixed.film.buffer;
        let here = |pixels| device.bind(puts.target()?, &[film.as_entire_binding(), pixels]).map(Put::Here);
        let put = match target {
            FrameTarget::Screen(texture) => here(wgpu::BindingResource::TextureView(&texture.view))?,
            FrameTarget::Host if looks.rows => Put::Staged(puts.target()?.clone(), (**film).clone()),
            FrameTarget::Host => here(sized.packed.as_entire_binding())?,
        };
        Ok(Stages { records: made, shading, put })
    }
}

impl Put {
    /// `staging`: the submission's.
    fn group(&self, device: &Device, staging: &wgpu::Buffer) -> Result<wgpu::BindGroup> {
        match self {
            Self::Here(group) => Ok(group.clone()),
            Self::Staged(layout, film) => {
                let pixels = wgpu::BufferBinding { buffer: staging, offset: PIXELS, size: None };
                device.bind(layout, &[film.as_entire_binding(), wgpu::BindingResource::Buffer(pixels)])
            }
        }
    }
}

/// Distance of two `PassUniform`s in their buffer.
fn pass_stride(device: &Device) -> u64 {
    let alignment = u64::from(device.limits().min_uniform_buffer_offset_alignment);
    (size_of::<PassUniform>() as u64).next_multiple_of(alignment)
}

impl BegunFrame {
    fn batches(&self) -> u64 {
        u64::from(self.samples.div_ceil(self.plan.batch))
    }

    /// Of steps.
    pub fn count(&self) -> u64 {
        self.plan.count() * self.batches()
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

    /// The next step: a tile, and samples of it.
    fn next(&self) -> Option<(Tile, Range<u32>)> {
        if self.submitted == self.count() {
            return None;
        }
        let tile = self.plan.tile(self.submitted / self.batches());
        let begin = (self.submitted % self.batches()) as u32 * self.plan.batch;
        Some((tile, begin..(begin + self.plan.batch).min(self.samples)))
    }
}

impl FrameBuffers {
    /// Starts the frame's next step; the last samples of a tile are followed by development and the copy to the host.
    fn submit(
        &mut self,
        device: &Device,
        frame: &mut BegunFrame,
        then: &mut Recording<'_>,
    ) -> Result<Option<Submitted>> {
        let Some((tile, range)) = frame.next() else { return Ok(None) };
        let begins = frame.submitted == 0;
        let stages = &frame.stages;
        let stride = pass_stride(device);
        let slots = range.clone().zip(0..);
        let passes = slots.map(|(sample, slot)| pass_of(&frame.request, tile, sample, frame.samples, slot));
        let mut bytes = vec![0; range.len() * stride as usize];
        for (slot, pass) in bytes.chunks_exact_mut(stride as usize).zip(passes) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let size_of_tile = [tile.width, tile.height];
        check_groups(device, pixel_groups(size_of_tile.map(|side| side + 2)))?;
        let last = range.end == frame.samples;
        let row_bytes = tile.width as usize * frame.request.format.bytes_per_pixel();
        let pixel_bytes = match frame.target {
            PixelTarget::Packed | PixelTarget::Rows if last => row_bytes as u64 * u64::from(tile.height),
            _ => 0,
        };
        let size = if pixel_bytes > 0 { PIXELS + pixel_bytes } else { STEPS + STEP_SUM };
        let staging = match frame.target {
            PixelTarget::Rows if last => self.mapped.0.staging(device, size)?,
            _ => self.readback.staging(device, size)?,
        };
        let to = staging.buffer()?;
        let put = if last { Some(stages.put.group(device, to)?) } else { None };
        let mut encoder = device.encoder("frame")?;
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.passes.write(device, &bytes)?;
        let steps = self.makers.reset(frame.source, &fixed.step_sum, &mut encoder);
        {
            let timestamps = self.timer.as_mut().and_then(GpuTimer::next_pass);
            let descriptor = wgpu::ComputePassDescriptor { label: Some("frame"), timestamp_writes: timestamps };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            for (i, sample) in range.enumerate() {
                let offset = i as u32 * stride as u32;
                stages.records.encode(&mut pass, begins && i == 0, offset, size_of_tile);
                match &stages.shading {
                    Shading::Only(stage) => {
                        pass.set_bind_group(2, put.as_ref(), &[]);
                        stage.dispatch(&mut pass, offset, size_of_tile);
                    }
                    Shading::Samples { shade, .. } => {
                        shade[sample as usize % 2].dispatch(&mut pass, offset, size_of_tile);
                    }
                }
            }
            if let (Shading::Samples { develop, .. }, true) = (&stages.shading, last) {
                pass.set_bind_group(2, put.as_ref(), &[]);
                develop[(frame.samples as usize - 1) % 2].dispatch(&mut pass, 0, size_of_tile);
            }
        }
        let counts = steps.is_some();
        if let Some(steps) = steps {
            encoder.copy_buffer_to_buffer(steps, 0, to, STEPS, STEP_SUM);
        }
        let tick_bytes = self.timer.as_mut().map_or(0, |timer| timer.resolve(&mut encoder, to, TICKS));
        if let (Some(sized), PixelTarget::Packed, true) = (&self.sized, frame.target, last) {
            encoder.copy_buffer_to_buffer(&sized.packed, 0, to, PIXELS, pixel_bytes);
        }
        let mut copied = staging.filled(size);
        if frame.submitted + 1 == frame.count() {
            then(&mut encoder)?;
        }
        let submission = device.submit(encoder)?;
        copied.request(device)?;
        frame.submitted += 1;
        Ok(Some(Submitted {
            submission,
            copied,
            tick_bytes,
            counts,
            tile: (pixel_bytes > 0).then_some(tile),
            row_bytes,
        }))
    }
}

impl Submitted {
    /// What to wait for.
    pub fn submission(&self) -> &wgpu::SubmissionIndex {
        &self.submission
    }

    /// Whether it has run, so that [`Self::finish`] does not wait. Errors: as [`Device::wait`].
    pub fn is_done(&self, device: &Device) -> Result<bool> {
        device.is_done(&self.submission)
    }

    /// Waits for it, takes what it made and adds its numbers to `stats`. Errors: those of the sink; as [`Device::wait`].
    pub fn finish(self, device: &Device, stats: &mut FrameStats, sink: &mut TileSink<'_>) -> Result<()> {
        self.copied.read(device, &self.submission, |bytes| {
            let started = Instant::now();
            if self.counts {
                let steps = bytemuck::try_pod_read_unaligned::<u32>(part(bytes, STEPS, STEP_SUM)?);
                stats.steps += u64::from(steps.map_err(|e| Error::internal(format!("step sum: {e}")))?);
            }
            stats.gpu_ns += timer::nanoseconds(device, part(bytes, TICKS, self.tick_bytes)?)?;
            if let (Some(tile), Some(pixels)) = (self.tile, bytes.get(PIXELS as usize..)) {
                sink(tile, pixels, self.row_bytes)?;
            }
            stats.readback_ns += started.elapsed().as_nanos() as u64;
            Ok(())
        })
    }
}

/// Of what a submission left in its staging buffer.
fn part(bytes: &[u8], begin: u64, size: u64) -> Result<&[u8]> {
    let found = bytes.get(begin as usize..(begin + size) as usize);
    found.ok_or_else(|| Error::internal("a submission's numbers are missing"))
}

/// `slot`: of the sample in its submission.
fn pass_of(request: &FrameRequest, tile: Tile, sample: u32, samples: u32, slot: u32) -> PassUniform {
    let region = request.region;
    let [dx, dy] = sample_offset(sample, samples);
    PassUniform {
        origin: [(region.x + tile.x) as i32 - 1, (region.y + tile.y) as i32 - 1],
        size: [tile.width + 2, tile.height + 2],
        offset: [dx as f32, dy as f32],
        weight: 1.0 / samples as f32,
        first: u32::from(sample == 0),
        slot,
        reserved: 0,
    }
}
