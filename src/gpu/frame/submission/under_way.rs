// SPDX-License-Identifier: MIT OR Apache-2.0
//! A submission that is under way, and what is read of it when it has run. Knows no scene.

use super::recorder::Recorded;
use super::staged::Staged;
use crate::error::{Error, Result};
use crate::gpu::device::readback::PendingReadback;
use crate::gpu::device::timer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::resources::staging_layout::{AUTO_STOPS, PIXELS, STEPS, STOPS_BYTES, TICKS};
use crate::gpu::lens::records::STEP_SUM;
use crate::platform::Instant;
use crate::tracer::{FrameStats, Tile, TileSink};

/// A submission that has not been read yet.
pub struct Submission {
    pub(in crate::gpu) submission: wgpu::SubmissionIndex,
    /// The staging buffer.
    pub(in crate::gpu) copied: PendingReadback,
    pub(in crate::gpu) recorded: Recorded,
    pub(in crate::gpu) staged: Staged,
}

/// Takes what a submission has made for the host: rows of the picture, or of the output with a number.
pub type PartSink<'a> = dyn FnMut(Option<usize>, Tile, &[u8], usize) -> Result<()> + 'a;

/// Pixels are taken in bands of so many bytes. Threads that present to a window of the device wait for one band at
/// most: 1.4 ms at the 12 GB/s of one core. Much smaller bands would keep the threads that share the copying
/// (`Copiers`) busy waking up.
const BAND_BYTES: usize = 16 << 20;

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
        let Self { submission, copied, recorded, staged } = self;
        let arrived = copied.wait(device, &submission)?;
        let started = Instant::now();
        let mut head = [0; PIXELS as usize];
        arrived.part(0..staged.size.min(PIXELS), |bytes| {
            head[..bytes.len()].copy_from_slice(bytes);
            Ok(())
        })?;
        for (_, begin) in recorded.counts.into_iter().zip(STEPS).filter(|(counts, _)| *counts) {
            let steps = bytemuck::try_pod_read_unaligned::<u32>(part(&head, begin, STEP_SUM)?);
            stats.steps += u64::from(steps.map_err(|e| Error::internal(format!("step sum: {e}")))?);
        }
        if recorded.metered {
            let stops = bytemuck::try_pod_read_unaligned::<f32>(part(&head, AUTO_STOPS, STOPS_BYTES)?);
            stats.auto_ev = f64::from(stops.map_err(|e| Error::internal(format!("auto exposure: {e}")))?);
        }
        let ticks = part(&head, TICKS, recorded.tick_bytes)?;
        stats.gpu_ns += timer::nanoseconds(device, ticks)?;
        for (kind, ticks) in recorded.passes.iter().zip(ticks.chunks(timer::PASS_BYTES as usize)) {
            stats.pass_ns[*kind as usize] += timer::nanoseconds(device, ticks)?;
        }
        let pixels = staged.tile.map(|tile| (None, tile, PIXELS, staged.row_bytes));
        let numbers = staged.numbers.iter().map(|to| (Some(to.number), to.tile, to.begin, to.row_bytes));
        for (number, tile, begin, row_bytes) in pixels.into_iter().chain(numbers) {
            for band in bands(tile, row_bytes) {
                let begin = begin + row_bytes as u64 * u64::from(band.first_row);
                let end = begin + row_bytes as u64 * u64::from(band.tile.height);
                arrived.part(begin..end, |bytes| sink(number, band.tile, bytes, row_bytes))?;
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
