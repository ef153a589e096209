// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sky map, or cube, that lies in a target of the host's: read for each frame, and its pyramid made by kernels
//! (sky/pyramid.wgsl), level by level, in the place of the one that src/sky/map.rs makes; from a cube the finest level
//! is made by looking its light up. Knows no frames.

use super::binding_parts::{Band, Reach, Rows, Window, bands};
use super::cached_uniform::CachedUniform;
use super::sky_texture::{MapTexture, level_place, texture_height};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::device::buffer::uniform_stride;
use crate::gpu::device::external::{HOST_POINTER, TargetOrigin, TargetShape};
use crate::gpu::device::target::{GpuTarget, TargetRead, TargetResource};
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::kernel::kernels::Kernels;
use crate::gpu::kernel::key::{KernelKey, KernelKind};
use crate::gpu::kernel::sizes::SKY_PARTS;
use crate::gpu::kernel::slots::SKY_MAP;
use crate::gpu::kernel::stage::Stage;
use crate::gpu::kernel::variant::{SKY_SOURCE_FLOAT, SKY_SOURCE_HALF, SKY_SOURCE_LEVEL};
use crate::image::PixelFormat;
use crate::scene::SkyPicture;
use crate::sky::MAX_MAP_SIZE;
use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use std::sync::{Arc, Weak};

/// `SkyLevel` of sky/level.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct SkyLevelUniform {
    size: [u32; 2],
    source_size: [u32; 2],
    source_row: u32,
    row: u32,
    source: u32,
    cube: u32,
    source_begin: u32,
    begin: u32,
    first_row: u32,
    part_rows: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(SkyLevelUniform as "SkyLevel": size, source_size, source_row, row, source,
        cube, source_begin, begin, first_row, part_rows)
}

/// How the levels of a map of one size are made from a picture that lies in one way.
struct Plan {
    /// Level by level, the finest first.
    sizes: Vec<[u32; 2]>,
    /// The dispatches of each level.
    bands: Vec<Vec<Band>>,
    /// A cube that no binding holds: rows of a part, and the parts.
    parts: Option<(u32, Vec<Window>)>,
}

/// The textures and buffers of a map of one size.
pub struct SkyTarget {
    /// The target's columns and rows.
    size: [u32; 2],
    cube: bool,
    format: PixelFormat,
    /// Bytes from row to row of the buffer that kernels read: the target's, or the one that it is copied into.
    stride: u64,
    for_sampler: bool,
    plan: Plan,
    staged: Option<Arc<GpuTarget>>,
    /// The texels of even levels and of odd ones, in rows that a copy into a texture takes.
    words: [Arc<GpuTarget>; 2],
    uniforms: CachedUniform,
    pub(in crate::gpu) map: MapTexture,
}

/// The dispatches that make a level.
struct LevelStages {
    size: [u32; 2],
    /// With the rows that each makes.
    stages: Vec<(Stage, u32)>,
}

/// The work that a frame begins with.
pub struct SkyFetch {
    pub read: TargetRead,
    /// The finest first.
    levels: Vec<LevelStages>,
    stride: u32,
    for_sampler: bool,
    words: [wgpu::Buffer; 2],
    texture: wgpu::Texture,
}

/// Words from row to row of a level.
fn row_words(width: u32) -> u32 {
    width.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4)
}

/// The rows of a level.
fn level_rows([width, height]: [u32; 2]) -> Rows {
    let stride = 4 * u64::from(row_words(width));
    Rows { count: height, stride, row: 4 * u64::from(width) }
}

/// A buffer that the device's limits for buffers, which are those of bindings here, do not bound.
fn large_buffer(device: &Device, format: PixelFormat, size: [u32; 2], row_stride: u64) -> Result<Arc<GpuTarget>> {
    let shape = TargetShape { image: false, format, size, row_stride, layout: 0, handle: 0 };
    device.target(shape, TargetOrigin::New).map(Arc::new)
}

fn buffer_of(target: &GpuTarget) -> Result<&wgpu::Buffer> {
    match &target.resource {
        TargetResource::Buffer(buffer) => Ok(buffer),
        _ => Err(Error::internal("a sky map without its buffer")),
    }
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
    Plan::new(map, &source_rows(shape), cube, &Reach::of(device), most_parts(device)).map(drop)
}

/// The parts in which a device's kernels bind a picture at most. The kernel for several declares all of them, and the
/// level that it writes.
fn most_parts(device: &Device) -> usize {
    let bound = device.limits().max_storage_buffers_per_shader_stage as usize;
    if bound > SKY_PARTS { SKY_PARTS } else { 1 }
}

/// Whether a target is copied into a buffer of bhr's: an image because kernels read rows, and the host's own memory
/// because they read most texels several times, which are to cross the bus once.
fn is_staged(shape: &TargetShape) -> bool {
    shape.image || shape.handle == HOST_POINTER
}

/// The rows that kernels read: those of a buffer itself, or those that the target is copied into.
fn source_rows(shape: &TargetShape) -> Rows {
    let row = shape.row_bytes();
    let stride = match (shape.image, is_staged(shape)) {
        (true, _) => row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into()),
        (false, true) => row,
        (false, false) => shape.row_stride,
    };
    Rows { count: shape.size[1], stride, row }
}

impl Plan {
    /// Errors: UNSUPPORTED for rows that kernels do not reach.
    fn new(map: [u32; 2], source: &Rows, cube: bool, reach: &Reach, most_parts: usize) -> Result<Self> {
        let mut sizes = vec![map];
        while let Some(last) = sizes.last().filter(|size| **size != [1, 1]) {
            sizes.push(last.map(|side| (side / 2).max(1)));
        }
        let too_large = || {
            let (stride, largest) = (source.stride, reach.largest);
            Error::unsupported(format!(
                "target has {} rows of {stride} bytes; as a sky map a kernel of this device reads {largest} bytes at \
                 once, of a cube {most_parts} times as many",
                source.count
            ))
        };
        let whole = 0..source.count;
        let parts = match cube && source.window(whole.clone(), reach).is_none() {
            true => Some(source.parts(most_parts, reach).ok_or_else(too_large)?),
            false => None,
        };
        // Texels of a cube's map lie in any row of its faces; of parts the first stands for all.
        let given = parts.as_ref().map_or(*source, |(rows, _)| Rows { count: *rows, ..*source });
        let mut bands_of = Vec::with_capacity(sizes.len());
        let mut from = given;
        for (size, number) in sizes.iter().zip(0..) {
            let to = level_rows(*size);
            let (read, made) = (u64::from(from.count), u64::from(to.count));
            let sources = |rows: &Range<u32>| match number == 0 && cube {
                true => 0..from.count,
                false => {
                    let end = (u64::from(rows.end) * read).div_ceil(made).min(read);
                    (u64::from(rows.start) * read / made) as u32..end as u32
                }
            };
            bands_of.push(bands(&from, &to, sources, reach).ok_or_else(too_large)?);
            from = to;
        }
        Ok(Self { sizes, bands: bands_of, parts })
    }
}

impl SkyTarget {
    /// Errors: SURFACE_LOST for a target that is gone; as [`Device::scoped`].
    pub fn new(device: &Device, picture: &SkyPicture, for_sampler: bool) -> Result<Self> {
        let SkyPicture { size: given_size, cube, format, .. } = *picture;
        let target = target_of(picture)?;
        let source = source_rows(&target.shape);
        let size = SkyPicture::map_size(given_size, cube);
        let plan = Plan::new(size, &source, cube, &Reach::of(device), most_parts(device))?;
        let texture = match for_sampler {
            true => device.table_of_levels("sky map of a target", SKY_MAP.format, size, plan.sizes.len() as u32)?,
            false => device.table("sky map of a target", SKY_MAP.format, [size[0], texture_height(size)])?,
        };
        let words = |size| large_buffer(device, PixelFormat::R32F, size, level_rows(size).stride);
        let second = plan.sizes.get(1).copied().unwrap_or([1, 1]);
        let kind = if format == PixelFormat::Rgba16F { SKY_SOURCE_HALF } else { SKY_SOURCE_FLOAT };
        let given = (given_size, (source.stride / 4) as u32, kind);
        let levels = plan.sizes.iter().map(|size| (*size, row_words(size[0]), SKY_SOURCE_LEVEL));
        let sources = std::iter::once(given).chain(levels);
        let stride = uniform_stride::<SkyLevelUniform>(device) as usize;
        let mut bytes = Vec::new();
        for ((size, (source_size, source_row, source)), bands) in plan.sizes.iter().zip(sources).zip(&plan.bands) {
            for band in bands {
                let uniform = SkyLevelUniform {
                    size: *size,
                    source_size,
                    source_row,
                    row: row_words(size[0]),
                    source,
                    cube: u32::from(cube && source != SKY_SOURCE_LEVEL),
                    source_begin: band.from.begin(),
                    begin: band.to.begin(),
                    first_row: band.rows.start,
                    part_rows: plan.parts.as_ref().map_or(1, |(rows, _)| *rows),
                };
                let begin = bytes.len();
                bytes.resize(begin + stride, 0);
                bytes[begin..begin + size_of::<SkyLevelUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
            }
        }
        let mut uniforms = CachedUniform::new(device, "levels of a sky map", bytes.len() as u64)?;
        uniforms.write(device, &bytes)?;
        let staged = is_staged(&target.shape).then(|| large_buffer(device, format, given_size, source.stride));
        let staged = staged.transpose()?;
        Ok(Self {
            size: given_size,
            cube,
            format,
            stride: source.stride,
            for_sampler,
            words: [words(size)?, words(second)?],
            plan,
            staged,
            uniforms,
            map: MapTexture { texture, finest: size },
        })
    }

    /// Whether it holds such pictures.
    pub fn serves(&self, picture: &SkyPicture, for_sampler: bool) -> bool {
        let same = self.size == picture.size && self.cube == picture.cube && self.format == picture.format;
        // A target that is gone is for `fetch` to tell.
        let lies = target_of(picture).map_or(true, |target| {
            source_rows(&target.shape).stride == self.stride && is_staged(&target.shape) == self.staged.is_some()
        });
        same && lies && self.for_sampler == for_sampler
    }

    /// Errors: SURFACE_LOST for a target that is gone.
    pub fn fetch(&self, device: &Device, kernels: &Kernels, picture: &SkyPicture) -> Result<SkyFetch> {
        let target = target_of(picture)?;
        let first = kernels.get(KernelKind::SkyLevel(self.plan.parts.is_some()))?;
        let others = kernels.get(KernelKind::SkyLevel(false))?;
        let level = || {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: self.uniforms.buffer(),
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<SkyLevelUniform>() as u64),
            })
        };
        let given = buffer_of(self.staged.as_ref().unwrap_or(&target))?;
        let [even, odd] = [buffer_of(&self.words[0])?, buffer_of(&self.words[1])?];
        let reach = Reach::of(device);
        // Levels that bind the same share the group.
        let bound = |window: &Window, buffer: &'_ wgpu::Buffer| window.widest(buffer.size(), &reach);
        let stage = |number: usize, band: &Band| {
            let to = if number.is_multiple_of(2) { even } else { odd };
            let to = bound(&band.to, to).binding(to);
            match (number, &self.plan.parts) {
                (0, Some((_, parts))) => {
                    // The kernel has bindings for more parts than there are.
                    let part = |i: usize| parts.get(i).or(parts.first()).map(|part| part.binding(given));
                    let part = |i: usize| part(i).ok_or_else(|| Error::internal("a picture without parts"));
                    let mut bound = vec![level(), part(0)?, to];
                    for i in 1..SKY_PARTS {
                        bound.push(part(i)?);
                    }
                    first.stage(device, &[&bound])
                }
                (0, None) => first.stage(device, &[&[level(), bound(&band.from, given).binding(given), to]]),
                (number, _) => {
                    let from = if number.is_multiple_of(2) { odd } else { even };
                    others.stage(device, &[&[level(), bound(&band.from, from).binding(from), to]])
                }
            }
        };
        let mut levels = Vec::with_capacity(self.plan.sizes.len());
        for (number, (size, bands)) in self.plan.sizes.iter().zip(&self.plan.bands).enumerate() {
            let stages = bands.iter().map(|band| Ok((stage(number, band)?, band.rows.end - band.rows.start)));
            levels.push(LevelStages { size: *size, stages: stages.collect::<Result<_>>()? });
        }
        Ok(SkyFetch {
            levels,
            stride: uniform_stride::<SkyLevelUniform>(device) as u32,
            for_sampler: self.for_sampler,
            words: [even.clone(), odd.clone()],
            texture: self.map.texture.clone_raw(),
            read: TargetRead { target, staged: self.staged.clone() },
        })
    }
}

/// The kernels that make the levels of a picture.
pub fn level_kernels(device: &Device, picture: &SkyPicture) -> ArrayVec<KernelKey, 2> {
    let reach = Reach::of(device);
    let source = target_of(picture).map(|target| source_rows(&target.shape));
    let in_parts = picture.cube && source.is_ok_and(|source| source.window(0..source.count, &reach).is_none());
    let kinds = [KernelKind::SkyLevel(false), KernelKind::SkyLevel(true)];
    kinds.into_iter().take(1 + usize::from(in_parts)).map(KernelKey::from).collect()
}

/// The target of a picture. Errors: SURFACE_LOST for one that is gone.
fn target_of(picture: &SkyPicture) -> Result<Arc<GpuTarget>> {
    let weak = picture.place.0.downcast_ref::<Weak<GpuTarget>>();
    let target =
        weak.ok_or_else(|| Error::internal("a sky that is no target"))?.upgrade().filter(|target| !target.has_ended());
    target.ok_or_else(|| {
        Error::new(ErrorKind::SurfaceLost, "the sky's target was lost: it was destroyed, or its context recovered")
    })
}

impl SkyFetch {
    /// Makes the levels, one from the other.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let finest = self.levels.first().map_or([1, 1], |level| level.size);
        let mut slot = 0;
        for (LevelStages { size, stages }, number) in self.levels.iter().zip(0_u32..) {
            for (stage, rows) in stages {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                stage.dispatch(&mut pass, slot * self.stride, [size[0], *rows]);
                slot += 1;
            }
            let [buffer, other] = &self.words;
            let buffer = if number % 2 == 0 { buffer } else { other };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * row_words(size[0])),
                rows_per_image: None,
            };
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
