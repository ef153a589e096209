//! A frame on the GPU: tile by tile, sample by sample, records -> shade (-> bloom) -> develop -> readback, or a window's texture. A frame is
//! prepared ([`GpuTracer::begin`]), submitted step by step, and each step read when it has run, so that readback overlaps the work
//! of the next steps and frames. Knows no host memory: finished tiles go to the sink.

use super::bloom::{BloomBuffers, BloomStages, LIGHT_BYTES};
use super::export::{EXPORT_BYTES, imported};
use super::kernels::{Compiled, FilmLook, Kernels, Look, PixelTarget, Source, Stage, check_groups, pixel_groups};
use super::lens_kerr::Wanted;
use super::records::{Making, RecordMakers, RecordStages, STEP_SUM, Shared, step_sum};
use super::refine::{EdgeList, Refining};
use super::slots::{RADIANCE, TextureKind};
use super::steps::{Step, Steps};
use super::tables::Tables;
use super::tiles::{MAX_BATCH, MEMORY, Plan};
use super::uniforms::{FrameUniform, PassUniform};
use super::{
    Buffer, Copied, Device, GpuTimer, GpuTracer, Readback, Texture, for_f32, kernels, timer, uniform_stride, variant,
};
use crate::error::{Error, ErrorKind, Result};
use crate::film::FilmParams;
use crate::film::bloom::Bloom;
use crate::physics::trace::Settings;
use crate::renderer::{Backend, FrameRequest, FrameStats, PASSES, Progress, Tile, TileSink};
use crate::scene::frame::sample_offset;
use crate::scene::observer::Lens;
use crate::scene::record::Record;
use crate::scene::refine::{CURVE_SAMPLES, EDGE_SAMPLES};
use crate::scene::{Lensing, Projection, Region, Scene, View};
use arrayvec::ArrayVec;
use glam::DVec3;
use std::collections::VecDeque;
use std::slice;
use std::time::Instant;
use wgpu::BufferUsages as Usage;

/// Passes of a submission, at most one of each kind.
#[derive(Clone, Copy)]
enum PassKind {
    Shading,
    Bloom,
    Development,
}

/// Of a step that gathers none.
const NO_CELLS: Tile = Tile { x: 0, y: 0, width: 0, height: 0 };
/// Largest side of a tile, pixels.
const MAX_TILE_SIDE: u32 = 4096;
/// Bytes of a pixel's radiance.
const RADIANCE_BYTES: u64 = 16;

/// Buffers that frames of one size share; they grow and stay.
#[derive(Default)]
pub struct FrameBuffers {
    fixed: Option<FixedBuffers>,
    sized: Option<SizedBuffers>,
    bloom: BloomBuffers,
    makers: RecordMakers,
    edges: EdgeList,
    readback: Readback,
    /// Where kernels put pixels row by row.
    mapped: Mapped,
    timer: Option<GpuTimer>,
}

struct FixedBuffers {
    frame: Written,
    film: Written,
    /// The same for light that is exposed already.
    film_of_exposed: Written,
    /// One `PassUniform` for what is developed in frames with bloom, two for each sample of a batch, with
    /// `EDGE_SAMPLES` and with `CURVE_SAMPLES`; `uniform_stride` apart.
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
pub struct Written {
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

/// The kernels that shade a sample: of all pixels, and then more rays of those that were listed for their edges.
struct Shades {
    taking: Taking,
    refining: Option<Refining>,
}

/// What turns ray records into packed pixels.
enum Shading {
    /// Of the only sample.
    Only(Shades),
    Samples {
        /// Of even and of odd samples.
        shade: Box<[Shades; 2]>,
        /// After an even and after an odd last sample.
        develop: [Stage; 2],
    },
}

struct Stages {
    records: RecordStages,
    shading: Shading,
    /// Group 3 of the kernels that shade: the list of pixels with edges.
    edges: wgpu::BindGroup,
    put: Put,
    /// In frames with bloom: what follows shading, which then puts light.
    glare: Option<GlareStages>,
}

/// What spreads light, and turns it into pixels.
struct GlareStages {
    bloom: BloomStages,
    develop: Stage,
    put: Put,
}

/// Group 2 of a kernel that puts pixels, or light.
enum Put {
    /// In the same place in every submission.
    Here(wgpu::BindGroup),
    /// In the submission's staging buffer: the group's layout, and the film.
    Staged(wgpu::BindGroupLayout, wgpu::Buffer),
}

/// How a frame's shading is compiled.
struct Looks {
    look: Look,
    /// Of the kernel that ends shading.
    film: FilmLook,
    /// Of development, in frames with bloom.
    developed: Option<FilmLook>,
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
    projection: Projection,
    source: Source,
    steps: Steps,
    bloom: Option<Bloom>,
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
    passes: ArrayVec<PassKind, PASSES>,
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
    bloom: Option<Bloom>,
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
        let stages = self.buffers.stages(&self.device, &mut self.kernels, tables, &setup, target, software)?;
        let source = setup.making.source;
        let bloom = setup.bloom;
        let projection = setup.looks.look.projection;
        let request = *request;
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
        let bloom = Bloom::new(scene, request.format, [request.width, request.height]);
        let developed = FilmLook::new(&film, target);
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
                refines: scene.view == View::Light && scene.quality.refines,
            },
            film: if bloom.is_some() { FilmLook::of_light() } else { developed },
            developed: bloom.is_some().then_some(developed),
            several_samples: samples > 1,
            rows: target == PixelTarget::Rows,
        };
        let making = self.making(scene, &lens, &settings, &request.region);
        let uniform = FrameUniform::new(scene, &lens, &settings)?;
        Ok(Setup { making, looks, samples, uniform, film, bloom })
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
        fixed.passes.write(
            device,
            bytemuck::bytes_of(&pass_of(request, whole, (0, 1), setup.looks.look.projection, 0, [0, 0])),
        )?;
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
    pub fn new(device: &Device, label: &str, size: u64) -> Result<Self> {
        Ok(Self { buffer: device.buffer(label, size, Usage::UNIFORM | Usage::COPY_DST)?, bytes: Vec::new() })
    }

    /// Before the next submission runs, unless it is there already. Errors: as [`Device::write`].
    pub fn write(&mut self, device: &Device, bytes: &[u8]) -> Result<()> {
        if self.bytes != bytes {
            self.bytes.clear();
            device.write(&self.buffer, 0, bytes)?;
            self.bytes.extend_from_slice(bytes);
        }
        Ok(())
    }

    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// After a submission that failed, nobody knows what the buffer holds.
    pub fn forget(&mut self) {
        self.bytes.clear();
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
                film_of_exposed: Written::new(device, "film of exposed light", size_of::<FilmParams>() as u64)?,
                passes: Written::new(
                    device,
                    "passes",
                    u64::from(1 + 2 * MAX_BATCH) * uniform_stride::<PassUniform>(device),
                )?,
                step_sum: step_sum(device)?,
            });
            // The clocks of software drivers tell nothing about their threads.
            self.timer = if software { None } else { GpuTimer::new(device, PASSES as u32)? };
        }
        if !self.sized.as_ref().is_some_and(|s| s.size.serves(&size)) {
            // The old ones go first: both together need not fit.
            self.sized = None;
            let TextureKind { format, dimension } = RADIANCE;
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
        self.edges.prepare(device, if setup.looks.look.refines { size.tile } else { [1, 1] })?;
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.frame.write(device, bytemuck::bytes_of(&setup.uniform))?;
        fixed.film.write(device, bytemuck::bytes_of(&setup.film))?;
        fixed.film_of_exposed.write(device, bytemuck::bytes_of(&setup.film.of_exposed()))
    }

    /// After a submission that failed, nobody knows what the buffers hold.
    fn forget(&mut self) {
        self.makers.forget();
        self.bloom.forget();
        if let Some(fixed) = &mut self.fixed {
            for written in [&mut fixed.frame, &mut fixed.film, &mut fixed.film_of_exposed, &mut fixed.passes] {
                written.forget();
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
        let shades = |kernels: &mut Kernels, target: &[wgpu::BindingResource<'_>]| {
            let take = |kernels: &mut Kernels, source| {
                let compiled = match looks.several_samples {
                    true => kernels.shade_sample(device, source, looks.look)?,
                    false => kernels.shade_only(device, source, looks.look, looks.film)?,
                };
                let groups: [&[_]; 3] = [&shared, &records, target];
                compiled.stage(device, if looks.several_samples { &groups } else { &groups[..2] })
            };
            let making = &setup.making;
            let refine = |kernels: &mut Kernels| {
                let film = (!looks.several_samples).then_some(looks.film);
                let (source, groups) = (making.rest().unwrap_or(making.source), [&shared[..], &records, target]);
                let groups = if film.is_some() { &groups[..2] } else { &groups };
                Refining::new(device, kernels, (source, making.variant), (looks.look, film), groups, software)
            };
            let refining = if looks.look.refines { Some(refine(kernels)?) } else { None };
            Ok::<_, Error>(Shades { taking: Taking::new(kernels, making, software, take)?, refining })
        };
        let puts = match looks.several_samples {
            true => kernels.develop(device, looks.film, None)?,
            false => kernels.shade_only(device, setup.making.source, looks.look, looks.film)?,
        };
        let shading = if looks.several_samples {
            let develop =
                |from: wgpu::BindingResource<'_>| puts.stage(device, &[slice::from_ref(&pass), slice::from_ref(&from)]);
            Shading::Samples {
                shade: Box::new([
                    shades(kernels, &[odd.clone(), even.clone()])?,
                    shades(kernels, &[even.clone(), odd.clone()])?,
                ]),
                develop: [develop(even)?, develop(odd)?],
            }
        } else {
            Shading::Only(shades(kernels, &[])?)
        };
        let edges = self.edges.group(device, &kernels.edge_list(device)?)?;
        let group = |puts: &Compiled, film: &Written, pixels| {
            device.bind(puts.target()?, &[film.buffer.as_entire_binding(), pixels])
        };
        let put_pixels = |puts: &Compiled, film: &Written| match target {
            FrameTarget::Screen(texture) => {
                group(puts, film, wgpu::BindingResource::TextureView(&texture.view)).map(Put::Here)
            }
            FrameTarget::Host if looks.rows => Ok(Put::Staged(puts.target()?.clone(), (*film.buffer).clone())),
            FrameTarget::Host => group(puts, film, sized.packed.as_entire_binding()).map(Put::Here),
        };
        let (put, glare) = match (&setup.bloom, looks.developed) {
            (Some(bloom), Some(look)) => {
                let develops = kernels.develop(device, look, Some(bloom.factor))?;
                let glare = GlareStages {
                    bloom: self.bloom.stages(device, kernels, bloom)?,
                    develop: develops.stage(device, &[slice::from_ref(&pass), &self.bloom.group(bloom)?])?,
                    put: put_pixels(&develops, &fixed.film_of_exposed)?,
                };
                (Put::Here(group(&puts, &fixed.film, self.bloom.light()?)?), Some(glare))
            }
            _ => (put_pixels(&puts, &fixed.film)?, None),
        };
        Ok(Stages { records: made, shading, edges, put, glare })
    }
}

impl Shades {
    /// `offsets`: of the sample's two `PassUniform`s.
    fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offsets: [u32; 2], tile: [u32; 2]) {
        self.taking.dispatch(pass, offsets[0], tile);
        if let Some(refining) = &self.refining {
            refining.dispatch(pass, offsets);
        }
    }
}

impl Stages {
    /// Shades samples of a tile; the last one is followed by the sum's development, or, with bloom, by giving it to the light.
    fn shade(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        step: &Step,
        samples: u32,
        begins: bool,
        stride: u32,
        put: Option<&wgpu::BindGroup>,
    ) {
        let tile = [step.shades.width, step.shades.height];
        pass.set_bind_group(3, &self.edges, &[]);
        for (sample, slot) in step.samples.clone().zip((1..).step_by(2)) {
            let offset = slot * stride;
            self.records.encode(pass, begins && slot == 1, offset, tile);
            match &self.shading {
                Shading::Only(shades) => {
                    pass.set_bind_group(2, put, &[]);
                    shades.dispatch(pass, [offset, offset + stride], tile);
                }
                Shading::Samples { shade, .. } => {
                    shade[sample as usize % 2].dispatch(pass, [offset, offset + stride], tile);
                }
            }
        }
        if let (Shading::Samples { develop, .. }, true) = (&self.shading, step.samples.end == samples) {
            pass.set_bind_group(2, put, &[]);
            develop[(samples as usize - 1) % 2].dispatch(pass, stride, tile);
        }
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
    fn next(&self) -> Option<Step> {
        (!self.is_submitted()).then(|| self.steps.step(self.submitted))
    }
}

impl FrameBuffers {
    /// Starts the frame's next step; what it develops is copied to the host.
    fn submit(
        &mut self,
        device: &Device,
        frame: &mut BegunFrame,
        then: &mut Recording<'_>,
    ) -> Result<Option<Submitted>> {
        let Some(step) = frame.next() else { return Ok(None) };
        let begins = frame.submitted == 0;
        let stages = &frame.stages;
        let stride = uniform_stride::<PassUniform>(device);
        let shaded = step.samples.clone().zip(0..).map(|(sample, slot)| (step.shades, sample, slot));
        // The first is what is developed, which with bloom may be another tile than the shaded one.
        let developed = (step.develops.unwrap_or(step.shades), 0, 0);
        let of = |(tile, sample, i)| {
            pass_of(&frame.request, tile, (sample, frame.samples), frame.projection, i, step.light_origin)
        };
        let twice = |pass: PassUniform| [pass, PassUniform { refined: CURVE_SAMPLES, ..pass }];
        let passes = [of(developed)].into_iter().chain(shaded.map(of).flat_map(twice));
        let mut places = vec![0; (1 + 2 * step.samples.len()) * stride as usize];
        for (slot, pass) in places.chunks_exact_mut(stride as usize).zip(passes) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let size_of_tile = [step.shades.width, step.shades.height];
        check_groups(device, pixel_groups(size_of_tile.map(|side| side + 2)))?;
        let developed = step.develops.filter(|_| frame.target != PixelTarget::Screen);
        let row_bytes = developed.map_or(0, |tile| tile.width as usize * frame.request.format.bytes_per_pixel());
        let pixel_bytes = developed.map_or(0, |tile| row_bytes as u64 * u64::from(tile.height));
        let size = if pixel_bytes > 0 { PIXELS + pixel_bytes } else { STEPS + STEP_SUM };
        let staging = match frame.target {
            PixelTarget::Rows if pixel_bytes > 0 => self.mapped.0.staging(device, size)?,
            _ => self.readback.staging(device, size)?,
        };
        let to = staging.buffer()?;
        let mut encoder = device.encoder("frame")?;
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.passes.write(device, &places)?;
        if let Some(bloom) = &frame.bloom {
            self.bloom.write(device, bloom, step.light_origin, step.gathers.unwrap_or(NO_CELLS))?;
        }
        let steps = self.makers.reset(frame.source, &fixed.step_sum, &mut encoder);
        self.edges.reset(&mut encoder);
        let puts = stages.glare.is_some() || step.develops.is_some();
        let put = if puts { Some(stages.put.group(device, to)?) } else { None };
        let timer = &mut self.timer;
        let mut passes = ArrayVec::new();
        let mut in_pass = |kind: PassKind, label: &str, record: &mut dyn FnMut(&mut wgpu::ComputePass<'_>)| {
            passes.push(kind);
            let timestamp_writes = timer.as_mut().and_then(GpuTimer::next_pass);
            record(
                &mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes }),
            );
        };
        if !step.samples.is_empty() {
            in_pass(PassKind::Shading, "frame", &mut |pass| {
                stages.shade(pass, &step, frame.samples, begins, stride as u32, put.as_ref())
            });
        }
        if let Some(glare) = &stages.glare {
            if let Some(cells) = step.gathers {
                in_pass(PassKind::Bloom, "bloom", &mut |pass| {
                    glare.bloom.gather(pass, cells);
                    if step.spreads {
                        glare.bloom.spread(pass);
                    }
                });
            }
            if let Some(tile) = step.develops {
                let put = glare.put.group(device, to)?;
                in_pass(PassKind::Development, "develop", &mut |pass| {
                    pass.set_bind_group(2, &put, &[]);
                    glare.develop.dispatch(pass, 0, [tile.width, tile.height]);
                });
            }
        }
        let counts = steps.is_some();
        if let Some(steps) = steps {
            encoder.copy_buffer_to_buffer(steps, 0, to, STEPS, STEP_SUM);
        }
        let tick_bytes = self.timer.as_mut().map_or(0, |timer| timer.resolve(&mut encoder, to, TICKS));
        if let (Some(sized), PixelTarget::Packed, true) = (&self.sized, frame.target, pixel_bytes > 0) {
            encoder.copy_buffer_to_buffer(&sized.packed, 0, to, PIXELS, pixel_bytes);
        }
        let mut copied = staging.filled(size);
        if frame.submitted + 1 == frame.count() {
            then(&mut encoder)?;
        }
        let submission = device.submit(encoder)?;
        copied.request(device)?;
        frame.submitted += 1;
        Ok(Some(Submitted { submission, copied, tick_bytes, passes, counts, tile: developed, row_bytes }))
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
            let ticks = part(bytes, TICKS, self.tick_bytes)?;
            stats.gpu_ns += timer::nanoseconds(device, ticks)?;
            for (kind, ticks) in self.passes.iter().zip(ticks.chunks(timer::PASS_BYTES as usize)) {
                stats.pass_ns[*kind as usize] += timer::nanoseconds(device, ticks)?;
            }
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

/// Of the sample of so many, the `slot`th of its submission.
fn pass_of(
    request: &FrameRequest,
    tile: Tile,
    (sample, samples): (u32, u32),
    projection: Projection,
    slot: u32,
    light_origin: [u32; 2],
) -> PassUniform {
    let region = request.region;
    let [dx, dy] = sample_offset(sample, samples, projection);
    PassUniform {
        origin: [(region.x + tile.x) as i32 - 1, (region.y + tile.y) as i32 - 1],
        size: [tile.width + 2, tile.height + 2],
        offset: [dx as f32, dy as f32],
        weight: 1.0 / samples as f32,
        first: u32::from(sample == 0),
        slot,
        refined: EDGE_SAMPLES,
        light_origin: light_origin.map(|v| v as i32),
    }
}
