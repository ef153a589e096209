// SPDX-License-Identifier: MIT OR Apache-2.0
//! The setup of a frame, made before its tiles run: how its records are made, its light shaded and its pixels written.
//! Plain data; from_scene.rs fills it from a scene.

use super::target_rows::FrameRows;
use crate::emit::baking::BakeKey;
use crate::error::{Error, Result};
use crate::film::FilmParams;
use crate::film::bloom::Bloom;
use crate::film::metering::MeterParams;
use crate::gpu::device::target::{GpuTarget, TargetResource};
use crate::gpu::device::texture::Texture;
use crate::gpu::frame::uniforms::clouds::CloudsUniform;
use crate::gpu::frame::uniforms::frame::FrameUniform;
use crate::gpu::kernel::variant::{FilmVariant, ShadeVariant, StoredFormat};
use crate::gpu::lens::records::RecordSetup;

/// How a frame's shading is compiled.
pub(in crate::gpu) struct ShadingVariants {
    pub(in crate::gpu) shade: ShadeVariant,
    /// The film of the kernel that ends shading.
    pub(in crate::gpu) film: FilmVariant,
    /// The film of development, in frames with bloom.
    pub(in crate::gpu) developed: Option<FilmVariant>,
    pub(in crate::gpu) several_samples: bool,
    /// Whether the kernel that refines pixels runs after those that find them.
    pub(in crate::gpu) refines: bool,
    /// Whether pixels are written row by row, those for the host into its memory.
    pub(in crate::gpu) rows: bool,
}

/// Where a frame's pixels go.
#[derive(Clone, Copy)]
pub enum FrameTarget<'a> {
    /// There are none: of a frame of outputs without a picture.
    Nowhere,
    /// To the host, through staging buffers.
    Host,
    /// Into an image as large as the frame: a window's texture, or one that the host shares.
    Image(&'a wgpu::TextureView, StoredFormat),
    /// Into the rows of a buffer.
    Buffer(&'a wgpu::Buffer, FrameRows),
    /// Into a texture as large as the frame, by a copy of each tile.
    Copied(&'a wgpu::Texture),
}

impl<'a> FrameTarget<'a> {
    pub fn screen(texture: &'a Texture) -> Self {
        Self::Image(&texture.view, StoredFormat::Rgba8)
    }

    /// The place that the host shares. Errors: INTERNAL.
    pub fn shared(target: &'a GpuTarget) -> Result<Self> {
        let shape = &target.shape;
        Ok(match &target.resource {
            TargetResource::Buffer(buffer) => Self::Buffer(buffer, FrameRows::of(target, buffer)),
            TargetResource::Written(_, view) => {
                let format = StoredFormat::of(shape.format);
                Self::Image(view, format.ok_or_else(|| Error::internal("an image that kernels cannot write"))?)
            }
            TargetResource::Copied(texture) => Self::Copied(texture),
        })
    }
}

/// A frame's setup, made before its tiles run.
pub(in crate::gpu) struct Setup {
    pub(in crate::gpu) record_setup: RecordSetup,
    pub(in crate::gpu) variants: ShadingVariants,
    pub(in crate::gpu) samples: u32,
    pub(in crate::gpu) uniform: FrameUniform,
    /// `None`: no matter with depth has structure.
    pub(in crate::gpu) clouds: Option<CloudsUniform>,
    /// The key of the structure of each volume; `None` for even ones.
    pub(in crate::gpu) structure: Vec<Option<BakeKey>>,
    /// The entries of `light_tables` from `PLACES_OFFSET` on.
    pub(in crate::gpu) places: Vec<[f32; 4]>,
    pub(in crate::gpu) film: FilmParams,
    pub(in crate::gpu) bloom: Option<Bloom>,
    /// In frames with bloom: how they are metered, if they are.
    pub(in crate::gpu) meter: Option<MeterParams>,
}
