// SPDX-License-Identifier: MIT OR Apache-2.0
//! The textures of traced records, and what the kernels bind that fill them. Knows no stages.

use crate::emit::volume::Volume;
use crate::error::{Error, Result};
use crate::gpu::device::buffer::Buffer;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::slots::{TRACED, TextureKind};

/// Records of traced pixels, of a tile and one pixel around it, or of blocks; they grow and stay.
#[derive(Default)]
pub struct TracedRecords {
    resources: Option<RecordTextures>,
}

struct RecordTextures {
    size: [u32; 2],
    layers: u32,
    textures: [Texture; 3],
}

/// The buffers that every kernel of a frame shares.
#[derive(Clone)]
pub struct Shared<'a> {
    pub frame: wgpu::BindingResource<'a>,
    /// The `PassUniform` that the dispatch's offset chooses.
    pub pass: wgpu::BindingResource<'a>,
    pub step_sum: wgpu::BindingResource<'a>,
    /// `light_tables` of shade/shade.wgsl.
    pub light_tables: wgpu::BindingResource<'a>,
    /// `structure_slots` of gpu/kernel/slots.rs.
    pub structure: [wgpu::BindingResource<'a>; 2 + Volume::MOST],
    /// `occluder` of emit/occluder.wgsl.
    pub occluder: wgpu::BindingResource<'a>,
    /// Whether the driver is software.
    pub software: bool,
}

impl TracedRecords {
    /// Makes room for rectangles of `size` with so many layers.
    pub fn prepare(&mut self, device: &Device, size: [u32; 2], layers: u32) -> Result<()> {
        let serves = |m: &RecordTextures| (0..2).all(|i| m.size[i] >= size[i]) && m.layers >= layers;
        if self.resources.as_ref().is_some_and(serves) {
            return Ok(());
        }
        // The old ones go first: both together need not fit.
        self.resources = None;
        let texture = |kind: TextureKind, label: &str, layers: u32| {
            device.texture(label, kind.format, kind.dimension, size, layers)
        };
        let [sky, meta, disk] = TRACED;
        let textures =
            [texture(sky, "record sky", 1)?, texture(meta, "record meta", 1)?, texture(disk, "record disk", layers)?];
        self.resources = Some(RecordTextures { size, layers, textures });
        Ok(())
    }

    pub fn resources(&self) -> Result<[wgpu::BindingResource<'_>; 3]> {
        let resources = self.resources.as_ref().ok_or_else(|| Error::internal("records without textures"))?;
        Ok(resources.textures.each_ref().map(|t| wgpu::BindingResource::TextureView(&t.view)))
    }

    /// Group 1 of a shading kernel.
    pub fn group(&self) -> Result<Vec<wgpu::BindingResource<'_>>> {
        Ok(self.resources()?.into())
    }
}

/// Group 0 of traced/pixels.wgsl, which leaves records in `textures`.
pub fn pixel_group<'a>(
    textures: &[wgpu::BindingResource<'a>; 3],
    shared: &Shared<'a>,
) -> Vec<wgpu::BindingResource<'a>> {
    let Shared { frame, pass, light_tables, structure, occluder, .. } = shared.clone();
    let [sky, meta, disk] = textures.clone();
    let first = [frame, pass, sky, meta, disk, light_tables];
    [&first[..], &structure[..3], &[occluder], &structure[3..]].concat()
}

/// `structure_slots` of gpu/kernel/slots.rs: the uniform of the clouds, and what `Tables::structure` has.
pub fn structure_group<'a>(
    clouds: &'a Buffer,
    textures: [wgpu::BindingResource<'a>; 1 + Volume::MOST],
) -> [wgpu::BindingResource<'a>; 2 + Volume::MOST] {
    let mut all = std::iter::once(clouds.as_entire_binding()).chain(textures);
    std::array::from_fn(|_| all.next().unwrap_or_else(|| clouds.as_entire_binding()))
}
