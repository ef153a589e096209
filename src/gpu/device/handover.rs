// SPDX-License-Identifier: MIT OR Apache-2.0
//! Submissions, and what goes with them where a host shares a target: the commands that take it over and give it back,
//! and the semaphores of a frame. Knows no frames.

use super::process_end;
use super::semaphores::{GpuSemaphore, SemaphoreUse};
use super::target::{GpuTarget, TargetRead};
use super::turns::InUse;
use super::vulkan::barrier;
use super::vulkan::semaphore::{stage, unstage};
use super::wgpu_device::{Device, Uploads};
use crate::deferred::hold;
use crate::error::{Error, Result};
use crate::platform::Instant;
use std::sync::Arc;

/// Waiting goes in pieces of this, between which the device may be lost.
const WAIT_SLICE: std::time::Duration = std::time::Duration::from_millis(20);

/// The part of a frame's handover that goes with one submission.
#[derive(Default)]
pub struct Handover<'a> {
    /// The targets of a frame that this submission is the first to write.
    pub(in crate::gpu) takes: &'a [Arc<GpuTarget>],
    /// Targets that no later submission of the frame writes.
    pub(in crate::gpu) gives: &'a [Arc<GpuTarget>],
    /// Targets that are read before anything else.
    pub(in crate::gpu) reads: &'a [&'a TargetRead],
    pub(in crate::gpu) waits: &'a [SemaphoreUse],
    pub(in crate::gpu) signals: &'a [SemaphoreUse],
}

/// Commands of a submission, which may begin with uploads.
pub struct Recording<'a> {
    /// `None`: they are being submitted.
    encoder: Option<wgpu::CommandEncoder>,
    /// The uploads that are lost unless they are submitted.
    carries: Option<&'a Uploads>,
}

impl Recording<'_> {
    /// Errors: INTERNAL.
    pub fn encoder(&mut self) -> Result<&mut wgpu::CommandEncoder> {
        self.encoder.as_mut().ok_or_else(|| Error::internal("commands that are recorded after their submission"))
    }
}

impl Drop for Recording<'_> {
    fn drop(&mut self) {
        if let Some(uploads) = self.carries {
            uploads.lose();
        }
    }
}

impl Device {
    /// Starts what was written since the last submission, and then what `encoders` have recorded, once all of `waits`
    /// have been signalled; then signals `signals`. Errors: as [`Self::scoped`]; nothing was submitted then.
    pub fn submit_handed<const N: usize>(
        &self,
        encoders: [wgpu::CommandEncoder; N],
        waits: &[SemaphoreUse],
        signals: &[SemaphoreUse],
    ) -> Result<wgpu::SubmissionIndex> {
        self.submit_all(encoders.into(), waits, signals, Vec::new())
    }

    /// Begins recording with what was written since the last submission, so that both are one piece of work. Errors:
    /// as [`Self::encoder`].
    pub(in crate::gpu) fn recording(&self, label: &str) -> Result<Recording<'_>> {
        let Some(encoder) = self.uploads.take() else {
            return Ok(Recording { encoder: Some(self.encoder(label)?), carries: None });
        };
        let recording = Recording { encoder: Some(encoder), carries: Some(&self.uploads) };
        self.check()?;
        self.faults.check(label).map(|()| recording)
    }

    /// [`Self::submit_handed`] with the commands that take a target over and give it back.
    pub(in crate::gpu) fn submit_handover(
        &self,
        mut recording: Option<Recording<'_>>,
        handover: &Handover<'_>,
    ) -> Result<wgpu::SubmissionIndex> {
        let encoder = recording.as_mut().and_then(|recording| recording.encoder.take());
        let submitted = self.submit_with_barriers(encoder, handover);
        if submitted.is_ok() {
            recording.iter_mut().for_each(|recording| recording.carries = None);
        }
        submitted
    }

    fn submit_with_barriers(
        &self,
        encoder: Option<wgpu::CommandEncoder>,
        handover: &Handover<'_>,
    ) -> Result<wgpu::SubmissionIndex> {
        if let Some(parts) = &self.vulkan {
            let mut encoders = Vec::with_capacity(4);
            if !handover.reads.is_empty() {
                let mut reading = self.encoder("reading targets")?;
                let mut read = || handover.reads.iter().for_each(|read| barrier::read(parts, &mut reading, read));
                self.scoped("reading targets", |_| read())?;
                encoders.push(reading);
            }
            if !handover.takes.is_empty() {
                let mut taking = self.encoder("taking targets")?;
                let mut take = || handover.takes.iter().for_each(|target| barrier::take(parts, &mut taking, target));
                self.scoped("taking targets", |_| take())?;
                encoders.push(taking);
            }
            encoders.extend(encoder);
            let read_buffers = handover.reads.iter().filter(|read| !read.target.shape.image);
            if !handover.gives.is_empty() || read_buffers.clone().next().is_some() {
                let mut giving = self.encoder("giving targets")?;
                let mut give = || {
                    read_buffers.clone().for_each(|read| barrier::has_read(parts, &mut giving, &read.target));
                    handover.gives.iter().for_each(|target| barrier::give(parts, &mut giving, target));
                };
                self.scoped("giving targets", |_| give())?;
                encoders.push(giving);
            }
            let read = handover.reads.iter().map(|read| read.target.clone()).collect();
            return self.submit_all(encoders, handover.waits, handover.signals, read);
        }
        self.submit_all(encoder.into_iter().collect(), handover.waits, handover.signals, Vec::new())
    }

    /// `read`: targets that are read, which are kept until the commands have run: wgpu knows nothing of raw copies out
    /// of them and of raw barriers.
    fn submit_all(
        &self,
        encoders: Vec<wgpu::CommandEncoder>,
        waits: &[SemaphoreUse],
        signals: &[SemaphoreUse],
        read: Vec<Arc<GpuTarget>>,
    ) -> Result<wgpu::SubmissionIndex> {
        let queue = self.queue()?;
        let uploads = self.uploads.take();
        let carried = uploads.is_some();
        let submitted = self.submit_recorded(queue, uploads.into_iter().chain(encoders), waits, signals, read);
        if submitted.is_err() && carried {
            self.uploads.lose();
        }
        submitted
    }

    fn submit_recorded(
        &self,
        queue: &wgpu::Queue,
        encoders: impl Iterator<Item = wgpu::CommandEncoder>,
        waits: &[SemaphoreUse],
        signals: &[SemaphoreUse],
        read: Vec<Arc<GpuTarget>>,
    ) -> Result<wgpu::SubmissionIndex> {
        // Mistakes in what was recorded come to light here, before anything is staged.
        let commands =
            self.scoped("recording work", |_| encoders.map(wgpu::CommandEncoder::finish).collect::<Vec<_>>())?;
        self.wait_for_waits()?;
        let submitted = {
            let _holding = hold();
            let _inside = process_end::enter();
            let _turn = self.turns.take();
            stage(queue, raw(waits), raw(signals));
            let submitted = self.scoped("submitting work", |_| queue.submit(commands));
            if submitted.is_err() {
                unstage(queue, raw(waits), raw(signals));
            }
            let submitted = submitted?;
            for SemaphoreUse { semaphore, value } in signals {
                value.iter().for_each(|value| semaphore.has_submitted(*value));
            }
            submitted
        };
        if !waits.is_empty() || !signals.is_empty() || !read.is_empty() {
            let (submission, waits) = (submitted.clone(), waits.to_vec());
            self.turns.in_use().push_back(InUse { submission, waits, _signals: signals.to_vec(), read });
        }
        self.let_go_of_done();
        Ok(submitted)
    }

    /// Lets go of the semaphores, and of targets that were read, of submissions that have run.
    fn let_go_of_done(&self) {
        let mut done = Vec::new();
        let _holding = hold();
        let _inside = process_end::enter();
        let mut in_use = self.turns.in_use();
        while let Some(first) = in_use.front()
            && self.is_done(&first.submission).unwrap_or(false)
        {
            done.extend(in_use.pop_front());
        }
        drop(in_use);
        drop(done);
    }

    /// A target ends: those that submissions have read, and which have run, go now instead of with the next submission.
    pub fn forget_reads(&self) {
        let reads = self.turns.in_use().iter().any(|one| !one.read.is_empty());
        if reads {
            self.let_go_of_done();
        }
    }

    /// A host's own semaphore ends, which no submission under way keeps: it is not asked any more.
    pub fn forget_waits(&self, semaphore: &Arc<GpuSemaphore>) {
        for one in self.turns.in_use().iter_mut() {
            one.waits.retain(|wait| !Arc::ptr_eq(&wait.semaphore, semaphore));
        }
    }

    /// With Mesa's llvmpipe (22.3), whose vkQueueSubmit blocks, for ever if it comes to that, while a submission before
    /// waits for a timeline: waits for those here. Errors: DEVICE_LOST after the time of a hang.
    fn wait_for_waits(&self) -> Result<()> {
        if !self.vulkan.as_ref().is_some_and(|parts| parts.blocks_in_submit()) {
            return Ok(());
        }
        self.let_go_of_done();
        let deadline = Instant::now() + super::wgpu_device::hangs_after();
        let open = self.turns.in_use().iter().flat_map(|one| one.waits.clone()).collect::<Vec<_>>();
        for SemaphoreUse { semaphore, value } in open {
            let Some(value) = value else { continue };
            while !semaphore.wait(value, WAIT_SLICE)? {
                self.check()?;
                if Instant::now() >= deadline {
                    self.lose_hung();
                }
            }
        }
        Ok(())
    }
}

fn raw(uses: &[SemaphoreUse]) -> impl ExactSizeIterator<Item = (&GpuSemaphore, Option<u64>)> {
    uses.iter().map(|one| (&*one.semaphore, one.value))
}
