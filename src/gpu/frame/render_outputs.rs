// SPDX-License-Identifier: MIT OR Apache-2.0
//! Outputs beside the picture: records of one ray a pixel, and the kernel that writes what outputs want of them
//! (shade/outputs.wgsl), tile by tile. They have buffers and lens tables of their own, because their records hold more
//! than those of the picture, whose bytes stay what they are without outputs. Knows no host memory.

use super::tracer::GpuTracer;
use crate::emit::moment::Shutter;
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::device::readback::PendingReadback;
use crate::gpu::device::timer::{self, GpuTimer};
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::passes::picture::RecordConsumer;
use crate::gpu::frame::plan::setup::Setup;
use crate::gpu::frame::plan::tiles::{Budget, TilePlan};
use crate::gpu::frame::resources::frame_buffers::Size;
use crate::gpu::frame::resources::output_buffers::OutputBuffers;
use crate::gpu::frame::resources::tables::Tables;
use crate::gpu::frame::uniforms::frame::pass_of;
use crate::gpu::frame::uniforms::outputs::OutputsUniform;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::stage::{check_groups, pixel_groups};
use crate::gpu::kernel::variant::{OutputPlaces, PixelTarget, RecordMaker, RecordSource};
use crate::gpu::lens::records::{RecordStages, STEP_SUM};
use crate::gpu::lens::traced::{Shared, structure_group};
use crate::scene::{RayOutput, Scene};
use crate::tracer::{FrameRequest, FrameStats, OutputSink, Progress, Tile};
use std::collections::VecDeque;

/// Tiles under way at once: one is read while the next is made.
const AHEAD: usize = 2;
/// Largest side of a tile.
const MAX_TILE_SIDE: u32 = 4096;
/// Bytes before the numbers in a tile's staging buffer: the pass's ticks, and the steps of its rays.
const HEAD: u64 = 256;
const STEPS: u64 = 64;

/// A tile that has been submitted.
struct OutputTile {
    tile: Tile,
    submission: wgpu::SubmissionIndex,
    copied: PendingReadback,
    counts: bool,
    tick_bytes: u64,
}

/// The kernels that run for each tile.
struct OutputStages {
    records: RecordStages,
    consumer: RecordConsumer,
}

impl GpuTracer {
    /// Errors: as `Renderer::render`.
    pub fn render_outputs(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        outputs: &[RayOutput],
        sink: &mut OutputSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let rendered = self.try_outputs(scene, request, outputs, sink, progress);
        if rendered.is_err() {
            self.output_buffers.forget();
        }
        rendered
    }

    fn try_outputs(
        &mut self,
        scene: &Scene,
        request: &FrameRequest,
        outputs: &[RayOutput],
        sink: &mut OutputSink<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<FrameStats> {
        let setup = self.planner().set_up(scene, request, PixelTarget::Packed)?;
        let batch = self.kernels.begin(&setup.output_kernels(OutputPlaces::default()));
        let pixel_bytes = 4 * outputs.iter().map(|output| output.words() as u64).sum::<u64>();
        let ray_steps = match setup.record_setup.source.maker {
            RecordMaker::Traced => scene.expected_steps(),
            RecordMaker::Schwarzschild => 2,
            RecordMaker::Kerr | RecordMaker::KerrDeferred => 8,
        };
        // The numbers have two staging buffers.
        let bytes = setup.record_setup.bytes_per_pixel() + 3 * pixel_bytes;
        let side = self.device.limits().max_texture_dimension_2d.min(MAX_TILE_SIDE);
        let binding = self.device.limits().max_storage_buffer_binding_size;
        let budget = Budget::of(self.adapter.info.discrete, binding, setup.variants.shade.volumes);
        let plan = TilePlan::new(budget, request, bytes, side, ray_steps, 1);
        let tables = Tables::prepare(&mut self.tables, &self.device, scene, &setup)?;
        let software = self.adapter.info.software;
        let size = Size { tile: plan.largest(), pixel_bytes, several_samples: false };
        let buffers = &mut self.output_buffers;
        buffers.prepare(&self.device, size, &setup, software)?;
        let uniform = OutputsUniform::new(scene, outputs);
        self.kernels.finish(batch)?;
        if let Some(bake) = tables.bake(&self.device, &self.kernels, &setup)? {
            let mut encoder = self.device.encoder("structure")?;
            bake.encode(&mut encoder);
            self.device.submit(encoder)?;
        }
        let stages = buffers.stages(&self.device, &self.kernels, tables, &setup, software)?;
        let rays = u64::from(request.width) * u64::from(request.height);
        let mut stats = FrameStats { rays, ..FrameStats::default() };
        let mut under_way = VecDeque::new();
        let (mut submitted, mut done) = (0, 0);
        while done < plan.count() {
            if under_way.len() < AHEAD && submitted < plan.count() {
                let tile = plan.tile(submitted);
                let pass = pass_of(request, tile, (0, 1), (scene.camera.projection, Shutter::default()), 0, [0, 0]);
                let source = setup.record_setup.source;
                let begins = submitted == 0;
                under_way.push_back(buffers.submit(
                    &self.device,
                    &stages,
                    source,
                    begins,
                    (tile, bytemuck::bytes_of(&pass), uniform.packed(tile)),
                    pixel_bytes,
                )?);
                submitted += 1;
                continue;
            }
            let Some(tile) = under_way.pop_front() else { break };
            tile.finish(&self.device, outputs, &mut stats, sink)?;
            done += 1;
            if !progress(done as f64 / plan.count() as f64) && done < plan.count() {
                return Err(Error::new(ErrorKind::Cancelled, "the progress callback cancelled the outputs"));
            }
        }
        stats.device_bytes = self.device.bytes();
        Ok(stats)
    }
}

impl OutputBuffers {
    fn stages(
        &mut self,
        device: &Device,
        kernels: &Kernels,
        tables: &Tables,
        setup: &Setup,
        software: bool,
    ) -> Result<OutputStages> {
        let missing = || Error::internal("outputs without buffers");
        let fixed = self.frame.fixed.as_ref().ok_or_else(missing)?;
        let sized = self.frame.sized.as_ref().ok_or_else(missing)?;
        let uniform = self.uniform.as_ref().ok_or_else(missing)?;
        let (frame, pass) = (fixed.frame.buffer.as_entire_binding(), fixed.pass());
        let [light_tables, ..] = tables.resources();
        let structure = structure_group(fixed.clouds.buffer(), tables.structure());
        let step_sum = fixed.step_sum.as_entire_binding();
        let common = [frame.clone(), pass.clone(), light_tables.clone()];
        let occluder = tables.occluder().resource();
        let shared = Shared { frame, pass, step_sum, light_tables, structure, occluder, software };
        let records = self.frame.record_store.stages(device, kernels, &setup.record_setup, &shared)?;
        let group = self.frame.record_store.group(setup.record_setup.source)?;
        let target = [uniform.buffer.as_entire_binding(), sized.packed.as_entire_binding()];
        let take = |kernels: &Kernels, source| {
            let key = KernelKey::outputs(source, setup.variants.shade, OutputPlaces::default());
            kernels.get(key)?.stage(device, &[&common, &group, &target])
        };
        let consumer = RecordConsumer::new(kernels, &setup.record_setup, software, take)?;
        Ok(OutputStages { records, consumer })
    }

    /// Submits a tile. `begins`: it is the frame's first.
    fn submit(
        &mut self,
        device: &Device,
        stages: &OutputStages,
        source: RecordSource,
        begins: bool,
        (tile, pass, uniform): (Tile, &[u8], OutputsUniform),
        pixel_bytes: u64,
    ) -> Result<OutputTile> {
        let size = [tile.width, tile.height];
        check_groups(device, pixel_groups(size.map(|side| side + 2)))?;
        let missing = || Error::internal("outputs without buffers");
        let fixed = self.frame.fixed.as_mut().ok_or_else(missing)?;
        let sized = self.frame.sized.as_ref().ok_or_else(missing)?;
        fixed.passes.write(device, pass)?;
        self.uniform.as_mut().ok_or_else(missing)?.write(device, bytemuck::bytes_of(&uniform))?;
        let mut encoder = device.encoder("outputs")?;
        let steps = self.frame.record_store.reset(source, &fixed.step_sum, &mut encoder);
        {
            let timestamp_writes = self.frame.timer.as_mut().and_then(GpuTimer::next_pass);
            let timed = wgpu::ComputePassDescriptor { label: Some("outputs"), timestamp_writes };
            let mut pass = encoder.begin_compute_pass(&timed);
            stages.records.encode(&mut pass, begins, 0, size);
            stages.consumer.dispatch(&mut pass, 0, size);
        }
        let bytes = u64::from(tile.width) * u64::from(tile.height) * pixel_bytes;
        let staging = self.frame.readback.staging(device, HEAD + bytes)?;
        let to = staging.buffer()?;
        if let Some(steps) = steps {
            encoder.copy_buffer_to_buffer(steps, 0, to, STEPS, STEP_SUM);
        }
        let tick_bytes = self.frame.timer.as_mut().map_or(0, |timer| timer.resolve(&mut encoder, to, 0));
        encoder.copy_buffer_to_buffer(&sized.packed, 0, to, HEAD, bytes);
        let mut copied = staging.filled(HEAD + bytes);
        let counts = steps.is_some();
        let submission = device.submit(encoder)?;
        copied.request(device)?;
        Ok(OutputTile { tile, submission, copied, counts, tick_bytes })
    }
}

impl OutputTile {
    /// Waits for it and hands its numbers to `sink`. Errors: those of the sink; as [`Device::wait`].
    fn finish(
        self,
        device: &Device,
        outputs: &[RayOutput],
        stats: &mut FrameStats,
        sink: &mut OutputSink<'_>,
    ) -> Result<()> {
        let arrived = self.copied.wait(device, &self.submission)?;
        if self.counts {
            stats.steps += arrived
                .part(STEPS..STEPS + STEP_SUM, |bytes| Ok(u64::from(bytemuck::pod_read_unaligned::<u32>(bytes))))?;
        }
        let took = arrived.part(0..self.tick_bytes, |bytes| timer::nanoseconds(device, bytes))?;
        stats.gpu_ns += took;
        // Beside the picture's: tracing and shading.
        stats.pass_ns[0] += took;
        let mut begin = HEAD;
        for (index, output) in outputs.iter().enumerate() {
            let row = 4 * output.words() * self.tile.width as usize;
            let end = begin + row as u64 * u64::from(self.tile.height);
            arrived.part(begin..end, |bytes| sink(index, self.tile, bytes, row))?;
            begin = end;
        }
        Ok(())
    }
}
