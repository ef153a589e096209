// SPDX-License-Identifier: MIT OR Apache-2.0
//! The commands of a step, in their order: what is read of targets, the passes of the picture, those of outputs, and
//! the copies of what they made. Knows neither buffers' sizes nor submissions.

use super::begun_frame::BegunFrame;
use super::delivery::Delivery;
use super::staged::Staged;
use crate::error::Result;
use crate::gpu::device::buffer::{Buffer, uniform_stride};
use crate::gpu::device::target::TargetRead;
use crate::gpu::device::timer::GpuTimer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::steps::Step;
use crate::gpu::frame::resources::frame_buffers::SizedBuffers;
use crate::gpu::frame::resources::staging_layout::{AUTO_STOPS, MOST_PASSES, PIXELS, STEPS, STOPS_BYTES, TICKS};
use crate::gpu::frame::uniforms::frame::PassUniform;
use crate::gpu::kernel::variant::PixelTarget;
use crate::gpu::lens::records::STEP_SUM;
use crate::tracer::Tile;
use arrayvec::ArrayVec;

/// Kinds of passes of a submission.
#[derive(Clone, Copy)]
pub enum PassKind {
    Shading,
    Bloom,
    Development,
}

/// The commands of a step, as far as they are recorded.
pub struct Recorder<'a> {
    pub encoder: &'a mut wgpu::CommandEncoder,
    timer: Option<&'a mut GpuTimer>,
    /// The staging buffer.
    to: &'a wgpu::Buffer,
    recorded: Recorded,
}

/// The numbers about itself that a submission leaves in its staging buffer.
#[derive(Default)]
pub struct Recorded {
    /// The passes whose ticks are there, in their order.
    pub passes: ArrayVec<PassKind, MOST_PASSES>,
    pub tick_bytes: u64,
    /// Whether steps were counted, of the picture and of outputs: none are taken where rays are looked up and nothing
    /// else.
    pub counts: [bool; 2],
    /// Whether the stops that auto exposure adds are there.
    pub metered: bool,
}

impl<'a> Recorder<'a> {
    pub fn new(encoder: &'a mut wgpu::CommandEncoder, timer: Option<&'a mut GpuTimer>, to: &'a wgpu::Buffer) -> Self {
        Self { encoder, timer, to, recorded: Recorded::default() }
    }

    /// Before anything else of a frame: reads targets, which are returned.
    pub fn fetch<'f>(&mut self, frame: &'f BegunFrame) -> ArrayVec<&'f TargetRead, 2> {
        let mut reads = ArrayVec::new();
        if let Some(fetch) = &frame.fetch {
            fetch.encode(self.encoder);
            reads.push(&fetch.read);
        }
        if let Some(sky) = &frame.sky {
            sky.encode(self.encoder);
            reads.push(&sky.read);
        }
        reads
    }

    /// Before the passes of a frame: the structure of its volumes.
    pub fn bake(&mut self, frame: &BegunFrame) {
        if let Some(bake) = &frame.bake {
            self.pass(PassKind::Shading, "structure", |pass| bake.dispatch(pass));
            bake.copy(self.encoder);
        }
    }

    /// A pass, which is timed.
    pub fn pass(&mut self, kind: PassKind, label: &str, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        self.recorded.passes.push(kind);
        let timestamp_writes = self.timer.as_mut().and_then(|timer| timer.next_pass());
        let timed = wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes };
        record(&mut self.encoder.begin_compute_pass(&timed));
    }

    /// The picture's passes: shading, and with bloom what spreads the light, and development.
    pub fn picture(&mut self, device: &Device, frame: &BegunFrame, step: &Step) -> Result<()> {
        let stages = &frame.stages;
        let writes = stages.glare.is_some() || step.develops.is_some();
        let output = stages.output.as_ref().filter(|_| writes);
        let written = step.develops.unwrap_or(step.shades);
        let output = output.map(|output| output.group(device, self.to, written)).transpose()?;
        if !step.samples.is_empty() {
            let stride = uniform_stride::<PassUniform>(device) as u32;
            let begins = frame.submitted == 0;
            self.pass(PassKind::Shading, "frame", |pass| {
                stages.shade(pass, step, frame.samples, begins, stride, output.as_ref());
            });
        }
        let Some(glare) = &stages.glare else { return Ok(()) };
        if let Some(cells) = step.gathers {
            self.pass(PassKind::Bloom, "bloom", |pass| {
                glare.bloom.gather(pass, cells);
                if step.spreads {
                    glare.bloom.spread(pass);
                    glare.meter.iter().for_each(|meter| meter.measure(pass));
                }
            });
            if let Some(meter) = glare.meter.as_ref().filter(|_| step.spreads) {
                self.encoder.copy_buffer_to_buffer(&meter.exposure, 0, self.to, AUTO_STOPS, STOPS_BYTES);
                self.recorded.metered = true;
            }
        }
        if let Some(tile) = step.develops {
            let output = glare.output.group(device, self.to, tile)?;
            self.pass(PassKind::Development, "develop", |pass| {
                pass.set_bind_group(2, &output, &[]);
                glare.develop.dispatch(pass, 0, [tile.width, tile.height]);
            });
        }
        Ok(())
    }

    /// Copies the sum of the steps of the picture's rays (`of` 0) or of the outputs' (1), where there is one.
    pub fn count(&mut self, of: usize, steps: Option<&Buffer>) {
        if let Some(steps) = steps {
            self.encoder.copy_buffer_to_buffer(steps, 0, self.to, STEPS[of], STEP_SUM);
            self.recorded.counts[of] = true;
        }
    }

    /// After the last pass: brings the ticks to the staging buffer.
    pub fn ticks(&mut self) {
        let bytes = self.timer.as_mut().map_or(0, |timer| timer.resolve(self.encoder, self.to, TICKS));
        self.recorded.tick_bytes = bytes;
    }

    /// Copies what the passes made: numbers of outputs, and a packed tile, to the staging buffer or into a texture.
    pub fn copies(
        &mut self,
        frame: &BegunFrame,
        step: &Step,
        staged: &Staged,
        (sized, numbers): (Option<&SizedBuffers>, Option<&Buffer>),
    ) {
        for (from, to) in numbers.into_iter().flat_map(|from| staged.numbers.iter().map(move |to| (from, to))) {
            self.encoder.copy_buffer_to_buffer(from, to.from, self.to, to.begin, to.bytes());
        }
        let Some(SizedBuffers { packed, .. }) = sized else { return };
        if frame.target == PixelTarget::Packed && staged.pixel_bytes > 0 {
            self.encoder.copy_buffer_to_buffer(packed, 0, self.to, PIXELS, staged.pixel_bytes);
        }
        if let (Delivery::Copied(texture), Some(tile)) = (&frame.delivery, step.develops) {
            let pitch = frame.delivery.pitch(tile, frame.request.format.bytes_per_pixel());
            copy_tile(self.encoder, packed, pitch, texture, tile);
        }
    }

    pub fn end(self) -> Recorded {
        self.recorded
    }
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
