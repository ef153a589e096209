// SPDX-License-Identifier: MIT OR Apache-2.0
//! The uniforms of a step, written before it is recorded: a `PassUniform` for each dispatch over its tile, and the
//! grids of bloom.

use super::begun_frame::BegunFrame;
use super::delivery::Delivery;
use crate::emit::moment::Shutter;
use crate::error::{Error, Result};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::steps::Step;
use crate::gpu::frame::resources::frame_buffers::FrameBuffers;
use crate::gpu::frame::uniforms::frame::{PassUniform, pass_of};
use crate::tracer::Tile;

/// The cells of a step that gathers none.
const NO_CELLS: Tile = Tile { x: 0, y: 0, width: 0, height: 0 };

/// The place of the `PassUniform` of a step's outputs: behind those of development and of each sample.
pub fn place_of_outputs(step: &Step) -> usize {
    1 + step.samples.len()
}

/// The `PassUniform`s of a step in their order: of what is developed, of each sample, of outputs.
fn pass_uniforms(device: &Device, frame: &BegunFrame, step: &Step) -> impl Iterator<Item = PassUniform> {
    let pixel_size = frame.request.format.bytes_per_pixel();
    let of = move |(tile, sample, i)| {
        let lens = (frame.projection, frame.shutter);
        let pass = pass_of(&frame.request, tile, (sample, frame.samples), lens, i, step.light_origin);
        let [pixels_first, pixels_row] = match &frame.delivery {
            Delivery::Rows(rows) => {
                let place = rows.place(device, tile);
                [place.first, place.row]
            }
            delivery => [0, delivery.pitch(tile, pixel_size) / 4],
        };
        PassUniform { curve_samples: frame.curve_samples, pixels_first, pixels_row, ..pass }
    };
    // With bloom this may be another tile than the shaded one.
    let developed = (step.develops.unwrap_or(step.shades), 0, 0);
    let shaded = step.samples.clone().zip(0..).map(|(sample, slot)| (step.shades, sample, slot));
    // The ray of an output goes through the pixel's centre.
    let at_once = (frame.projection, Shutter::default());
    let centred = pass_of(&frame.request, step.shades, (0, 1), at_once, 0, step.light_origin);
    [of(developed)].into_iter().chain(shaded.map(of)).chain([centred])
}

impl FrameBuffers {
    /// Errors: as [`Device::write`].
    pub fn write_step(&mut self, device: &Device, frame: &BegunFrame, step: &Step) -> Result<()> {
        let stride = uniform_stride::<PassUniform>(device) as usize;
        let mut places = vec![0; (place_of_outputs(step) + 1) * stride];
        for (slot, pass) in places.chunks_exact_mut(stride).zip(pass_uniforms(device, frame, step)) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&pass));
        }
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.passes.write(device, &places)?;
        match &frame.bloom {
            Some(bloom) => self.bloom.write(device, bloom, step.light_origin, step.gathers.unwrap_or(NO_CELLS)),
            None => Ok(()),
        }
    }
}
