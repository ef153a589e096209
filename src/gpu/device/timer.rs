// SPDX-License-Identifier: MIT OR Apache-2.0
//! GPU time of compute passes, by timestamp queries. Knows nothing of what the passes do.

use super::buffer::Buffer;
use super::readback::{PendingReadback, Readback};
use super::wgpu_device::Device;
use crate::error::{Error, Result};

/// Each pass writes one tick count when it begins and one when it ends.
pub(in crate::gpu) const PASS_BYTES: u64 = 2 * wgpu::QUERY_SIZE as u64;

/// Times the compute passes of one submission after another.
pub struct GpuTimer {
    queries: wgpu::QuerySet,
    resolved: Buffer,
    readback: Readback,
    /// Passes a submission may have.
    capacity: u32,
    /// Passes of the submission being recorded.
    passes: u32,
}

impl GpuTimer {
    /// For submissions of at most `capacity` passes, 1 .. 2048; `None` when the device has no timestamps.
    pub fn new(device: &Device, capacity: u32) -> Result<Option<Self>> {
        if !device.has_timestamps() {
            return Ok(None);
        }
        let descriptor =
            wgpu::QuerySetDescriptor { label: Some("passes"), ty: wgpu::QueryType::Timestamp, count: 2 * capacity };
        let queries = device.scoped("creating timestamps", |device| device.create_query_set(&descriptor))?;
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = device.buffer("timestamps", u64::from(capacity) * PASS_BYTES, usage)?;
        Ok(Some(Self { queries, resolved, readback: Readback::new(), capacity, passes: 0 }))
    }

    /// The entry in a pass's descriptor that has it timed; `None` beyond the capacity.
    pub fn next_pass(&mut self) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        if self.passes == self.capacity {
            return None;
        }
        let begin = 2 * self.passes;
        self.passes += 1;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(begin + 1),
        })
    }

    /// After the last pass, in the same encoder: brings its ticks to `target`, from `offset` (a multiple of 256) on.
    /// How many bytes they are.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::Buffer, offset: u64) -> u64 {
        let passes = std::mem::take(&mut self.passes);
        let bytes = u64::from(passes) * PASS_BYTES;
        if passes > 0 && target.usage().contains(wgpu::BufferUsages::QUERY_RESOLVE) {
            encoder.resolve_query_set(&self.queries, 0..2 * passes, target, offset);
        } else if passes > 0 {
            encoder.resolve_query_set(&self.queries, 0..2 * passes, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, target, offset, bytes);
        }
        bytes
    }

    /// [`Self::resolve`] to a staging buffer of the timer's. `None` when no pass was timed.
    pub fn finish(&mut self, device: &Device, encoder: &mut wgpu::CommandEncoder) -> Result<Option<PendingReadback>> {
        if self.passes == 0 {
            return Ok(None);
        }
        let staging = self.readback.staging(device, u64::from(self.capacity) * PASS_BYTES)?;
        let bytes = self.resolve(encoder, staging.buffer()?, 0);
        Ok(Some(staging.filled(bytes)))
    }
}

/// Nanoseconds that the passes of `submission` took together. Errors: as [`PendingReadback::read`].
pub fn read_time(device: &Device, copied: PendingReadback, submission: &wgpu::SubmissionIndex) -> Result<u64> {
    let ticks = copied.read(device, submission, sum_of_spans)?;
    Ok(in_nanoseconds(device, ticks))
}

/// Nanoseconds that passes took together, by what [`GpuTimer::resolve`] wrote.
pub(in crate::gpu) fn nanoseconds(device: &Device, bytes: &[u8]) -> Result<u64> {
    Ok(in_nanoseconds(device, sum_of_spans(bytes)?))
}

fn in_nanoseconds(device: &Device, ticks: u64) -> u64 {
    (ticks as f64 * device.timestamp_period()) as u64
}

/// The bytes are pairs of begin and end. A driver's clock may jump back; such a span counts as 0.
fn sum_of_spans(bytes: &[u8]) -> Result<u64> {
    let ticks: &[[u64; 2]] =
        bytemuck::try_cast_slice(bytes).map_err(|error| Error::internal(format!("timestamps: {error}")))?;
    Ok(ticks.iter().map(|[begin, end]| end.saturating_sub(*begin)).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_add_up_and_a_backward_one_is_nothing() {
        let ticks = [[10u64, 14], [20, 27], [40, 30]];
        assert_eq!(sum_of_spans(bytemuck::cast_slice(&ticks)).unwrap(), 11);
        assert!(sum_of_spans(&[0; 15]).is_err());
    }
}
