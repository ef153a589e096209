//! Where a frame's ray records come from: traced pixel by pixel into textures. Gives shading its group 1 and knows nothing else of it.

use super::kernels::{self, Kernels, Stage, TextureKind, Variant};
use super::{Buffer, Device, Texture};
use crate::error::{Error, Result};

/// Pixels of a row that a thread of count.wgsl sums.
const COUNT_RUN: u32 = 8;
/// Bytes of a texel of the record textures.
const TEXEL: u64 = 16;

/// Records of traced pixels, of a tile and one pixel around it; they grow and stay.
#[derive(Default)]
pub struct TracedRecords {
    made: Option<Made>,
}

struct Made {
    size: [u32; 2],
    crossings: u32,
    textures: [Texture; 3],
}

/// The buffers that every kernel of a frame shares.
#[derive(Clone)]
pub struct Shared<'a> {
    pub frame: wgpu::BindingResource<'a>,
    /// The `PassUniform` that the dispatch's offset chooses.
    pub pass: wgpu::BindingResource<'a>,
    pub step_sum: wgpu::BindingResource<'a>,
}

/// What makes the records of a tile before they are shaded.
pub struct TraceStages {
    trace: Stage,
    count: Stage,
}

impl TracedRecords {
    /// Bytes of a pixel on the device.
    pub fn bytes_per_pixel(crossings: u32) -> u64 {
        TEXEL * (2 + u64::from(crossings))
    }

    /// Makes room for tiles of `tile` pixels with at most `crossings` crossings of the disk.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2], crossings: u32) -> Result<()> {
        let size = tile.map(|side| side + 2);
        let serves = |m: &Made| (0..2).all(|i| m.size[i] >= size[i]) && m.crossings >= crossings;
        if self.made.as_ref().is_some_and(serves) {
            return Ok(());
        }
        // The old ones go first: both together need not fit.
        self.made = None;
        let texture = |kind: TextureKind, label: &str, layers: u32| {
            device.texture(label, kind.format, kind.dimension, size, layers)
        };
        let [sky, meta, disk] = kernels::TRACED;
        let textures = [
            texture(sky, "record sky", 1)?,
            texture(meta, "record meta", 1)?,
            texture(disk, "record disk", crossings)?,
        ];
        self.made = Some(Made { size, crossings, textures });
        Ok(())
    }

    fn resources(&self) -> Result<[wgpu::BindingResource<'_>; 3]> {
        let made = self.made.as_ref().ok_or_else(|| Error::internal("records without textures"))?;
        Ok(made.textures.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view)))
    }

    /// Group 1 of a shading kernel.
    pub fn group(&self) -> Result<Vec<wgpu::BindingResource<'_>>> {
        Ok(self.resources()?.into())
    }

    pub fn stages(
        &self,
        device: &Device,
        kernels: &mut Kernels,
        variant: Variant,
        shared: &Shared<'_>,
    ) -> Result<TraceStages> {
        let [sky, meta, disk] = self.resources()?;
        let Shared { frame, pass, step_sum } = shared.clone();
        Ok(TraceStages {
            trace: kernels
                .pixels(device, variant)?
                .stage(device, &[&[frame, pass.clone(), sky, meta.clone(), disk]])?,
            count: kernels.count(device)?.stage(device, &[&[pass, meta, step_sum]])?,
        })
    }
}

impl TraceStages {
    /// Traces a tile of `width` x `height` pixels and its margin.
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, [width, height]: [u32; 2]) {
        self.trace.dispatch(pass, offset, [width + 2, height + 2]);
        self.count.dispatch(pass, offset, [(width + 2).div_ceil(COUNT_RUN), height + 2]);
    }
}

/// Bytes of the step sum.
pub const STEP_SUM: u64 = 4;

/// Creates the step sum that `Shared` holds.
pub fn step_sum(device: &Device) -> Result<Buffer> {
    use wgpu::BufferUsages as Usage;
    device.buffer("step sum", STEP_SUM, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)
}
