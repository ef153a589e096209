// SPDX-License-Identifier: MIT OR Apache-2.0
//! The distances of the host's things as a texture: made anew when the host gives others, and filled for each frame
//! from a target that the host shares. Knows no frames.

use super::binding_parts::{Band, Reach, Rows, bands};
use super::cached_uniform::CachedUniform;
use crate::allocate::with_room;
use crate::error::{Error, Result};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::external::{TargetOrigin, TargetShape};
use crate::gpu::device::target::{GpuTarget, TargetRead, TargetResource};
use crate::gpu::device::texture::Texture;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::KernelKind;
use crate::gpu::kernel::slots::OCCLUDER;
use crate::gpu::kernel::stage::Stage;
use crate::image::PixelFormat;
use crate::scene::{Distances, Scene};
use bytemuck::{Pod, Zeroable};
use std::num::NonZeroU64;
use std::ops::Range;
use std::sync::{Arc, Weak};

/// `OccluderRows` of emit/occluder_rows.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct OccluderRowsUniform {
    size: [u32; 2],
    row: u32,
    begin: u32,
    first_row: u32,
    unused: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(OccluderRowsUniform as "OccluderRows": size, row, begin, first_row, unused)
}

/// How a target's distances come into the texture.
pub struct Fetch {
    pub read: TargetRead,
    way: Way,
    texture: wgpu::Texture,
}

enum Way {
    /// By a copy from a buffer with so many bytes from row to row.
    Copy(wgpu::Buffer, u32),
    /// By a kernel, band by band: so many rows, and bytes from uniform to uniform.
    Kernel(Vec<(Stage, u32)>, u32),
}

impl Fetch {
    /// Fills the texture.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        match &self.way {
            Way::Copy(buffer, row) => {
                let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(*row), rows_per_image: None };
                let from = wgpu::TexelCopyBufferInfo { buffer, layout };
                encoder.copy_buffer_to_texture(from, self.texture.as_image_copy(), self.texture.size());
            }
            Way::Kernel(bands, stride) => {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                for ((stage, rows), slot) in bands.iter().zip(0..) {
                    stage.dispatch(&mut pass, slot * stride, [self.texture.width(), *rows]);
                }
            }
        }
    }
}

/// Bytes from row to row of a target's buffer, as a copy into a texture takes them; `None`: no copy takes such rows.
fn copied_row(shape: &TargetShape) -> Option<u32> {
    let row = u32::try_from(shape.row_stride).ok();
    row.filter(|row| row.is_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT))
}

/// The target that holds a scene's distances.
fn target_of(scene: &Scene) -> Option<Result<Arc<GpuTarget>>> {
    let Distances::OnDevice(given) = &scene.occluder.as_ref()?.distances else { return None };
    Some(given.0.clone().downcast::<GpuTarget>().map_err(|_| Error::internal("an occluder that is no target")))
}

/// Whether frames of the scene take their distances by a kernel.
pub fn takes_rows(scene: &Scene) -> bool {
    let rows = |target: &GpuTarget| !target.shape.image && copied_row(&target.shape).is_none();
    target_of(scene).is_some_and(|target| target.is_ok_and(|target| rows(&target)))
}

pub struct OccluderTexture {
    /// One texel until a scene has an occluder.
    texture: Texture,
    /// The distances that it holds.
    held: Option<Weak<Vec<f32>>>,
    /// Between an image of the host's and the texture.
    staged: Option<Arc<GpuTarget>>,
    /// The texture is one that kernels can write, with their uniforms.
    taken: Option<CachedUniform>,
}

impl OccluderTexture {
    pub fn new(device: &Device) -> Result<Self> {
        Ok(Self {
            texture: device.table("no occluder", OCCLUDER.format, [1, 1])?,
            held: None,
            staged: None,
            taken: None,
        })
    }

    /// Brings the texture up to the scene's occluder. Errors: UNSUPPORTED for one with a longer side than the device's
    /// textures have; as [`Device::scoped`].
    pub fn update(&mut self, device: &Device, scene: &Scene) -> Result<()> {
        let Some(occluder) = &scene.occluder else { return Ok(()) };
        // The weak pointer keeps the address from being given to others.
        if let Distances::Copied(distances) = &occluder.distances
            && self.held.as_ref().is_some_and(|held| std::ptr::eq(held.as_ptr(), Arc::as_ptr(distances)))
        {
            return Ok(());
        }
        let size = [occluder.width, occluder.height];
        check_sides(device, size)?;
        let taken = takes_rows(scene);
        if self.texture.size() != size || taken != self.taken.is_some() {
            self.taken = None;
            self.texture = match taken {
                true => device.texture("occluder", OCCLUDER.format, OCCLUDER.dimension, size, 1)?,
                false => device.table("occluder", OCCLUDER.format, size)?,
            };
        }
        self.held = None;
        match &occluder.distances {
            Distances::Copied(distances) => {
                self.staged = None;
                device.write_rows(&self.texture, 0, bytemuck::cast_slice(distances.as_slice()))?;
                self.held = Some(Arc::downgrade(distances));
            }
            Distances::OnDevice(_) => self.stage(device, scene, size)?,
        }
        Ok(())
    }

    /// Makes room for what an image holds, in rows that a copy into a texture takes; or writes the uniforms of a
    /// buffer's bands.
    fn stage(&mut self, device: &Device, scene: &Scene, size: [u32; 2]) -> Result<()> {
        let Some(target) = target_of(scene).transpose()? else { return Ok(()) };
        if !target.shape.image {
            self.staged = None;
            if takes_rows(scene) {
                self.write_bands(device, &target.shape)?;
            }
            return Ok(());
        }
        if self.staged.as_ref().is_some_and(|staged| staged.shape.size == size) {
            return Ok(());
        }
        self.staged = None;
        let row_stride = u64::from((4 * size[0]).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
        let shape = TargetShape { image: false, format: PixelFormat::R32F, size, row_stride, layout: 0, handle: 0 };
        self.staged = Some(Arc::new(device.target(shape, TargetOrigin::New)?));
        Ok(())
    }

    fn write_bands(&mut self, device: &Device, shape: &TargetShape) -> Result<()> {
        let [width, _] = shape.size;
        let stride = uniform_stride::<OccluderRowsUniform>(device) as usize;
        let bands = bands_of(device, shape)?;
        let mut bytes = with_room(stride * bands.len(), "the rows of an occluder")?;
        for Band { rows, from, .. } in &bands {
            let size = [width, rows.end - rows.start];
            let row = (shape.row_stride / 4) as u32;
            let uniform = OccluderRowsUniform { size, row, begin: from.begin(), first_row: rows.start, unused: 0 };
            let end = bytes.len() + stride;
            bytes.extend_from_slice(bytemuck::bytes_of(&uniform));
            bytes.resize(end, 0);
        }
        let size = bytes.len() as u64;
        let uniforms = match &mut self.taken {
            Some(uniforms) if uniforms.buffer().size() >= size => uniforms,
            taken => taken.insert(CachedUniform::new(device, "the rows of an occluder", size)?),
        };
        uniforms.write(device, &bytes)
    }

    /// The work that a frame of the scene begins with; `None`: the texture is as it must be. Errors: as
    /// [`Device::scoped`].
    pub fn fetch(&self, device: &Device, kernels: &Kernels, scene: &Scene) -> Result<Option<Fetch>> {
        let Some(target) = target_of(scene).transpose()? else { return Ok(None) };
        let missing = || Error::internal("an occluder without its buffer");
        let staged = self.staged.clone().filter(|_| target.shape.image);
        let from = staged.as_ref().unwrap_or(&target);
        let TargetResource::Buffer(buffer) = &from.resource else { return Err(missing()) };
        let way = match copied_row(&from.shape) {
            Some(row) => Way::Copy(buffer.clone(), row),
            None => {
                let kernel = kernels.get(KernelKind::OccluderRows)?;
                let uniforms = self.taken.as_ref().ok_or_else(missing)?.buffer();
                let size = NonZeroU64::new(size_of::<OccluderRowsUniform>() as u64);
                let stages = bands_of(device, &from.shape)?.into_iter().map(|band| {
                    let rows = wgpu::BufferBinding { buffer: uniforms, offset: 0, size };
                    let rows = wgpu::BindingResource::Buffer(rows);
                    let stage = kernel.stage(device, &[&[rows, band.from.binding(buffer), self.resource()]])?;
                    Ok((stage, band.rows.end - band.rows.start))
                });
                let stride = uniform_stride::<OccluderRowsUniform>(device) as u32;
                Way::Kernel(stages.collect::<Result<_>>()?, stride)
            }
        };
        Ok(Some(Fetch { way, texture: self.texture.clone_raw(), read: TargetRead { target, staged } }))
    }

    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.texture.view)
    }
}

/// Errors: UNSUPPORTED for a target that no frame could read as an occluder.
pub fn check_occluder(device: &Device, shape: &TargetShape) -> Result<()> {
    check_sides(device, shape.size)?;
    match shape.image || copied_row(shape).is_some() {
        true => Ok(()),
        false => bands_of(device, shape).map(drop),
    }
}

/// Errors: UNSUPPORTED for sides that no texture has.
fn check_sides(device: &Device, [width, height]: [u32; 2]) -> Result<()> {
    let limit = device.limits().max_texture_dimension_2d;
    if width > limit || height > limit {
        let message =
            format!("the occluder is {width} x {height}; textures of this device have {limit} at most a side");
        return Err(Error::unsupported(message));
    }
    Ok(())
}

/// The rows of a target's buffer as kernels bind them. Errors: UNSUPPORTED for rows that no binding holds.
fn bands_of(device: &Device, shape: &TargetShape) -> Result<Vec<Band>> {
    let rows = Rows { count: shape.size[1], stride: shape.row_stride, row: shape.row_bytes() };
    bands(&rows, &rows, Range::clone, &Reach::of(device)).ok_or_else(|| {
        let (row, largest) = (rows.row, Reach::of(device).largest);
        Error::unsupported(format!("a row of the occluder has {row} bytes; a kernel here reads {largest} at once"))
    })
}
