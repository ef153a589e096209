// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame whose steps are being submitted, and what is known of it meanwhile.

use super::stages::Stages;
use super::steps::{Step, Steps};
use crate::error::Result;
use crate::film::bloom::Bloom;
use crate::gpu::kernel::variant::{PixelTarget, RecordSource};
use crate::scene::Projection;
use crate::tracer::{FrameRequest, FrameStats};

/// A frame that is prepared and whose steps are being submitted, one after another and before those of any other frame.
pub struct BegunFrame {
    pub(in crate::gpu) stages: Stages,
    pub(in crate::gpu) request: FrameRequest,
    pub(in crate::gpu) target: PixelTarget,
    pub(in crate::gpu) samples: u32,
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
    /// The number of steps.
    pub fn count(&self) -> u64 {
        self.steps.count()
    }

    /// Whether no step is left.
    pub fn is_submitted(&self) -> bool {
        self.submitted == self.count()
    }

    /// The numbers about the frame before anything of it has run.
    pub fn stats(&self) -> FrameStats {
        let rays = u64::from(self.request.width) * u64::from(self.request.height) * u64::from(self.samples);
        FrameStats { rays, lens_tables: self.stages.make_tables().into(), ..FrameStats::default() }
    }

    /// The next one.
    pub(in crate::gpu) fn next(&self) -> Option<Step> {
        (!self.is_submitted()).then(|| self.steps.step(self.submitted))
    }
}
