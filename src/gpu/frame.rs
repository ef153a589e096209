//! A frame on the GPU: tile by tile, sample by sample, trace -> shade -> develop -> readback. Each tile's readback overlaps
//! the next tile's work. Knows no host memory: finished tiles go to the sink.

use super::kernels::{Compiled, Look, TextureKind, check_groups};
use super::tables::Tables;
use super::tiles::{MAX_BATCH, Plan};
use super::uniforms::{FrameUniform, PassUniform};
use super::{Buffer, Copied, Device, GpuTimer, GpuTracer, Readback, Texture, for_f32, kernels, variant};
use crate::error::{Error, ErrorKind, Result};
use crate::film::FilmParams;
use crate::renderer::{Backend, FrameRequest, FrameStats, Progress, Tile, TileSink};
use crate::scene::frame::sample_offset;
use crate::scene::{Scene, View};
use std::time::{Duration, Instant};
use wgpu::BufferUsages as Usage;

const GROUP: [u32; 2] = [16, 8];
/// Pixels of a row that a thread of count.wgsl sums.
const COUNT_RUN: u32 = 8;
/// Bytes of a texel of the record textures, and of a pixel's radiance.
const TEXEL: u64 = 16;

/// Buffers that frames of one size share; they grow and stay.
#[derive(Default)]
pub struct FrameBuffers {
    fixed: Option<FixedBuffers>,
    sized: Option<SizedBuffers>,
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
    records: [Texture; 3],
    /// Samples are added by turns: from one to the other. The second is as large as the first only for several samples.
    radiance: [Texture; 2],
    packed: Buffer,
}

/// What the sized buffers serve: largest tile, crossings of the disk a record holds, bytes of a packed pixel.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Size {
    tile: [u32; 2],
    crossings: u32,
    pixel_bytes: u64,
    several_samples: bool,
}

/// The pipelines of a frame with their bindings.
struct Stage {
    compiled: Compiled,
    group: wgpu::BindGroup,
}

struct Stages {
    trace: Stage,
    count: Stage,
    /// Of even and of odd samples.
    shade: [Stage; 2],
    /// After an even and after an odd last sample.
    develop: [Stage; 2],
}

/// A submission that has not been read yet.
struct Pending {
    submission: wgpu::SubmissionIndex,
    pixels: Option<(Tile, Copied)>,
    steps: Copied,
    time: Option<Copied>,
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
        let lens = scene.lens(&request.region)?;
        let settings = for_f32(scene.pixel_settings());
        let samples = if scene.view == View::Light { scene.quality.samples_per_pixel } else { 1 };
        let inside = lens.observer.frame.r <= 2.0;
        let turbulent = scene.turbulence().is_some();
        let variant = kernels::Variant { azimuth: turbulent, ..variant(scene, &settings, inside) };
        // An opaque disk hides all but its first crossing.
        let crossings = if settings.opaque_u.is_some() { 1 } else { settings.max_crossings as u32 };
        // wgpu makes no array texture of one layer on GL.
        let crossings = if self.adapter.backend == Backend::Gl { crossings.max(2) } else { crossings };
        let pixel_bytes = request.format.bytes_per_pixel() as u64;
        // Two record textures, the crossings, and the radiance.
        let textures = 3 + u64::from(crossings) + u64::from(samples > 1);
        let device_bytes = TEXEL * textures + pixel_bytes;
        let max_side = self.device.limits().max_texture_dimension_2d;
        let plan = Plan::new(request, device_bytes, max_side, scene.expected_steps(), samples);

        if self.tables.is_none() {
            self.tables = Some(Tables::new(&self.device)?);
        }
        let tables = self.tables.as_mut().ok_or_else(|| Error::internal("tables vanished"))?;
        tables.update(&self.device, scene)?;
        self.buffers.prepare(
            &self.device,
            Size { tile: plan.largest(), crossings, pixel_bytes, several_samples: samples > 1 },
            self.adapter.software,
        )?;
        let look = Look {
            light: scene.view == View::Light,
            stars: scene.shows_stars() && !request.transparent,
            all_effects: scene.effects.all_light(),
            turbulent,
        };
        let stages = self.buffers.stages(&self.device, &mut self.kernels, tables, variant, look)?;
        let uniform = FrameUniform::new(scene, &lens, &settings)?;
        let film = FilmParams::new(&scene.film, scene.view, request.format, request.transparent);
        self.buffers.write_frame(&self.device, &uniform, &film)?;

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
            pending: None,
            read_time: Duration::ZERO,
        };
        frame.run(plan, progress)?;
        let mut stats = frame.stats;
        stats.readback_ns = frame.read_time.as_nanos() as u64;
        stats.device_bytes = self.device.bytes();
        Ok(stats)
    }
}

impl Size {
    /// Whether buffers of this size hold what the other asks for.
    fn serves(&self, other: &Self) -> bool {
        (0..2).all(|i| self.tile[i] >= other.tile[i])
            && self.crossings >= other.crossings
            && self.pixel_bytes >= other.pixel_bytes
            && (self.several_samples || !other.several_samples)
    }
}

impl FrameBuffers {
    fn prepare(&mut self, device: &Device, size: Size, software: bool) -> Result<()> {
        if self.fixed.is_none() {
            let uniform = Usage::UNIFORM | Usage::COPY_DST;
            self.fixed = Some(FixedBuffers {
                frame: device.buffer("frame", size_of::<FrameUniform>() as u64, uniform)?,
                film: device.buffer("film", size_of::<FilmParams>() as u64, uniform)?,
                passes: device.buffer("passes", u64::from(MAX_BATCH) * pass_stride(device), uniform)?,
                step_sum: device.buffer("step sum", 4, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)?,
            });
            // The clocks of software drivers tell nothing about their threads.
            self.timer = if software { None } else { GpuTimer::new(device, 1)? };
        }
        if !self.sized.as_ref().is_some_and(|s| s.size.serves(&size)) {
            // The old ones go first: both together need not fit.
            self.sized = None;
            let [width, height] = size.tile;
            let traced = [width + 2, height + 2];
            let texture = |kind: TextureKind, label: &str, size: [u32; 2], layers: u32| {
                device.texture(label, kind.format, kind.dimension, size, layers)
            };
            let [sky, meta, disk] = kernels::RECORD;
            let second = if size.several_samples { size.tile } else { [1, 1] };
            let pixels = u64::from(width) * u64::from(height);
            self.sized = Some(SizedBuffers {
                size,
                records: [
                    texture(sky, "record sky", traced, 1)?,
                    texture(meta, "record meta", traced, 1)?,
                    texture(disk, "record disk", traced, size.crossings)?,
                ],
                radiance: [
                    texture(kernels::RADIANCE, "radiance", size.tile, 1)?,
                    texture(kernels::RADIANCE, "radiance", second, 1)?,
                ],
                packed: device.buffer("packed pixels", pixels * size.pixel_bytes, Usage::STORAGE | Usage::COPY_SRC)?,
            });
        }
        Ok(())
    }

    fn parts(&self) -> Result<(&FixedBuffers, &SizedBuffers)> {
        self.fixed.as_ref().zip(self.sized.as_ref()).ok_or_else(|| Error::internal("a frame without buffers"))
    }

    fn stages(
        &self,
        device: &Device,
        kernels: &mut kernels::Kernels,
        tables: &Tables,
        variant: kernels::Variant,
        look: Look,
    ) -> Result<Stages> {
        let (fixed, sized) = self.parts()?;
        let pass = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &fixed.passes,
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<PassUniform>() as u64),
        });
        let (frame, film) = (fixed.frame.as_entire_binding(), fixed.film.as_entire_binding());
        let [sky, meta, disk] = sized.records.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let radiance = sized.radiance.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view));
        let stage = |compiled: Compiled, resources: &[wgpu::BindingResource<'_>]| {
            let group = compiled.bind(device, resources)?;
            Ok::<_, Error>(Stage { compiled, group })
        };
        let compiled = kernels.shade(device, look)?;
        let shade = |from: usize, to: usize| {
            let resources = [
                frame.clone(),
                pass.clone(),
                sky.clone(),
                meta.clone(),
                disk.clone(),
                wgpu::BindingResource::TextureView(&tables.light.view),
                wgpu::BindingResource::TextureView(&tables.star_cells.view),
                radiance[from].clone(),
                radiance[to].clone(),
            ];
            stage(compiled.clone(), &resources)
        };
        let compiled = kernels.develop(device)?;
        let develop = |from: usize| {
            let resources = [film.clone(), pass.clone(), radiance[from].clone(), sized.packed.as_entire_binding()];
            stage(compiled.clone(), &resources)
        };
        Ok(Stages {
            trace: stage(
                kernels.pixels(device, variant)?,
                &[frame.clone(), pass.clone(), sky.clone(), meta.clone(), disk.clone()],
            )?,
            count: stage(kernels.count(device)?, &[pass.clone(), meta.clone(), fixed.step_sum.as_entire_binding()])?,
            shade: [shade(1, 0)?, shade(0, 1)?],
            develop: [develop(0)?, develop(1)?],
        })
    }

    fn write_frame(&self, device: &Device, frame: &FrameUniform, film: &FilmParams) -> Result<()> {
        let (fixed, _) = self.parts()?;
        device.write(&fixed.frame, 0, bytemuck::bytes_of(frame))?;
        device.write(&fixed.film, 0, bytemuck::bytes_of(film))
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
                let next = self.submit(tile, begin..end)?;
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
    fn submit(&mut self, tile: Tile, range: std::ops::Range<u32>) -> Result<Pending> {
        let device = self.device;
        let stride = pass_stride(device);
        let passes = range.clone().map(|sample| self.pass(tile, sample));
        let mut bytes = vec![0; range.len() * stride as usize];
        for (slot, pass) in bytes.chunks_exact_mut(stride as usize).zip(passes) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let groups = |width: u32, height: u32| [width.div_ceil(GROUP[0]), height.div_ceil(GROUP[1])];
        let traced = groups(tile.width + 2, tile.height + 2);
        let inner = groups(tile.width, tile.height);
        let counting = groups((tile.width + 2).div_ceil(COUNT_RUN), tile.height + 2);
        check_groups(device, traced)?;
        let last = range.end == self.samples;
        let mut encoder = device.encoder("frame")?;
        {
            let fixed = self.buffers.fixed.as_ref().ok_or_else(|| Error::internal("a frame without buffers"))?;
            device.write(&fixed.passes, 0, &bytes)?;
            encoder.clear_buffer(&fixed.step_sum, 0, None);
        }
        {
            let timestamps = self.buffers.timer.as_mut().and_then(GpuTimer::next_pass);
            let descriptor = wgpu::ComputePassDescriptor { label: Some("frame"), timestamp_writes: timestamps };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            let mut dispatch = |stage: &Stage, offset: u32, groups: [u32; 2]| {
                pass.set_pipeline(&stage.compiled.pipeline);
                pass.set_bind_group(0, &stage.group, &[offset]);
                pass.dispatch_workgroups(groups[0], groups[1], 1);
            };
            for (i, sample) in range.clone().enumerate() {
                let offset = i as u32 * stride as u32;
                dispatch(&self.stages.trace, offset, traced);
                dispatch(&self.stages.count, offset, counting);
                dispatch(&self.stages.shade[sample as usize % 2], offset, inner);
            }
            if last {
                dispatch(&self.stages.develop[(self.samples as usize - 1) % 2], 0, inner);
            }
        }
        let time = match &mut self.buffers.timer {
            Some(timer) => timer.finish(device, &mut encoder)?,
            None => None,
        };
        let step_sum =
            self.buffers.fixed.as_ref().map(|f| &f.step_sum).ok_or_else(|| Error::internal("no step sum"))?;
        let steps = self.buffers.steps.copy(device, &mut encoder, step_sum, 4)?;
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

    fn pass(&self, tile: Tile, sample: u32) -> PassUniform {
        let region = self.request.region;
        let [dx, dy] = sample_offset(sample, self.samples);
        PassUniform {
            origin: [(region.x + tile.x) as i32 - 1, (region.y + tile.y) as i32 - 1],
            size: [tile.width + 2, tile.height + 2],
            offset: [dx as f32, dy as f32],
            weight: 1.0 / self.samples as f32,
            first: u32::from(sample == 0),
        }
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
