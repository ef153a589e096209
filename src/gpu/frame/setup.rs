// SPDX-License-Identifier: MIT OR Apache-2.0
//! The setup of a frame, made before its tiles run: how its records are made, its light shaded and its pixels written.
//! Plain data; configure.rs fills it from a scene.

use super::clouds::CloudsUniform;
use super::uniforms::FrameUniform;
use crate::film::FilmParams;
use crate::film::bloom::Bloom;
use crate::gpu::device::texture::Texture;
use crate::gpu::kernel::variant::{FilmVariant, ShadeVariant};
use crate::gpu::lens::records::RecordSetup;

/// How a frame's shading is compiled.
pub(in crate::gpu) struct ShadingVariants {
    pub(in crate::gpu) shade: ShadeVariant,
    /// The film of the kernel that ends shading.
    pub(in crate::gpu) film: FilmVariant,
    /// The film of development, in frames with bloom.
    pub(in crate::gpu) developed: Option<FilmVariant>,
    pub(in crate::gpu) several_samples: bool,
    /// Whether pixels are written row by row into the host's memory.
    pub(in crate::gpu) rows: bool,
}

/// Where a frame's pixels go.
#[derive(Clone, Copy)]
pub enum FrameTarget<'a> {
    /// To the host, through staging buffers.
    Host,
    /// Into a texture as large as the frame: a window's.
    Screen(&'a Texture),
}

/// A frame's setup, made before its tiles run.
pub(in crate::gpu) struct Setup {
    pub(in crate::gpu) record_setup: RecordSetup,
    pub(in crate::gpu) variants: ShadingVariants,
    pub(in crate::gpu) samples: u32,
    pub(in crate::gpu) uniform: FrameUniform,
    /// `None`: no matter with depth has structure.
    pub(in crate::gpu) clouds: Option<CloudsUniform>,
    pub(in crate::gpu) film: FilmParams,
    pub(in crate::gpu) bloom: Option<Bloom>,
}
