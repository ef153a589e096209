// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame on the GPU: tile by tile, sample by sample, records -> shade (-> bloom) -> develop -> readback, or a
//! window's texture. A frame is prepared ([`GpuTracer::begin`]), submitted step by step, and each step read when it
//! has run, so that readback overlaps the work of the next steps and frames. Knows no host memory: finished tiles go
//! to the sink.

use super::tracer::GpuTracer;
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::frame::passes::outputs_beside::{BesideSetup, PlacedOutput};
use crate::gpu::frame::plan::setup::{FrameTarget, Setup};
use crate::gpu::frame::plan::steps::Steps;
use crate::gpu::frame::plan::tiles::{Budget, TilePlan};
use crate::gpu::frame::resources::bloom_textures::LIGHT_BYTES;
use crate::gpu::frame::resources::edge_list::EdgeList;
use crate::gpu::frame::resources::frame_buffers::Size;
use crate::gpu::frame::resources::occluder::takes_rows;
use crate::gpu::frame::resources::sky_target::level_kernels;
use crate::gpu::frame::resources::tables::Tables;
use crate::gpu::frame::submission::begun_frame::{BegunFrame, ExtraCommands};
use crate::gpu::frame::submission::delivery::Delivery;
use crate::gpu::frame::submission::under_way::Submission;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::variant::{PixelTarget, RecordMaker};
use crate::scene::Scene;
use crate::scene::refine::curve_samples;
use crate::tracer::{FrameRequest, FrameStats, Progress, TileSink};
use std::collections::VecDeque;

/// Largest side of a tile with the border that is traced, pixels. The list of edges of a tile this large is all but
/// the 128 MiB that each device can bind.
const MAX_TILE_SIDE: u32 = 4096;
/// Bytes of a pixel's radiance.
const RADIANCE_BYTES: u64 = 16;

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
        let mut keys = self.planner().set_up(scene, request, self.planner().host_pixels(scene))?.kernels();
        if let Some(window) = window {
            keys.extend(self.planner().set_up(scene, window, PixelTarget::SCREEN)?.kernels());
        }
        let batch = self.kernels.begin(&keys);
        self.kernels.finish(batch)?;
        // Some drivers put their part of a pipeline off until it runs; and a frame needs buffers, tables and a sky as
        // well.
        self.render(scene, request, &mut |_, _, _| Ok(()), progress).map(|_| ())
    }

    /// How many pipelines are not there that such a frame would run in a window; for tests. Errors: as
    /// `Renderer::render`.
    pub fn missing_on_screen(&self, scene: &Scene, request: &FrameRequest) -> Result<usize> {
        Ok(self.kernels.missing(&self.planner().set_up(scene, request, PixelTarget::SCREEN)?.kernels()).len())
    }

    /// Prepares a frame. What is not submitted of it afterwards must be followed by [`Self::forget`]. Errors: as
    /// `Renderer::render`; the tables of lenses are then forgotten.
    pub fn begin(&mut self, scene: &Scene, request: &FrameRequest, target: FrameTarget<'_>) -> Result<BegunFrame> {
        self.begin_with(scene, request, target, &[])
    }

    /// [`Self::begin`] of a frame with outputs beside its picture; `Nowhere`: without one. Errors: as there;
    /// UNSUPPORTED for targets that kernels do not reach.
    pub fn begin_with(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        target: FrameTarget<'_>,
        outputs: &[PlacedOutput<'_>],
    ) -> Result<BegunFrame> {
        let begun = self.try_begin(scene, request, target, outputs);
        if begun.is_err() {
            self.forget();
        }
        begun
    }

    fn try_begin(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        target: FrameTarget<'_>,
        outputs: &[PlacedOutput<'_>],
    ) -> Result<BegunFrame> {
        let pictured = !matches!(target, FrameTarget::Nowhere);
        let of_outputs = (!outputs.is_empty()).then(|| {
            let asked = outputs.iter().map(|(output, _)| *output).collect::<Vec<_>>();
            scene.for_outputs(&asked)
        });
        let scene = of_outputs.as_ref().filter(|_| !pictured).unwrap_or(scene);
        let kind = match target {
            FrameTarget::Image(_, format) => PixelTarget::Image(format),
            FrameTarget::Nowhere => PixelTarget::Packed,
            // One kernel for all of them: others, compiled apart, round a few pixels otherwise on hardware.
            FrameTarget::Host | FrameTarget::Buffer(..) | FrameTarget::Copied(_) => self.planner().host_pixels(scene),
        };
        let delivery = Delivery::of(target);
        let mut setup = self.planner().set_up(scene, request, kind)?;
        let beside = of_outputs.as_ref().map(|scene| {
            BesideSetup::new(&self.planner(), &self.device, scene, request, (outputs, pictured.then_some(&setup)))
        });
        let beside = beside.transpose()?;
        let needed = self.kernels_of(scene, pictured.then_some(&setup));
        let of_beside = beside.as_ref().map(BesideSetup::kernels).unwrap_or_default();
        let batch = self.kernels.begin(&[&needed[..], &of_beside].concat());
        let samples = setup.samples;
        let pixel_bytes = packed_bytes(request, &delivery);
        let steps = self.steps(scene, request, &setup, beside.as_ref(), &delivery)?;

        let tables = Tables::prepare(&mut self.tables, &self.device, scene, &setup)?;
        [setup.uniform.milky_way_size, setup.uniform.map_size] = tables.map_sizes();
        // Rows for the host go where it maps them.
        let staged = kind == PixelTarget::Rows && matches!(delivery, Delivery::Host);
        let packed = if staged { 0 } else { pixel_bytes };
        let size = Size { tile: steps.largest(), pixel_bytes: packed, several_samples: samples > 1 };
        if let Some((bloom, light)) = setup.bloom.as_ref().zip(steps.light()) {
            self.buffers.bloom.prepare(&self.device, bloom, light)?;
        }
        if let Some(meter) = &setup.meter {
            self.buffers.meter.prepare(&self.device, meter)?;
        }
        self.buffers.prepare(&self.device, size, &setup, self.adapter.info.software)?;
        let software = self.adapter.info.software;
        if let Some(beside) = &beside {
            beside.prepare(&self.device, &mut self.buffers, &mut self.output_buffers, size.tile, software)?;
        }
        // Meanwhile the sky and the buffers were made.
        self.kernels.finish(batch)?;
        let fetch = tables.occluder().fetch(&self.device, &self.kernels, scene)?;
        let sky = tables.sky_maps().fetch(&self.device, &self.kernels, scene)?;
        let bake = tables.bake(&self.device, &self.kernels, &setup)?;
        let stages = self.buffers.stages(&self.device, &self.kernels, tables, &setup, target, software)?;
        let beside = beside.map(|beside| {
            let (buffers, own) = (&mut self.buffers, &mut self.output_buffers);
            beside.stages(&self.device, &self.kernels, tables, buffers, own, (size.tile, software))
        });
        let beside = beside.transpose()?;
        let source = setup.record_setup.source;
        let bloom = setup.bloom;
        let projection = scene.camera.projection;
        let request = *request;
        if pictured {
            self.anticipate(scene, &request, kind, needed);
        }
        Ok(BegunFrame {
            stages,
            fetch,
            sky,
            bake,
            beside,
            request,
            target: kind,
            delivery,
            handed: None,
            samples,
            curve_samples: curve_samples(setup.variants.shade.volumes),
            shutter: scene.open_shutter(),
            projection,
            source,
            steps,
            bloom,
            submitted: 0,
        })
    }

    /// The kernels of a frame, but for those of outputs beside its picture; `picture`: its setup, if it has one.
    pub(in crate::gpu) fn kernels_of(&self, scene: &Scene, picture: Option<&Setup>) -> Vec<KernelKey> {
        let mut needed = picture.map(Setup::kernels).unwrap_or_default();
        needed.extend(scene.shown_picture().into_iter().flat_map(|picture| level_kernels(&self.device, picture)));
        needed.extend(takes_rows(scene).then(|| KernelKey::from(KernelKind::OccluderRows)));
        needed
    }

    /// The steps in which the frame is made. Errors: UNSUPPORTED for rows that no kernel reaches.
    pub(in crate::gpu) fn steps(
        &self,
        scene: &Scene,
        request: &FrameRequest,
        setup: &Setup,
        beside: Option<&BesideSetup>,
        delivery: &Delivery,
    ) -> Result<Steps> {
        let (bytes, ray_steps) = cost_of_pixel(scene, setup, beside, packed_bytes(request, delivery));
        let most_rows = delivery.most_rows(&self.device)?;
        let most_rows = most_rows.min(beside.map_or(Ok(u32::MAX), |beside| beside.most_rows(&self.device))?);
        let binding = self.device.limits().max_storage_buffer_binding_size;
        let budget = Budget::of(self.adapter.info.discrete, binding, setup.variants.shade.volumes);
        let longest = self.device.limits().max_texture_dimension_2d;
        let side = longest.min(MAX_TILE_SIDE).min(most_rows.saturating_add(2));
        let (samples, size) = (setup.samples, [request.width, request.height]);
        // Software takes a good part of a second for a sample: a frame that is cancelled ends after the next one.
        let batch = if self.adapter.info.software { 1 } else { samples };
        let Some(bloom) = &setup.bloom else {
            return Ok(Steps::plain(TilePlan::new(budget, request, bytes, side, ray_steps, batch), samples));
        };
        let light = LIGHT_BYTES * size.map(u64::from).iter().product::<u64>();
        let fits = size.iter().all(|side| *side <= longest) && light <= budget.memory;
        if fits && scene.quality.keep_light.unwrap_or(true) {
            return Ok(Steps::kept(TilePlan::new(budget, request, bytes, side, ray_steps, batch), samples, bloom));
        }
        Ok(Steps::twice(request, samples, bloom, |request, pixels| {
            let side = (u64::from(side) / pixels.isqrt()) as u32;
            TilePlan::new(budget, request, (bytes + LIGHT_BYTES) * pixels, side, ray_steps * pixels, batch)
        }))
    }

    /// Starts the frame's next step, if one is left. Errors: whatever the device reports; the tables of lenses are
    /// then forgotten.
    pub fn submit(&mut self, frame: &mut BegunFrame) -> Result<Option<Submission>> {
        self.submit_and(frame, &mut |_| Ok(()))
    }

    /// [`Self::submit`]; the frame's last step ends with what `then` records. Errors: those of `then` as well.
    pub fn submit_and(&mut self, frame: &mut BegunFrame, then: &mut ExtraCommands<'_>) -> Result<Option<Submission>> {
        let submitted = self.buffers.submit(&self.device, &mut self.output_buffers, frame, then);
        if submitted.is_err() {
            self.forget();
        }
        submitted
    }

    /// After a frame that failed or was left before its first step, nobody knows what the tables of lenses hold.
    pub fn forget(&mut self) {
        self.buffers.forget();
        self.output_buffers.forget();
        if let Some(tables) = &mut self.tables {
            tables.forget();
        }
    }
}

/// Bytes of a pixel of a tile that is copied from a buffer of its own; 0: kernels write it where it goes.
fn packed_bytes(request: &FrameRequest, delivery: &Delivery) -> u64 {
    if delivery.is_packed() { request.format.bytes_per_pixel() as u64 } else { 0 }
}

/// Bytes that a pixel of a tile takes on the device, and steps of its rays.
fn cost_of_pixel(scene: &Scene, setup: &Setup, beside: Option<&BesideSetup>, packed_bytes: u64) -> (u64, u64) {
    let samples = setup.samples;
    let sums = if samples > 1 { 2 * RADIANCE_BYTES } else { 0 };
    // A pixel looked up takes as long as a step or two; of a Kerr lens some may have to be integrated, all of them
    // in a view of nothing but the shadow's edge, and those of a picture are shaded, too.
    let steps_of = |setup: &Setup, in_kerr| match setup.record_setup.source.maker {
        _ if setup.record_setup.half => scene.expected_steps(),
        RecordMaker::Traced => scene.expected_steps(),
        RecordMaker::Schwarzschild => 2,
        RecordMaker::Kerr | RecordMaker::KerrDeferred => in_kerr,
    };
    let traced = beside.filter(|beside| beside.takes_rays());
    let ray_steps = steps_of(setup, 8) + traced.map_or(0, |beside| steps_of(&beside.setup, 3).div_ceil(samples.into()));
    // Packed pixels have two staging buffers.
    let bytes = setup.record_setup.bytes_per_pixel()
        + beside.map_or(0, BesideSetup::bytes_per_pixel)
        + sums
        + 3 * packed_bytes
        + EdgeList::BYTES_PER_PIXEL;
    (bytes, ray_steps)
}
