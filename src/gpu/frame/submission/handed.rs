// SPDX-License-Identifier: MIT OR Apache-2.0
//! The targets that the host shares, and the semaphores, of a frame: taken over by its first submission, given back by
//! its last. Knows no frames.

use crate::error::Result;
use crate::gpu::device::handover::Handover;
use crate::gpu::device::semaphores::FrameSync;
use crate::gpu::device::target::GpuTarget;
use crate::gpu::device::wgpu_device::Device;
use std::sync::Arc;

/// Targets that the host shares, on their way to a frame and back.
pub struct Handed {
    targets: Vec<Arc<GpuTarget>>,
    pub sync: FrameSync,
    /// The step that takes the targets over was submitted, with the waits.
    taken: bool,
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
