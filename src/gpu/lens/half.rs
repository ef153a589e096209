// SPDX-License-Identifier: MIT OR Apache-2.0
//! Matter with depth at half resolution on the GPU: the records of blocks, the list of pixels that they do not tell,
//! the media of pixels that have no records of their own, and the kernels that make and use them (`emit::half` has the
//! rule). Knows no scene and no light.

use super::pixel_list::PixelList;
use super::traced::{Shared, TracedRecords, pixel_group};
use crate::emit::half::{BLOCK, STENCIL};
use crate::error::{Error, Result};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::choices::Choice;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::slots::TRACED;
use crate::gpu::kernel::stage::{Stage, list_groups};
use crate::gpu::kernel::variant::TraceVariant;

/// Bytes of `OwnRays` of traced/own_rays.wgsl before the pixels.
const HEAD: u64 = 16 * 4;

/// Pixels of a tile for each workgroup of a software driver (`list_groups`): all may be listed, and a workgroup takes
/// 64 at a time.
const PIXELS_PER_GROUP: u32 = 128;

/// The records of blocks, the list of pixels, and the media of pixels that are looked up; they grow and stay.
pub struct HalfBlocks {
    records: TracedRecords,
    list: PixelList,
    media: Option<([u32; 2], Texture)>,
}

impl Default for HalfBlocks {
    fn default() -> Self {
        let list = PixelList::new("rays of their own", HEAD, Self::BYTES_PER_PIXEL);
        Self { records: Default::default(), list, media: None }
    }
}

/// The kernels that give the pixels of a tile their media, once they are traced without.
pub struct HalfStages {
    blocks: Stage,
    fill: Stage,
    listed: Stage,
    software: bool,
}

/// The keys of these kernels; `variant`: how rays are traced that matter is summed along; `own_records`: pixels have
/// traced records, which their media are kept with.
pub fn keys(variant: TraceVariant, own_records: bool) -> [KernelKey; 3] {
    let own_records = [(Choice::OWN_RECORDS, own_records.into())];
    [KernelKind::Blocks, KernelKind::Fill, KernelKind::Listed]
        .map(|kind| KernelKey::new(kind, &[&variant, &own_records]))
}

/// The most blocks along a side of a tile of so many pixels, wherever it begins.
fn most_blocks(pixels: u32) -> u32 {
    pixels / BLOCK as u32 + STENCIL as u32
}

impl HalfBlocks {
    /// Bytes of a tile's pixel in the list.
    pub const BYTES_PER_PIXEL: u64 = 4;

    /// Makes room for the blocks of a tile with so many layers.
    pub fn prepare(&mut self, device: &Device, tile: [u32; 2], layers: u32) -> Result<()> {
        self.records.prepare(device, tile.map(most_blocks), layers)?;
        self.list.prepare(device, tile)
    }

    /// Makes room for the media of a tile's pixels that are looked up; `None`: no matter is summed, and only the
    /// binding is to be there.
    pub fn prepare_media(&mut self, device: &Device, tile: Option<[u32; 2]>, layers: u32) -> Result<()> {
        let size = tile.map_or([1, 1], |tile| tile.map(|side| side + 2));
        if self.media.as_ref().is_some_and(|(room, _)| (0..2).all(|i| room[i] >= size[i])) {
            return Ok(());
        }
        // The old ones go first: both together need not fit.
        self.media = None;
        let [.., kind] = TRACED;
        self.media = Some((size, device.texture("media", kind.format, kind.dimension, size, layers)?));
        Ok(())
    }

    /// `media` of lens/media.wgsl. Errors: INTERNAL before [`Self::prepare_media`].
    pub fn media(&self) -> Result<wgpu::BindingResource<'_>> {
        let media = self.media.as_ref().ok_or_else(|| Error::internal("pixels without media"))?;
        Ok(wgpu::BindingResource::TextureView(&media.1.view))
    }

    /// Empties the list.
    pub fn reset(&self, encoder: &mut wgpu::CommandEncoder) {
        self.list.reset(encoder);
    }

    /// `pixels`: the textures of the pixels' own records. `None`: they are looked up.
    pub fn stages(
        &self,
        device: &Device,
        kernels: &Kernels,
        variant: TraceVariant,
        pixels: Option<&[wgpu::BindingResource<'_>; 3]>,
        shared: &Shared<'_>,
    ) -> Result<HalfStages> {
        let blocks = self.records.resources()?;
        let list = [self.list.resource()?];
        let [block_sky, block_meta, block_disk] = blocks.clone();
        // Media alone are written then; the others are there because the kernels bind them.
        let looked_up = || Ok::<_, Error>([block_sky, block_meta.clone(), self.media()?]);
        let of_pixels = pixels.cloned().map_or_else(looked_up, Ok)?;
        let [_, meta, disk] = of_pixels.clone();
        let fills = [shared.frame.clone(), shared.pass.clone(), meta, block_meta, block_disk, disk];
        let [trace_blocks, fill, listed] = keys(variant, pixels.is_some());
        Ok(HalfStages {
            blocks: kernels.get(trace_blocks)?.stage(device, &[&pixel_group(&blocks, shared)])?,
            fill: kernels.get(fill)?.stage(device, &[&fills, &list])?,
            listed: kernels.get(listed)?.stage(device, &[&pixel_group(&of_pixels, shared), &list])?,
            software: shared.software,
        })
    }
}

impl HalfStages {
    /// For a tile of so many pixels.
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, tile: [u32; 2]) {
        self.blocks.dispatch(pass, offset, tile.map(most_blocks));
        // Quads of pixels, of which the first and the last may lie half outside.
        self.fill.dispatch(pass, offset, tile.map(|pixels| pixels / 2 + 1));
        self.listed.run(pass, Some(offset), [list_groups(tile, self.software, Some(PIXELS_PER_GROUP)), 1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::half::blocks_of;

    #[test]
    fn there_is_room_for_all_blocks() {
        for (begin, pixels) in (-2..3).flat_map(|begin| (1..40).map(move |pixels| (begin, pixels))) {
            let (_, blocks) = blocks_of(begin, pixels);
            assert!(blocks <= most_blocks(pixels) && blocks + 1 >= most_blocks(pixels), "{begin} {pixels}");
        }
    }
}
