// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame whose steps are being submitted, and what is known of it meanwhile.

use super::delivery::Delivery;
use super::handed::Handed;
use crate::emit::moment::Shutter;
use crate::error::Result;
use crate::film::bloom::Bloom;
use crate::gpu::device::semaphores::FrameSync;
use crate::gpu::device::target::GpuTarget;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::passes::outputs_beside::Beside;
use crate::gpu::frame::passes::picture::Stages;
use crate::gpu::frame::plan::steps::{Step, Steps};
use crate::gpu::frame::resources::baked::Bake;
use crate::gpu::frame::resources::occluder::Fetch;
use crate::gpu::frame::resources::sky_target::SkyFetch;
use crate::gpu::kernel::variant::{PixelTarget, RecordSource};
use crate::scene::Projection;
use crate::tracer::{FrameRequest, FrameStats};
use std::sync::Arc;

/// A frame that is prepared and whose steps are being submitted, one after another and before those of any other frame.
pub struct BegunFrame {
    pub(in crate::gpu) stages: Stages,
    /// The host's things, and its sky, which the first submission fetches from targets.
    pub(in crate::gpu) fetch: Option<Fetch>,
    pub(in crate::gpu) sky: Option<SkyFetch>,
    /// The structure of its volumes, which the first submission makes.
    pub(in crate::gpu) bake: Option<Bake>,
    /// Outputs that are made with it.
    pub(in crate::gpu) beside: Option<Beside>,
    pub(in crate::gpu) request: FrameRequest,
    pub(in crate::gpu) target: PixelTarget,
    pub(in crate::gpu) delivery: Delivery,
    /// The targets that the host shares, and the semaphores that go with it; as far as they are not submitted yet.
    pub(in crate::gpu) handed: Option<Handed>,
    pub(in crate::gpu) samples: u32,
    /// Samples of a pixel that the critical curve runs through.
    pub(in crate::gpu) curve_samples: u32,
    pub(in crate::gpu) shutter: Shutter,
    pub(in crate::gpu) projection: Projection,
    pub(in crate::gpu) source: RecordSource,
    pub(in crate::gpu) steps: Steps,
    pub(in crate::gpu) bloom: Option<Bloom>,
    /// Submitted so far.
    pub(in crate::gpu) submitted: u64,
}

/// Records further commands into the last submission of a frame.
pub type ExtraCommands<'a> = dyn FnMut(&mut wgpu::CommandEncoder) -> Result<()> + 'a;

impl BegunFrame {
    /// The frame waits for the semaphores before it writes the targets, and signals when it has.
    pub fn hand_over(&mut self, targets: Vec<Arc<GpuTarget>>, sync: FrameSync) {
        self.handed = Some(Handed::new(targets, sync));
    }

    /// After a failure: gives the signals all the same; but, unless `always`, of a frame without a step that was
    /// submitted takes them back. Errors: as [`Handed::end`].
    pub fn give_signals(&mut self, device: &Device, always: bool) -> Result<()> {
        match self.handed.take() {
            // They went with the last step.
            Some(_) if self.is_submitted() => Ok(()),
            Some(handed) if always || self.submitted > 0 => handed.end(device),
            Some(handed) => {
                handed.sync.withdraw();
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// The number of steps.
    pub fn count(&self) -> u64 {
        self.steps.count()
    }

    /// The number of steps that are submitted.
    pub fn submitted(&self) -> u64 {
        self.submitted
    }

    /// Whether no step is left.
    pub fn is_submitted(&self) -> bool {
        self.submitted == self.count()
    }

    /// The numbers about the frame before anything of it has run.
    pub fn stats(&self) -> FrameStats {
        let beside = self.beside.as_ref();
        let samples = self.samples + u32::from(beside.is_some_and(Beside::takes_rays));
        let rays = u64::from(self.request.width) * u64::from(self.request.height) * u64::from(samples);
        let lens_tables = u64::from(self.stages.make_tables()) + u64::from(beside.is_some_and(Beside::make_tables));
        FrameStats { rays, lens_tables, ..FrameStats::default() }
    }

    /// The outputs that a step makes.
    pub(in crate::gpu) fn beside_of(&self, step: &Step) -> Option<&Beside> {
        self.beside.as_ref().filter(|_| step.outputs)
    }

    /// The next step is submitted. `writes`: it writes or reads the host's targets.
    pub(in crate::gpu) fn has_submitted(&mut self, step: &Step, writes: bool) {
        self.submitted += 1;
        let last = self.is_submitted();
        if let Some(handed) = &mut self.handed {
            handed.submitted(writes, last);
        }
        if let Some(beside) = &mut self.beside {
            beside.begun |= step.outputs;
        }
    }

    /// The next one.
    pub(in crate::gpu) fn next(&self) -> Option<Step> {
        (!self.is_submitted()).then(|| self.steps.step(self.submitted))
    }
}
