// SPDX-License-Identifier: MIT OR Apache-2.0
//! The buffers that frames of one size share: made, grown, and written with what all tiles share. Knows no kernels.

use super::bloom_textures::BloomBuffers;
use super::cached_uniform::CachedUniform;
use super::edge_list::EdgeList;
use super::meter_buffers::MeterBuffers;
use super::staging_layout::MOST_PASSES;
use crate::error::{Error, Result};
use crate::film::FilmParams;
use crate::gpu::device::buffer::{Buffer, uniform_stride};
use crate::gpu::device::readback::Readback;
use crate::gpu::device::texture::Texture;
use crate::gpu::device::timer::GpuTimer;
use crate::gpu::device::wgpu_device::Device;
use crate::gpu::frame::plan::setup::Setup;
use crate::gpu::frame::plan::tiles::MAX_BATCH;
use crate::gpu::frame::uniforms::clouds::CloudsUniform;
use crate::gpu::frame::uniforms::frame::{FrameUniform, PassUniform};
use crate::gpu::kernel::slots::{RADIANCE, TextureKind};
use crate::gpu::lens::records::{RecordStore, step_sum};
use wgpu::BufferUsages as Usage;

/// Buffers that frames of one size share; they grow and stay.
#[derive(Default)]
pub struct FrameBuffers {
    pub fixed: Option<FixedBuffers>,
    pub sized: Option<SizedBuffers>,
    pub bloom: BloomBuffers,
    pub meter: MeterBuffers,
    pub record_store: RecordStore,
    pub edges: EdgeList,
    pub readback: Readback,
    /// Where kernels write pixels row by row.
    pub mapped: MappedStaging,
    pub timer: Option<GpuTimer>,
}

/// The buffers that do not depend on a frame's size.
pub struct FixedBuffers {
    pub frame: CachedUniform,
    /// Written for scenes with structure in matter with depth only.
    pub clouds: CachedUniform,
    pub film: CachedUniform,
    /// Film settings for light that has already been exposed.
    pub film_of_exposed: CachedUniform,
    /// One `PassUniform` for what is developed in frames with bloom, one for each sample of a batch, and one for
    /// outputs; `uniform_stride` apart.
    pub passes: CachedUniform,
    pub step_sum: Buffer,
}

/// Staging buffers that kernels write.
pub struct MappedStaging(pub Readback);

impl Default for MappedStaging {
    fn default() -> Self {
        Self(Readback::of_kernels())
    }
}

/// The buffers and textures that depend on a frame's size.
pub struct SizedBuffers {
    size: Size,
    /// Samples are added by turns: from one to the other; as large as a tile only for several samples.
    pub radiance: [Texture; 2],
    pub packed: Buffer,
}

/// The frames that the sized buffers serve: largest tile, bytes of a packed pixel (0: none are packed there).
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Size {
    pub tile: [u32; 2],
    pub pixel_bytes: u64,
    pub several_samples: bool,
}

impl Size {
    /// Whether buffers of this size hold what the other asks for.
    pub fn serves(&self, other: &Self) -> bool {
        (0..2).all(|i| self.tile[i] >= other.tile[i])
            && self.pixel_bytes >= other.pixel_bytes
            && (self.several_samples || !other.several_samples)
    }
}

impl FixedBuffers {
    /// The `PassUniform` that a dispatch's offset chooses.
    pub fn pass(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.passes.buffer,
            offset: 0,
            size: std::num::NonZeroU64::new(size_of::<PassUniform>() as u64),
        })
    }
}

impl FrameBuffers {
    /// Makes room, and writes what all tiles share.
    pub fn prepare(&mut self, device: &Device, size: Size, setup: &Setup, software: bool) -> Result<()> {
        if !self.sized.as_ref().is_some_and(|s| s.size.serves(&size)) {
            // The old ones go first: both together need not fit.
            self.sized = None;
            let TextureKind { format, dimension } = RADIANCE;
            let summed = if size.several_samples { size.tile } else { [1, 1] };
            let radiance = || device.texture("radiance", format, dimension, summed, 1);
            // Rows begin where copies into textures may.
            let pitch = (u64::from(size.tile[0]) * size.pixel_bytes)
                .next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into());
            let bytes = (pitch * u64::from(size.tile[1])).max(4);
            self.sized = Some(SizedBuffers {
                size,
                radiance: [radiance()?, radiance()?],
                packed: device.buffer("packed pixels", bytes, Usage::STORAGE | Usage::COPY_SRC)?,
            });
        }
        self.record_store.prepare(device, &setup.record_setup, size.tile)?;
        self.edges.prepare(device, if setup.variants.shade.refines { size.tile } else { [1, 1] })?;
        self.write_fixed(device, setup, software)
    }

    /// Writes what all tiles share.
    pub fn write_fixed(&mut self, device: &Device, setup: &Setup, software: bool) -> Result<()> {
        if self.fixed.is_none() {
            self.fixed = Some(FixedBuffers {
                frame: CachedUniform::new(device, "frame", size_of::<FrameUniform>() as u64)?,
                clouds: CachedUniform::in_storage(device, "clouds", size_of::<CloudsUniform>() as u64)?,
                film: CachedUniform::new(device, "film", size_of::<FilmParams>() as u64)?,
                film_of_exposed: CachedUniform::new(device, "film of exposed light", size_of::<FilmParams>() as u64)?,
                passes: CachedUniform::new(
                    device,
                    "passes",
                    u64::from(2 + MAX_BATCH) * uniform_stride::<PassUniform>(device),
                )?,
                step_sum: step_sum(device)?,
            });
            // The clocks of software drivers tell nothing about their threads.
            self.timer = if software { None } else { GpuTimer::new(device, MOST_PASSES as u32)? };
        }
        let fixed = self.fixed.as_mut().ok_or_else(|| Error::internal("a frame without buffers"))?;
        fixed.frame.write(device, bytemuck::bytes_of(&setup.uniform))?;
        if let Some(clouds) = &setup.clouds {
            fixed.clouds.write(device, bytemuck::bytes_of(clouds))?;
        }
        fixed.film.write(device, bytemuck::bytes_of(&setup.film))?;
        fixed.film_of_exposed.write(device, bytemuck::bytes_of(&setup.film.of_exposed()))
    }

    /// After a submission that failed, nobody knows what the buffers hold.
    pub fn forget(&mut self) {
        self.record_store.forget();
        self.bloom.forget();
        self.meter.forget();
        if let Some(fixed) = &mut self.fixed {
            let FixedBuffers { frame, clouds, film, film_of_exposed, passes, .. } = fixed;
            for written in [frame, clouds, film, film_of_exposed, passes] {
                written.forget();
            }
        }
    }
}
