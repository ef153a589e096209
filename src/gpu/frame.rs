//! A frame on the GPU: tile by tile, sample by sample, records -> shade -> develop -> readback. Each tile's readback overlaps
//! the next tile's work. Knows no host memory: finished tiles go to the sink.

use super::export::{EXPORT_BYTES, imported};
use super::kernels::{FilmLook, Kernels, Look, Source, Stage, TextureKind, check_groups, pixel_groups};
use super::lens_kerr::Wanted;
use super::records::{Making, RecordMakers, RecordStages, STEP_SUM, Shared, step_sum};
use super::tables::Tables;
use super::tiles::{MAX_BATCH, Plan};
use super::uniforms::{FrameUniform, PassUniform};
use super::{Buffer, Copied, Device, GpuTimer, GpuTracer, Readback, Texture, for_f32, kernels, variant};
use crate::error::{Error, ErrorKind, Result};
use crate::film::FilmParams;
use crate::physics::trace::Settings;
use crate::renderer::{Backend, FrameRequest, FrameStats, Progress, Tile, TileSink};
use crate::scene::frame::sample_offset;
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::{Lensing, Region, Scene, View};
use glam::DVec3;
use std::time::{Duration, Instant};
use wgpu::BufferUsages as Usage;

/// Bytes of a pixel's radiance.
const RADIANCE_BYTES: u64 = 16;

/// Buffers that frames of one size share; they grow and stay.
#[derive(Default)]
pub struct FrameBuffers {
    fixed: Option<FixedBuffers>,
    sized: Option<SizedBuffers>,
    makers: RecordMakers,
    pixels: Readback,
    steps: Readback,
    timer: Option<GpuTimer>,
}

struct FixedBuffers {
    frame: Buffer,
    film: Buffer,
    /// One `PassUniform` for each sample of a batch, `pass_stride` apart.
    passes: Buffer,
    step_sum: Buffer,
}

struct SizedBuffers {
    size: Size,
    /// Samples are added by turns: from one to the other; as large as a tile only for several samples.
    radiance: [Texture; 2],
    packed: Buffer,
}

/// What the sized buffers serve: largest tile, bytes of a packed pixel.
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
}

/// How a frame's shading is compiled.
struct Looks {
    look: Look,
    film: FilmLook,
    several_samples: bool,
}

/// Workgroups that share the deferred pixels: enough for a large GPU's few thousand, and on a software driver, where each costs its
/// share of a loop's body however little there is to do, few.
const REST_GROUPS: u32 = 512;
const REST_GROUPS_SOFTWARE: u32 = 16;

/// A submission that has not been read yet.
struct Pending {
    submission: wgpu::SubmissionIndex,
    pixels: Option<(Tile, Copied)>,
    steps: Copied,
    time: Option<Copied>,
}

/// What a frame is set up with before its tiles run.
struct Setup {
    making: Making,
    looks: Looks,
    samples: u32,
    uniform: FrameUniform,
    film: FilmParams,
}

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
            self.buffers.makers.forget();
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
        let setup = self.set_up(scene, request)?;
        let samples = setup.samples;
        let pixel_bytes = request.format.bytes_per_pixel() as u64;
        let sums = if samples > 1 { 2 * RADIANCE_BYTES } else { 0 };
        let max_side = self.device.limits().max_texture_dimension_2d;
        // A pixel looked up takes as long as a step or two; of a Kerr lens some may have to be integrated, all of them in a view
        // of nothing but the shadow's edge.
        let steps = match setup.making.source {
            Source::Traced => scene.expected_steps(),
            Source::Schwarzschild { .. } => 2,
            Source::Kerr { .. } => 8,
        };
        // Packed pixels have two staging buffers.
        let bytes = setup.making.bytes_per_pixel() + sums + 3 * pixel_bytes;
        let plan = Plan::new(request, bytes, max_side, steps, samples);

        if self.tables.is_none() {
            self.tables = Some(Tables::new(&self.device)?);
        }
        let tables = self.tables.as_mut().ok_or_else(|| Error::internal("tables vanished"))?;
        tables.update(&self.device, scene)?;
        let size = Size { tile: plan.largest(), pixel_bytes, several_samples: samples > 1 };
        self.buffers.prepare(&self.device, size, &setup, self.adapter.software)?;
        let stages = self.buffers.stages(&self.device, &mut self.kernels, tables, &setup, self.adapter.software)?;

        let mut frame = Frame {
            device: &self.device,
            buffers: &mut self.buffers,
            stages,
            request,
            samples,
            batch: plan.batch,
            sink,
            stats: FrameStats {
                rays: u64::from(request.width) * u64::from(request.height) * u64::from(samples),
                ..FrameStats::default()
            },
            source: setup.making.source,
            pending: None,
            read_time: Duration::ZERO,
        };
        frame.run(plan, progress)?;
        let mut stats = frame.stats;
        stats.readback_ns = frame.read_time.as_nanos() as u64;
        stats.device_bytes = self.device.bytes();
        Ok(stats)
    }

    fn set_up(&self, scene: &Scene, request: &FrameRequest) -> Result<Setup> {
        let lens = scene.lens(&request.region)?;
        let settings = for_f32(scene.pixel_settings());
        let samples = if scene.view == View::Light { scene.quality.samples_per_pixel } else { 1 };
        let film = FilmParams::new(&scene.film, scene.view, request.format, request.transparent);
        let looks = Looks {
            look: Look {
                light: scene.view == View::Light,
                stars: scene.shows_stars() && !request.transparent,
                all_effects: scene.effects.all_light(),
                disk: scene.disk_u().is_some(),
                opaque: scene.disk.is_some_and(|disk| disk.opacity == 1.0),
                footprints: scene.turbulence().is_some(),
            },
            film: FilmLook::from(&film),
            several_samples: samples > 1,
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
            variant: kernels::Variant { azimuth: pattern, ..variant(scene, settings, inside) },
            // wgpu makes no array texture of one layer on GL.
            crossings: if self.adapter.backend == Backend::Gl { crossings.max(2) } else { crossings },
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
            self.buffers.makers.forget();
        }
        records
    }

    fn try_records(&mut self, scene: &Scene, request: &FrameRequest) -> Result<Vec<Record>> {
        let setup = self.set_up(scene, request)?;
        let tile = [request.width, request.height];
        let device = &self.device;
        let size = Size { tile, pixel_bytes: EXPORT_BYTES, several_samples: false };
        self.buffers.prepare(device, size, &setup, self.adapter.software)?;
        let buffers = &mut self.buffers;
        let (fixed, sized) = buffers
            .fixed
            .as_ref()
            .zip(buffers.sized.as_ref())
            .ok_or_else(|| Error::internal("a frame without buffers"))?;
        let (frame, pass) = (fixed.frame.as_entire_binding(), fixed.pass());
        let footprints = setup.looks.look.footprints;
        let (scene, exported) = ([frame.clone(), pass.clone()], [sized.packed.as_entire_binding()]);
        let shared = Shared { frame: frame.clone(), pass: pass.clone(), step_sum: fixed.step_sum.as_entire_binding() };
        let records = buffers.makers.stages(device, &mut self.kernels, &setup.making, &shared)?;
        let group = buffers.makers.group(setup.making.source)?;
        let take = |kernels: &mut Kernels, source| {
            kernels.export(device, source, footprints)?.stage(device, &[&scene, &group, &exported])
        };
        let taking = Taking::new(&mut self.kernels, &setup.making, self.adapter.software, take)?;

        let whole = Tile { x: 0, y: 0, width: request.width, height: request.height };
        device.write(&fixed.passes, 0, bytemuck::bytes_of(&pass_of(request, whole, 0, 1, 0)))?;
        let mut encoder = device.encoder("records")?;
        buffers.makers.reset(&mut encoder);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            records.encode(&mut pass, true, 0, tile);
            taking.dispatch(&mut pass, 0, tile);
        }
        let bytes = u64::from(request.width) * u64::from(request.height) * EXPORT_BYTES;
        let mut readback = Readback::new();
        let copied = readback.copy(device, &mut encoder, &sized.packed, bytes)?;
        let submission = device.submit(encoder)?;
        readback.read(device, copied, &submission, |bytes| {
            Ok(bytes.chunks_exact(EXPORT_BYTES as usize).map(imported).collect())
        })
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

impl FixedBuffers {
    /// The `PassUniform` that a dispatch's offset chooses.
    fn pass(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.passes,
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<PassUniform>() as u64),
        })
    }
}

impl FrameBuffers {
    /// Makes room, and writes what all tiles share.
    fn prepare(&mut self, device: &Device, size: Size, setup: &Setup, software: bool) -> Result<()> {
        if self.fixed.is_none() {
            let uniform = Usage::UNIFORM | Usage::COPY_DST;
            self.fixed = Some(FixedBuffers {
                frame: device.buffer("frame", size_of::<FrameUniform>() as u64, uniform)?,
                film: device.buffer("film", size_of::<FilmParams>() as u64, uniform)?,
                passes: device.buffer("passes", u64::from(MAX_BATCH) * pass_stride(device), uniform)?,
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
            let bytes = u64::from(size.tile[0]) * u64::from(size.tile[1]) * size.pixel_bytes;
            self.sized = Some(SizedBuffers {
                size,
                radiance: [radiance()?, radiance()?],
                packed: device.buffer("packed pixels", bytes, Usage::STORAGE | Usage::COPY_SRC)?,
            });
        }
        self.makers.prepare(device, &setup.making, size.tile)?;
        let (fixed, _) = self.parts()?;
        device.write(&fixed.frame, 0, bytemuck::bytes_of(&setup.uniform))?;
        device.write(&fixed.film, 0, bytemuck::bytes_of(&setup.film))
    }

    fn parts(&self) -> Result<(&FixedBuffers, &SizedBuffers)> {
        self.fixed.as_ref().zip(self.sized.as_ref()).ok_or_else(|| Error::internal("a frame without buffers"))
    }

    fn stages(
        &mut self,
        device: &Device,
        kernels: &mut Kernels,
        tables: &Tables,
        setup: &Setup,
        software: bool,
    ) -> Result<Stages> {
        let looks = &setup.looks;
        let (fixed, sized) =
            self.fixed.as_ref().zip(self.sized.as_ref()).ok_or_else(|| Error::internal("a frame without buffers"))?;
        let pass = fixed.pass();
        let (frame, film) = (fixed.frame.as_entire_binding(), fixed.film.as_entire_binding());
        let step_sum = fixed.step_sum.as_entire_binding();
        let packed = sized.packed.as_entire_binding();
        let shared = Shared { frame: frame.clone(), pass: pass.clone(), step_sum };
        let made = self.makers.stages(device, kernels, &setup.making, &shared)?;
        let records = self.makers.group(setup.making.source)?;
        let [light, cells] = [&tables.light, &tables.star_cells].map(|t| wgpu::BindingResource::TextureView(&t.view));
        let [even, odd] = sized.radiance.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let shared = [frame, pass.clone(), light, cells];
        let shade = |kernels: &mut Kernels, target: [&wgpu::BindingResource<'_>; 2]| {
            let target = target.map(Clone::clone);
            let take = |kernels: &mut Kernels, source| {
                let compiled = match looks.several_samples {
                    true => kernels.shade_sample(device, source, looks.look)?,
                    false => kernels.shade_only(device, source, looks.look, looks.film)?,
                };
                compiled.stage(device, &[&shared, &records, &target])
            };
            Taking::new(kernels, &setup.making, software, take)
        };
        let shading = if looks.several_samples {
            let shade = [shade(kernels, [&odd, &even])?, shade(kernels, [&even, &odd])?];
            let compiled = kernels.develop(device, looks.film)?;
            let develop = |from: &wgpu::BindingResource<'_>| {
                compiled.stage(device, &[&[film.clone(), pass.clone(), from.clone(), packed.clone()]])
            };
            Shading::Samples { shade, develop: [develop(&even)?, develop(&odd)?] }
        } else {
            Shading::Only(shade(kernels, [&film, &packed])?)
        };
        Ok(Stages { records: made, shading })
    }
}

/// Distance of two `PassUniform`s in their buffer.
fn pass_stride(device: &Device) -> u64 {
    let alignment = u64::from(device.limits().min_uniform_buffer_offset_alignment);
    (size_of::<PassUniform>() as u64).next_multiple_of(alignment)
}

/// A frame being rendered.
struct Frame<'a, 'sink> {
    device: &'a Device,
    buffers: &'a mut FrameBuffers,
    stages: Stages,
    request: &'a FrameRequest,
    samples: u32,
    batch: u32,
    sink: &'a mut TileSink<'sink>,
    stats: FrameStats,
    source: Source,
    pending: Option<Pending>,
    read_time: Duration,
}

impl Frame<'_, '_> {
    fn run(&mut self, plan: Plan, progress: &mut Progress<'_>) -> Result<()> {
        let batches = u64::from(self.samples.div_ceil(self.batch));
        let total = (plan.count() * batches) as f64;
        let mut done = 0;
        for tile in plan.tiles() {
            for begin in (0..self.samples).step_by(self.batch as usize) {
                let end = (begin + self.batch).min(self.samples);
                let begins = self.pending.is_none();
                let next = self.submit(tile, begin..end, begins)?;
                let before = self.pending.replace(next);
                if let Some(before) = before {
                    self.finish(before)?;
                    done += 1;
                    if !progress(done as f64 / total) {
                        return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the frame"));
                    }
                }
            }
        }
        if let Some(last) = self.pending.take() {
            self.finish(last)?;
        }
        // The frame is complete: nothing is left to cancel.
        progress(1.0);
        Ok(())
    }

    /// Starts samples `range` of `tile`; the last ones are followed by development and the copy to the host.
    fn submit(&mut self, tile: Tile, range: std::ops::Range<u32>, begins: bool) -> Result<Pending> {
        let device = self.device;
        let stride = pass_stride(device);
        let slots = range.clone().zip(0..);
        let passes = slots.map(|(sample, slot)| pass_of(self.request, tile, sample, self.samples, slot));
        let mut bytes = vec![0; range.len() * stride as usize];
        for (slot, pass) in bytes.chunks_exact_mut(stride as usize).zip(passes) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let size = [tile.width, tile.height];
        check_groups(device, pixel_groups(size.map(|side| side + 2)))?;
        let last = range.end == self.samples;
        let mut encoder = device.encoder("frame")?;
        {
            let fixed = self.buffers.fixed.as_ref().ok_or_else(|| Error::internal("a frame without buffers"))?;
            device.write(&fixed.passes, 0, &bytes)?;
            encoder.clear_buffer(&fixed.step_sum, 0, None);
            self.buffers.makers.reset(&mut encoder);
        }
        {
            let timestamps = self.buffers.timer.as_mut().and_then(GpuTimer::next_pass);
            let descriptor = wgpu::ComputePassDescriptor { label: Some("frame"), timestamp_writes: timestamps };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            for (i, sample) in range.clone().enumerate() {
                let offset = i as u32 * stride as u32;
                self.stages.records.encode(&mut pass, begins && i == 0, offset, size);
                match &self.stages.shading {
                    Shading::Only(stage) => stage.dispatch(&mut pass, offset, size),
                    Shading::Samples { shade, .. } => shade[sample as usize % 2].dispatch(&mut pass, offset, size),
                }
            }
            if let (Shading::Samples { develop, .. }, true) = (&self.stages.shading, last) {
                develop[(self.samples as usize - 1) % 2].dispatch(&mut pass, 0, size);
            }
        }
        let time = match &mut self.buffers.timer {
            Some(timer) => timer.finish(device, &mut encoder)?,
            None => None,
        };
        let step_sum =
            self.buffers.fixed.as_ref().map(|f| &f.step_sum).ok_or_else(|| Error::internal("no step sum"))?;
        let step_sum = self.buffers.makers.steps(self.source, step_sum);
        let steps = self.buffers.steps.copy(device, &mut encoder, step_sum, STEP_SUM)?;
        let pixels = match (&self.buffers.sized, last) {
            (Some(sized), true) => {
                let size =
                    u64::from(tile.width) * u64::from(tile.height) * self.request.format.bytes_per_pixel() as u64;
                Some((tile, self.buffers.pixels.copy(device, &mut encoder, &sized.packed, size)?))
            }
            _ => None,
        };
        let submission = device.submit(encoder)?;
        Ok(Pending { submission, pixels, steps, time })
    }

    /// Waits for a submission and takes what it made.
    fn finish(&mut self, pending: Pending) -> Result<()> {
        let device = self.device;
        device.wait(&pending.submission)?;
        let started = Instant::now();
        let steps = self.buffers.steps.read(device, pending.steps, &pending.submission, |bytes| {
            bytemuck::try_pod_read_unaligned::<u32>(bytes).map_err(|e| Error::internal(format!("step sum: {e}")))
        })?;
        self.stats.steps += u64::from(steps);
        if let (Some(timer), Some(time)) = (&mut self.buffers.timer, pending.time) {
            self.stats.gpu_ns += timer.read(device, time, &pending.submission)?;
        }
        if let Some((tile, copied)) = pending.pixels {
            let row = tile.width as usize * self.request.format.bytes_per_pixel();
            self.buffers.pixels.read(device, copied, &pending.submission, |bytes| (self.sink)(tile, bytes, row))?;
        }
        self.read_time += started.elapsed();
        Ok(())
    }
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
