// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame whose steps are being submitted, and what is known of it meanwhile.

use crate::error::Result;
use crate::film::bloom::Bloom;
use crate::gpu::device::handover::Handover;
use crate::gpu::device::semaphores::FrameSync;
use crate::gpu::device::target::GpuTarget;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::passes::outputs_beside::Beside;
use crate::gpu::frame::passes::picture::Stages;
use crate::gpu::frame::plan::setup::FrameTarget;
use crate::gpu::frame::plan::steps::{Step, Steps};
use crate::gpu::frame::plan::target_rows::FrameRows;
use crate::gpu::frame::resources::occluder::Fetch;
use crate::gpu::frame::resources::sky_target::SkyFetch;
use crate::gpu::kernel::variant::{PixelTarget, RecordSource};
use crate::scene::Projection;
use crate::tracer::{FrameRequest, FrameStats, Tile};
use std::sync::Arc;

/// A frame that is prepared and whose steps are being submitted, one after another and before those of any other frame.
pub struct BegunFrame {
    pub(in crate::gpu) stages: Stages,
    /// The host's things, and its sky, which the first submission fetches from targets.
    pub(in crate::gpu) fetch: Option<Fetch>,
    pub(in crate::gpu) sky: Option<SkyFetch>,
    /// Outputs that are made with it.
    pub(in crate::gpu) beside: Option<Beside>,
    pub(in crate::gpu) request: FrameRequest,
    pub(in crate::gpu) target: PixelTarget,
    pub(in crate::gpu) delivery: Delivery,
    /// The targets that the host shares, and the semaphores that go with it; as far as they are not submitted yet.
    pub(in crate::gpu) handed: Option<Handed>,
    pub(in crate::gpu) samples: u32,
    pub(in crate::gpu) projection: Projection,
    pub(in crate::gpu) source: RecordSource,
    pub(in crate::gpu) steps: Steps,
    pub(in crate::gpu) bloom: Option<Bloom>,
    /// Submitted so far.
    pub(in crate::gpu) submitted: u64,
}

/// The place that finished tiles go to.
pub enum Delivery {
    /// There are none.
    Nowhere,
    /// To the host.
    Host,
    /// Where kernels write them, into an image.
    Image,
    /// Where kernels write them, into the rows of a buffer.
    Rows(FrameRows),
    /// Into a texture, by a copy.
    Copied(wgpu::Texture),
}

/// Targets that the host shares, on their way to a frame and back.
pub struct Handed {
    targets: Vec<Arc<GpuTarget>>,
    sync: FrameSync,
    /// The step that takes the targets over was submitted, with the waits.
    taken: bool,
}

impl Delivery {
    pub fn of(target: FrameTarget<'_>) -> Self {
        match target {
            FrameTarget::Nowhere => Self::Nowhere,
            FrameTarget::Host => Self::Host,
            FrameTarget::Image(..) => Self::Image,
            FrameTarget::Buffer(_, rows) => Self::Rows(rows),
            FrameTarget::Copied(texture) => Self::Copied(texture.clone()),
        }
    }

    /// Whether tiles need a buffer of their own, from which they are copied.
    pub fn is_packed(&self) -> bool {
        matches!(self, Self::Host | Self::Copied(_))
    }

    /// The most rows of a tile. Errors: UNSUPPORTED for rows that no kernel reaches.
    pub fn most_rows(&self, device: &Device) -> Result<u32> {
        match self {
            Self::Rows(rows) => rows.most_rows(device),
            _ => Ok(u32::MAX),
        }
    }

    /// Bytes from row to row of a packed tile.
    pub fn pitch(&self, tile: Tile, pixel_bytes: usize) -> u32 {
        let row = tile.width * pixel_bytes as u32;
        match self {
            Self::Copied(_) => row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT),
            _ => row,
        }
    }
}

impl Handed {
    pub fn new(targets: Vec<Arc<GpuTarget>>, sync: FrameSync) -> Self {
        Self { targets, sync, taken: false }
    }

    /// The part that goes with a submission. `writes`: it writes targets; `last` of the frame.
    pub fn handover(&self, writes: bool, last: bool) -> Handover<'_> {
        let begins = !self.taken && (writes || last);
        Handover {
            reads: &[],
            takes: if begins { &self.targets } else { &[] },
            gives: if last { &self.targets } else { &[] },
            waits: if begins { &self.sync.waits } else { &[] },
            signals: if last { &self.sync.signals } else { &[] },
        }
    }

    pub fn submitted(&mut self, writes: bool, last: bool) {
        self.taken |= writes || last;
    }

    /// Ends a frame before its last step, or before its first: the semaphores are waited for and signalled all the
    /// same, and the target is given back in its layout, whatever pixels it has. Errors: whatever the device reports;
    /// the values of the signals may then be asked for again.
    pub fn end(&self, device: &Device) -> Result<()> {
        let handover = self.handover(false, true);
        if !self.taken && handover.waits.is_empty() && handover.signals.is_empty() {
            // Nobody waits for a target that is as it was.
            return Ok(());
        }
        device.submit_handover(None, &handover).map(drop).inspect_err(|_| self.sync.withdraw())
    }
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

    /// The next one.
    pub(in crate::gpu) fn next(&self) -> Option<Step> {
        (!self.is_submitted()).then(|| self.steps.step(self.submitted))
    }
}
