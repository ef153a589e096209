// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sky map, or cube, that lies in a target of the host's: read for each frame, and its pyramid made by kernels
//! (sky/pyramid.wgsl), level by level, in the place of the one that src/sky/map.rs makes; from a cube the finest level
//! is made by looking its light up. Knows no frames.

use super::buffers::CachedUniform;
use super::sky_maps::{MapTexture, level_place, texture_height};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::device::buffer::{Buffer, uniform_stride};
use crate::gpu::device::external::{TargetOrigin, TargetShape};
use crate::gpu::device::handover::TargetRead;
use crate::gpu::device::sharing::{GpuTarget, TargetResource};
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::{Kernels, Stage};
use crate::gpu::kernel::key::KernelKey;
use crate::gpu::kernel::slots::SKY_MAP;
use crate::gpu::kernel::variant::{SKY_SOURCE_FLOAT, SKY_SOURCE_HALF, SKY_SOURCE_LEVEL};
use crate::image::PixelFormat;
use crate::scene::SkyPicture;
use crate::sky::MAX_MAP_SIZE;
use bytemuck::{Pod, Zeroable};
use std::sync::{Arc, Weak};
use wgpu::BufferUsages as Usage;

/// `SkyLevel` of sky/pyramid.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct SkyLevelUniform {
    size: [u32; 2],
    source_size: [u32; 2],
    source_row: u32,
    row: u32,
    source: u32,
    cube: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(SkyLevelUniform as "SkyLevel": size, source_size, source_row, row, source, cube)
}

/// The textures and buffers of a map of one size.
pub struct SkyTarget {
    /// The target's columns and rows.
    size: [u32; 2],
    cube: bool,
    format: PixelFormat,
    for_sampler: bool,
    /// Level by level, the finest first.
    sizes: Vec<[u32; 2]>,
    staged: Arc<GpuTarget>,
    /// The texels of even levels and of odd ones, in rows that a copy into a texture takes.
    words: [Buffer; 2],
    uniforms: CachedUniform,
    pub(super) map: MapTexture,
}

/// The work that a frame begins with.
pub struct SkyFetch {
    pub read: TargetRead,
    /// From the target, from even levels, and from odd ones.
    stages: [Stage; 3],
    stride: u32,
    sizes: Vec<[u32; 2]>,
    for_sampler: bool,
    words: [wgpu::Buffer; 2],
    texture: wgpu::Texture,
}

/// Words from row to row of a level.
fn row_words(width: u32) -> u32 {
    width.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4)
}

/// Errors: INVALID_ARGUMENT for a map of a shape that it cannot have; UNSUPPORTED for one that the device's textures
/// or kernels do not hold.
pub fn check_sky(device: &Device, shape: &TargetShape, cube: bool) -> Result<()> {
    let [width, height] = shape.size;
    if !matches!(shape.format, PixelFormat::Rgba16F | PixelFormat::Rgba32F) {
        let format = shape.format;
        return Err(Error::argument(format!("target format is {format}; a sky map's is RGBA16F or RGBA32F")));
    }
    if cube && u64::from(width) != 6 * u64::from(height) {
        return Err(Error::argument(format!(
            "target is {width} x {height}; the six faces of a cube side by side are 6 times as wide as high"
        )));
    }
    let map = SkyPicture::map_size(shape.size, cube);
    let [most_width, most_height] = MAX_MAP_SIZE;
    if height > width || width > most_width || height > most_height {
        return Err(Error::argument(format!(
            "target is {width} x {height}; a sky map is as wide as high at least, and {most_width} x {most_height} at \
             most"
        )));
    }
    let limits = device.limits();
    let side = limits.max_texture_dimension_2d;
    if map[0] > side || texture_height(map) > side {
        return Err(Error::unsupported(format!(
            "target is {width} x {height}; a sky map takes a texture of {} x {}, and this device's limit is {side}",
            map[0],
            texture_height(map)
        )));
    }
    let (bytes, most) = (staged_stride(shape) * u64::from(height), limits.max_storage_buffer_binding_size);
    if bytes > most {
        return Err(Error::unsupported(format!(
            "target has {bytes} bytes; as a sky map a kernel reads {most} at most on this device"
        )));
    }
    Ok(())
}

fn staged_stride(shape: &TargetShape) -> u64 {
    let row = u64::from(shape.size[0]) * shape.format.bytes_per_pixel() as u64;
    row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into())
}

impl SkyTarget {
    /// Errors: as [`Device::scoped`].
    pub fn new(device: &Device, picture: &SkyPicture, for_sampler: bool) -> Result<Self> {
        let SkyPicture { size: given_size, cube, format, .. } = *picture;
        let size = SkyPicture::map_size(given_size, cube);
        let shape = TargetShape { image: false, format, size: given_size, row_stride: 0, layout: 0, handle: 0 };
        let shape = TargetShape { row_stride: staged_stride(&shape), ..shape };
        let mut sizes = vec![size];
        while let Some(last) = sizes.last().filter(|size| **size != [1, 1]) {
            sizes.push(last.map(|side| (side / 2).max(1)));
        }
        let texture = match for_sampler {
            true => device.table_of_levels("sky map of a target", SKY_MAP.format, size, sizes.len() as u32)?,
            false => device.table("sky map of a target", SKY_MAP.format, [size[0], texture_height(size)])?,
        };
        let words = |[width, height]: [u32; 2]| {
            let bytes = 4 * u64::from(row_words(width)) * u64::from(height);
            device.buffer("levels of a sky map", bytes, Usage::STORAGE | Usage::COPY_SRC)
        };
        let second = sizes.get(1).copied().unwrap_or([1, 1]);
        let stride = uniform_stride::<SkyLevelUniform>(device) as usize;
        let mut bytes = vec![0; stride * sizes.len()];
        let kind = if format == PixelFormat::Rgba16F { SKY_SOURCE_HALF } else { SKY_SOURCE_FLOAT };
        let given = (given_size, (shape.row_stride / 4) as u32, kind);
        let levels = sizes.iter().map(|size| (*size, row_words(size[0]), SKY_SOURCE_LEVEL));
        let sources = std::iter::once(given).chain(levels);
        for ((slot, size), (source_size, source_row, source)) in bytes.chunks_exact_mut(stride).zip(&sizes).zip(sources)
        {
            let row = row_words(size[0]);
            let cube = u32::from(cube && source != SKY_SOURCE_LEVEL);
            let uniform = SkyLevelUniform { size: *size, source_size, source_row, row, source, cube };
            slot[..size_of::<SkyLevelUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        let mut uniforms = CachedUniform::new(device, "levels of a sky map", bytes.len() as u64)?;
        uniforms.write(device, &bytes)?;
        Ok(Self {
            size: given_size,
            cube,
            format,
            for_sampler,
            words: [words(size)?, words(second)?],
            sizes,
            staged: Arc::new(device.target(shape, TargetOrigin::New)?),
            uniforms,
            map: MapTexture { texture, finest: size },
        })
    }

    /// Whether it holds such pictures.
    pub fn serves(&self, picture: &SkyPicture, for_sampler: bool) -> bool {
        let same = self.size == picture.size && self.cube == picture.cube && self.format == picture.format;
        same && self.for_sampler == for_sampler
    }

    /// Errors: SURFACE_LOST for a target that is gone.
    pub fn fetch(&self, device: &Device, kernels: &Kernels, picture: &SkyPicture) -> Result<SkyFetch> {
        let weak = picture.place.0.downcast_ref::<Weak<GpuTarget>>();
        let target = weak
            .ok_or_else(|| Error::internal("a sky that is no target"))?
            .upgrade()
            .filter(|target| !target.has_ended());
        let target = target.ok_or_else(|| {
            Error::new(ErrorKind::SurfaceLost, "the sky's target was lost: it was destroyed, or its context recovered")
        })?;
        let TargetResource::Buffer(staged) = &self.staged.resource else {
            return Err(Error::internal("a sky map without its buffer"));
        };
        let kernel = kernels.get(KernelKey::SkyLevel)?;
        let level = || {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: self.uniforms.buffer(),
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<SkyLevelUniform>() as u64),
            })
        };
        let [even, odd] = self.words.each_ref().map(|words| words.as_entire_binding());
        let stage = |from, to| kernel.stage(device, &[&[level(), from, to]]);
        Ok(SkyFetch {
            read: TargetRead { target, staged: self.staged.clone() },
            stages: [
                stage(staged.as_entire_binding(), even.clone())?,
                stage(even.clone(), odd.clone())?,
                stage(odd, even)?,
            ],
            stride: uniform_stride::<SkyLevelUniform>(device) as u32,
            sizes: self.sizes.clone(),
            for_sampler: self.for_sampler,
            words: self.words.each_ref().map(|words| (**words).clone()),
            texture: self.map.texture.clone_raw(),
        })
    }
}

impl SkyFetch {
    /// Makes the levels, one from the other.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let [given, from_even, from_odd] = &self.stages;
        for (size, number) in self.sizes.iter().zip(0_u32..) {
            let stage = match number {
                0 => given,
                number if number % 2 == 1 => from_even,
                _ => from_odd,
            };
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                stage.dispatch(&mut pass, number * self.stride, *size);
            }
            let [buffer, other] = &self.words;
            let buffer = if number % 2 == 0 { buffer } else { other };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * row_words(size[0])),
                rows_per_image: None,
            };
            let finest = self.sizes.first().copied().unwrap_or(*size);
            let [x, y] = if self.for_sampler { [0, 0] } else { level_place(finest, number) };
            let to = wgpu::TexelCopyTextureInfo {
                mip_level: if self.for_sampler { number } else { 0 },
                origin: wgpu::Origin3d { x, y, z: 0 },
                ..self.texture.as_image_copy()
            };
            let extent = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
            encoder.copy_buffer_to_texture(wgpu::TexelCopyBufferInfo { buffer, layout }, to, extent);
        }
    }
}
