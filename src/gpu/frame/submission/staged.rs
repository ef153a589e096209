// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a step leaves for the host in its staging buffer, and where. Plain numbers.

use super::begun_frame::BegunFrame;
use super::delivery::Delivery;
use crate::gpu::frame::plan::steps::Step;
use crate::gpu::frame::resources::staging_layout::{NUMBERS_END, PIXELS};
use crate::scene::output::MOST_OUTPUTS;
use crate::tracer::Tile;
use arrayvec::ArrayVec;

/// The pixels of a tile, and its numbers of outputs.
pub struct Staged {
    /// The tile whose pixels go to the host.
    pub tile: Option<Tile>,
    pub row_bytes: usize,
    pub pixel_bytes: u64,
    pub numbers: ArrayVec<StagedNumbers, MOST_OUTPUTS>,
    /// Bytes of the whole buffer.
    pub size: u64,
}

/// A tile's numbers of an output.
pub struct StagedNumbers {
    /// The number by which the host knows the output.
    pub number: usize,
    pub tile: Tile,
    /// Where they are made, in the buffer of all outputs for the host.
    pub from: u64,
    pub begin: u64,
    pub row_bytes: usize,
}

impl StagedNumbers {
    pub fn bytes(&self) -> u64 {
        self.row_bytes as u64 * u64::from(self.tile.height)
    }
}

impl Staged {
    pub fn of(frame: &BegunFrame, step: &Step) -> Self {
        let tile = step.develops.filter(|_| matches!(frame.delivery, Delivery::Host));
        let row_bytes = tile.map_or(0, |tile| tile.width as usize * frame.request.format.bytes_per_pixel());
        let pixel_bytes = tile.map_or(0, |tile| row_bytes as u64 * u64::from(tile.height));
        let mut size = if pixel_bytes > 0 { PIXELS + pixel_bytes } else { NUMBERS_END };
        let mut numbers = ArrayVec::new();
        for packed in frame.beside_of(step).iter().flat_map(|beside| beside.packed()) {
            let (tile, begin) = (step.shades, size.next_multiple_of(PIXELS));
            let row_bytes = (u64::from(tile.width) * packed.pixel_bytes) as usize;
            let staged = StagedNumbers { number: packed.number, tile, from: packed.offset, begin, row_bytes };
            size = begin + staged.bytes();
            numbers.push(staged);
        }
        Self { tile, row_bytes, pixel_bytes, numbers, size }
    }
}
