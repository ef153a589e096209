// SPDX-License-Identifier: MIT OR Apache-2.0
//! One submission of a frame, a step of it: recorded, sent, and read when it has run. Knows no scene.

use super::begun_frame::{BegunFrame, Delivery, ExtraCommands};
use crate::error::{Error, Result};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::handover::Handover;
use crate::gpu::device::readback::PendingReadback;
use crate::gpu::device::timer;
use crate::gpu::device::timer::GpuTimer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::resources::frame_buffers::{FrameBuffers, MOST_PASSES, PIXELS};
use crate::gpu::frame::resources::output_buffers::OutputBuffers;
use crate::gpu::frame::uniforms::frame::{PassUniform, pass_of};
use crate::gpu::kernel::stage::{check_groups, pixel_groups};
use crate::gpu::kernel::variant::PixelTarget;
use crate::gpu::lens::records::STEP_SUM;
use crate::scene::output::MOST_OUTPUTS;
use crate::scene::refine::CURVE_SAMPLES;
use crate::tracer::{FrameStats, Tile, TileSink};
use arrayvec::ArrayVec;
use std::time::Instant;

/// Kinds of passes of a submission.
#[derive(Clone, Copy)]
enum PassKind {
    Shading,
    Bloom,
    Development,
}

/// The cells of a step that gathers none.
const NO_CELLS: Tile = Tile { x: 0, y: 0, width: 0, height: 0 };

/// A submission that has not been read yet.
pub struct Submission {
    submission: wgpu::SubmissionIndex,
    /// Ticks of the passes, from `TICKS` on; the sum of the steps; packed pixels.
    copied: PendingReadback,
    tick_bytes: u64,
    /// Bytes of all that comes before the pixels.
    head: u64,
    passes: ArrayVec<PassKind, MOST_PASSES>,
    /// Whether steps were counted, of the picture and of outputs: none are taken where rays are looked up and nothing
    /// else.
    counts: [bool; 2],
    tile: Option<Tile>,
    row_bytes: usize,
    numbers: ArrayVec<TileNumbers, MOST_OUTPUTS>,
}

/// A tile's numbers of an output, in the submission's staging buffer.
struct TileNumbers {
    number: usize,
    tile: Tile,
    begin: u64,
    row_bytes: usize,
}

/// Takes what a submission has made for the host: rows of the picture, or of the output with a number.
pub type PartSink<'a> = dyn FnMut(Option<usize>, Tile, &[u8], usize) -> Result<()> + 'a;

/// Where a submission's staging buffer has what: ticks and pixels where queries and bindings may begin on every device;
/// the steps of the picture and those of outputs.
const TICKS: u64 = 0;
const STEPS: [u64; 2] = [64, 64 + STEP_SUM];
const STEPS_END: u64 = STEPS[1] + STEP_SUM;
const _: () = assert!(TICKS + MOST_PASSES as u64 * timer::PASS_BYTES <= STEPS[0]);

/// Pixels are taken in bands of so many bytes. Threads that present to a window of the device wait for one band at
/// most: 1.4 ms at the 12 GB/s of one core. Much smaller bands would keep the threads that share the copying
/// (`Copiers`) busy waking up.
const BAND_BYTES: usize = 16 << 20;

impl FrameBuffers {
    /// Starts the frame's next step; what it develops is copied to the host.
    pub fn submit(
        &mut self,
        device: &Device,
        own: &mut OutputBuffers,
        frame: &mut BegunFrame,
        then: &mut ExtraCommands<'_>,
    ) -> Result<Option<Submission>> {
        let Some(step) = frame.next() else { return Ok(None) };
        let begins = frame.submitted == 0;
        let stages = &frame.stages;
        let stride = uniform_stride::<PassUniform>(device);
        let pixel_size = frame.request.format.bytes_per_pixel();
        let shaded = step.samples.clone().zip(0..).map(|(sample, slot)| (step.shades, sample, slot));
        // The first is what is developed, which with bloom may be another tile than the shaded one.
        let developed = (step.develops.unwrap_or(step.shades), 0, 0);
        let of = |(tile, sample, i)| {
            let pass = pass_of(&frame.request, tile, (sample, frame.samples), frame.projection, i, step.light_origin);
            let [pixels_first, pixels_row] = match &frame.delivery {
                Delivery::Rows(rows) => {
                    let place = rows.place(device, tile);
                    [place.first, place.row]
                }
                delivery => [0, delivery.pitch(tile, pixel_size) / 4],
            };
            PassUniform { pixels_first, pixels_row, ..pass }
        };
        let outputs = frame.beside.as_ref().filter(|_| step.outputs);
        let outputs =
            outputs.map(|beside| Ok::<_, Error>((beside, beside.group(device, own, step.shades)?))).transpose()?;
        // The ray of an output goes through the pixel's centre.
        let centred = pass_of(&frame.request, step.shades, (0, 1), frame.projection, 0, step.light_origin);
        let twice = |pass: PassUniform| [pass, PassUniform { refined: CURVE_SAMPLES, ..pass }];
        let passes = [of(developed)].into_iter().chain(shaded.map(of).flat_map(twice)).chain([centred]);
        let centre = (1 + 2 * step.samples.len()) * stride as usize;
        let mut places = vec![0; centre + stride as usize];
        for (slot, pass) in places.chunks_exact_mut(stride as usize).zip(passes) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let size_of_tile = [step.shades.width, step.shades.height];
        check_groups(device, pixel_groups(size_of_tile.map(|side| side + 2)))?;
        let developed = step.develops.filter(|_| matches!(frame.delivery, Delivery::Host));
        let row_bytes = developed.map_or(0, |tile| tile.width as usize * pixel_size);
        let pixel_bytes = developed.map_or(0, |tile| row_bytes as u64 * u64::from(tile.height));
        let pixels_end = if pixel_bytes > 0 { PIXELS + pixel_bytes } else { STEPS_END };
        let mut size = pixels_end;
        let mut numbers = ArrayVec::<_, MOST_OUTPUTS>::new();
        for packed in outputs.iter().flat_map(|(beside, _)| beside.packed()) {
            let (tile, begin) = (step.shades, size.next_multiple_of(PIXELS));
            let row_bytes = u64::from(tile.width) * packed.pixel_bytes;
            size = begin + row_bytes * u64::from(tile.height);
            let to = TileNumbers { number: packed.number, tile, begin, row_bytes: row_bytes as usize };
            numbers.push((packed.offset, size - begin, to));
        }
        let staging = match frame.target {
            PixelTarget::Rows if pixel_bytes > 0 => self.mapped.0.staging(device, size)?,
            _ => self.readback.staging(device, size)?,
        };
        let to = staging.buffer()?;
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.passes.write(device, &places)?;
        if let Some(bloom) = &frame.bloom {
            self.bloom.write(device, bloom, step.light_origin, step.gathers.unwrap_or(NO_CELLS))?;
        }
        let mut recording = device.recording("frame")?;
        let encoder = recording.encoder()?;
        let mut reads = ArrayVec::<_, 2>::new();
        if let Some(fetch) = frame.fetch.as_ref().filter(|_| begins) {
            fetch.encode(encoder);
            reads.push(&fetch.read);
        }
        if let Some(sky) = frame.sky.as_ref().filter(|_| begins) {
            sky.encode(encoder);
            reads.push(&sky.read);
        }
        let steps = self.record_store.reset(frame.source, &fixed.step_sum, encoder);
        self.edges.reset(encoder);
        let writes = stages.glare.is_some() || step.develops.is_some();
        let output = stages.output.as_ref().filter(|_| writes);
        let output = output.map(|output| output.group(device, to, step.develops.unwrap_or(step.shades))).transpose()?;
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
                stages.shade(pass, &step, frame.samples, begins, stride as u32, output.as_ref())
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
                let output = glare.output.group(device, to, tile)?;
                in_pass(PassKind::Development, "develop", &mut |pass| {
                    pass.set_bind_group(2, &output, &[]);
                    glare.develop.dispatch(pass, 0, [tile.width, tile.height]);
                });
            }
        }
        let mut counts = [steps.is_some(), false];
        if let Some(steps) = steps {
            encoder.copy_buffer_to_buffer(steps, 0, to, STEPS[0], STEP_SUM);
        }
        if let Some((beside, group)) = &outputs {
            let steps = beside.reset(&self.record_store, own, &fixed.step_sum, encoder);
            passes.push(PassKind::Shading);
            let timestamp_writes = self.timer.as_mut().and_then(GpuTimer::next_pass);
            beside.encode(
                &mut encoder
                    .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("outputs"), timestamp_writes }),
                centre as u32,
                size_of_tile,
                group,
            );
            counts[1] = steps.is_some();
            if let Some(steps) = steps {
                encoder.copy_buffer_to_buffer(steps, 0, to, STEPS[1], STEP_SUM);
            }
        }
        let tick_bytes = self.timer.as_mut().map_or(0, |timer| timer.resolve(encoder, to, TICKS));
        if let Some(packed) = &own.packed {
            for (offset, bytes, to_numbers) in &numbers {
                encoder.copy_buffer_to_buffer(packed, *offset, to, to_numbers.begin, *bytes);
            }
        }
        if let (Some(sized), PixelTarget::Packed, true) = (&self.sized, frame.target, pixel_bytes > 0) {
            encoder.copy_buffer_to_buffer(&sized.packed, 0, to, PIXELS, pixel_bytes);
        }
        if let (Some(sized), Delivery::Copied(texture), Some(tile)) = (&self.sized, &frame.delivery, step.develops) {
            copy_tile(encoder, &sized.packed, frame.delivery.pitch(tile, pixel_size), texture, tile);
        }
        let mut copied = staging.filled(size);
        let last = frame.submitted + 1 == frame.count();
        if last {
            then(encoder)?;
        }
        // The waits are for what is read, too.
        let writes = step.develops.is_some() || outputs.is_some() || !reads.is_empty();
        let handover = frame.handed.as_ref().map_or_else(Handover::default, |handed| handed.handover(writes, last));
        let handover = Handover { reads: &reads, ..handover };
        let submission = device.submit_handover(Some(recording), &handover)?;
        if let Some(handed) = &mut frame.handed {
            handed.submitted(writes, last);
        }
        // The submission runs, and signals, whatever fails from here on.
        frame.submitted += 1;
        if let Some(beside) = &mut frame.beside {
            beside.begun |= step.outputs;
        }
        copied.request(device)?;
        let head = size.min(PIXELS);
        let numbers = numbers.into_iter().map(|(_, _, numbers)| numbers).collect();
        Ok(Some(Submission {
            submission,
            copied,
            tick_bytes,
            head,
            passes,
            counts,
            tile: developed,
            row_bytes,
            numbers,
        }))
    }
}

impl Submission {
    /// The submission to wait for.
    pub fn submission(&self) -> &wgpu::SubmissionIndex {
        &self.submission
    }

    /// Whether it has run, so that [`Self::finish`] does not wait. Errors: as [`Device::wait`].
    pub fn is_done(&self, device: &Device) -> Result<bool> {
        device.is_done(&self.submission)
    }

    /// Waits for it, takes what it made and adds its numbers to `stats`. Errors: those of the sink; as
    /// [`Device::wait`].
    pub fn finish(self, device: &Device, stats: &mut FrameStats, sink: &mut TileSink<'_>) -> Result<()> {
        self.finish_parts(device, stats, &mut |number, tile, pixels, row_bytes| match number {
            None => sink(tile, pixels, row_bytes),
            Some(_) => Err(Error::internal("an output beside a picture came to the host")),
        })
    }

    /// [`Self::finish`] of a frame with outputs for the host.
    pub fn finish_parts(self, device: &Device, stats: &mut FrameStats, sink: &mut PartSink<'_>) -> Result<()> {
        let arrived = self.copied.wait(device, &self.submission)?;
        let started = Instant::now();
        let mut head = [0; PIXELS as usize];
        arrived.part(0..self.head, |bytes| {
            head[..bytes.len()].copy_from_slice(bytes);
            Ok(())
        })?;
        for (_, begin) in self.counts.into_iter().zip(STEPS).filter(|(counts, _)| *counts) {
            let steps = bytemuck::try_pod_read_unaligned::<u32>(part(&head, begin, STEP_SUM)?);
            stats.steps += u64::from(steps.map_err(|e| Error::internal(format!("step sum: {e}")))?);
        }
        let ticks = part(&head, TICKS, self.tick_bytes)?;
        stats.gpu_ns += timer::nanoseconds(device, ticks)?;
        for (kind, ticks) in self.passes.iter().zip(ticks.chunks(timer::PASS_BYTES as usize)) {
            stats.pass_ns[*kind as usize] += timer::nanoseconds(device, ticks)?;
        }
        for band in self.tile.iter().flat_map(|tile| bands(*tile, self.row_bytes)) {
            let bytes = self.row_bytes as u64 * u64::from(band.tile.height);
            let begin = PIXELS + self.row_bytes as u64 * u64::from(band.first_row);
            arrived.part(begin..begin + bytes, |pixels| sink(None, band.tile, pixels, self.row_bytes))?;
        }
        for TileNumbers { number, tile, begin, row_bytes } in self.numbers {
            for band in bands(tile, row_bytes) {
                let begin = begin + row_bytes as u64 * u64::from(band.first_row);
                let end = begin + row_bytes as u64 * u64::from(band.tile.height);
                arrived.part(begin..end, |bytes| sink(Some(number), band.tile, bytes, row_bytes))?;
            }
        }
        stats.readback_ns += started.elapsed().as_nanos() as u64;
        Ok(())
    }
}

/// Rows of a tile that are taken at once.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Band {
    tile: Tile,
    /// The band's first row in the whole tile.
    first_row: u32,
}

/// The tile's rows from the top down, as many at a time as [`BAND_BYTES`] holds.
fn bands(tile: Tile, row_bytes: usize) -> impl Iterator<Item = Band> {
    let rows = (BAND_BYTES / row_bytes.max(1)).max(1);
    (0..tile.height).step_by(rows).map(move |first_row| {
        let height = (rows as u32).min(tile.height - first_row);
        Band { tile: Tile { y: tile.y + first_row, height, ..tile }, first_row }
    })
}

/// Copies a packed tile, whose rows are `pitch` bytes apart, to its place in a texture.
fn copy_tile(
    encoder: &mut wgpu::CommandEncoder,
    packed: &wgpu::Buffer,
    pitch: u32,
    texture: &wgpu::Texture,
    tile: Tile,
) {
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None };
    let to = wgpu::TexelCopyTextureInfo {
        texture,
        mip_level: 0,
        origin: wgpu::Origin3d { x: tile.x, y: tile.y, z: 0 },
        aspect: wgpu::TextureAspect::All,
    };
    let size = wgpu::Extent3d { width: tile.width, height: tile.height, depth_or_array_layers: 1 };
    encoder.copy_buffer_to_texture(wgpu::TexelCopyBufferInfo { buffer: packed, layout }, to, size);
}

/// A part of the numbers that a submission left in its staging buffer.
fn part(bytes: &[u8], begin: u64, size: u64) -> Result<&[u8]> {
    let found = bytes.get(begin as usize..(begin + size) as usize);
    found.ok_or_else(|| Error::internal("a submission's numbers are missing"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_all_rows_of_a_tile_in_their_order() {
        let tile = Tile { x: 3, y: 100, width: 7, height: 10 };
        for (row_bytes, rows) in [(1, 10), (BAND_BYTES / 3, 3), (BAND_BYTES, 1), (2 * BAND_BYTES, 1), (0, 10)] {
            let found = bands(tile, row_bytes).collect::<Vec<_>>();
            assert_eq!(found.len(), 10_usize.div_ceil(rows), "{row_bytes}");
            let mut next = 0;
            for band in found {
                let height = rows.min(10 - next) as u32;
                let expected = Band { tile: Tile { y: 100 + next as u32, height, ..tile }, first_row: next as u32 };
                assert_eq!(band, expected);
                next += rows;
            }
        }
        assert_eq!(bands(Tile { height: 0, ..tile }, 28).count(), 0);
    }
}
