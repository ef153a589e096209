// SPDX-License-Identifier: MIT OR Apache-2.0
//! One submission of a frame, a step of it: written, recorded and sent. Knows no scene.

use super::begun_frame::{BegunFrame, ExtraCommands};
use super::recorder::{PassKind, Recorder};
use super::staged::Staged;
use super::step_uniforms::place_of_outputs;
use super::under_way::Submission;
use crate::error::{Error, Result};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::handover::Handover;
use crate::gpu::device::readback::Staging;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::resources::frame_buffers::FrameBuffers;
use crate::gpu::frame::resources::output_buffers::OutputBuffers;
use crate::gpu::frame::uniforms::frame::PassUniform;
use crate::gpu::kernel::stage::{check_groups, pixel_groups};
use crate::gpu::kernel::variant::PixelTarget;

impl FrameBuffers {
    /// Starts the frame's next step; what it develops is copied to the host. Errors: whatever the device reports; those
    /// of `then`, which records the end of the frame's last step.
    pub fn submit(
        &mut self,
        device: &Device,
        own: &mut OutputBuffers,
        frame: &mut BegunFrame,
        then: &mut ExtraCommands<'_>,
    ) -> Result<Option<Submission>> {
        let Some(step) = frame.next() else { return Ok(None) };
        let size = [step.shades.width, step.shades.height];
        check_groups(device, pixel_groups(size.map(|side| side + 2)))?;
        let beside = frame.beside_of(&step);
        let outputs = beside.map(|beside| Ok::<_, Error>((beside, beside.group(device, own, step.shades)?)));
        let outputs = outputs.transpose()?;
        let staged = Staged::of(frame, &step);
        let staging = self.staging(device, frame, &staged)?;
        self.write_step(device, frame, &step)?;
        let mut recording = device.recording("frame")?;

        let fixed = self.fixed.as_ref().ok_or_else(|| Error::internal("a frame without buffers"))?;
        let mut recorder = Recorder::new(recording.encoder()?, self.timer.as_mut(), staging.buffer()?);
        let reads = if frame.submitted == 0 { recorder.fetch(frame) } else { Default::default() };
        let steps = self.record_store.reset(frame.source, &fixed.step_sum, recorder.encoder);
        self.edges.reset(recorder.encoder);
        if frame.submitted == 0 {
            recorder.bake(frame);
        }
        recorder.picture(device, frame, &step)?;
        recorder.count(0, steps);
        if let Some((beside, group)) = &outputs {
            let steps = beside.reset(&self.record_store, own, &fixed.step_sum, recorder.encoder);
            let place = place_of_outputs(&step) as u32 * uniform_stride::<PassUniform>(device) as u32;
            recorder.pass(PassKind::Shading, "outputs", |pass| beside.encode(pass, place, size, group));
            recorder.count(1, steps);
        }
        recorder.ticks();
        recorder.copies(frame, &step, &staged, (self.sized.as_ref(), own.packed.as_ref()));
        let last = frame.submitted + 1 == frame.count();
        if last {
            then(recorder.encoder)?;
        }
        let recorded = recorder.end();

        let mut copied = staging.filled(staged.size);
        // The waits are for what is read, too.
        let writes = step.develops.is_some() || outputs.is_some() || !reads.is_empty();
        let handover = frame.handed.as_ref().map_or_else(Handover::default, |handed| handed.handover(writes, last));
        let submission = device.submit_handover(Some(recording), &Handover { reads: &reads, ..handover })?;
        drop(reads);
        // The submission runs, and signals, whatever fails from here on.
        frame.has_submitted(&step, writes);
        copied.request(device)?;
        Ok(Some(Submission { submission, copied, recorded, staged }))
    }

    /// The staging buffer of a step: one that kernels write where they write the host's pixels.
    fn staging(&self, device: &Device, frame: &BegunFrame, staged: &Staged) -> Result<Staging> {
        match frame.target {
            PixelTarget::Rows if staged.pixel_bytes > 0 => self.mapped.0.staging(device, staged.size),
            _ => self.readback.staging(device, staged.size),
        }
    }
}
