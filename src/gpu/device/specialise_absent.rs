// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `specialise` in pages, whose browsers compile WGSL, and have no naga in the module.

use crate::error::Result;

/// Shaders are the browser's.
#[derive(Default)]
pub(in crate::gpu) struct Shaders;

impl Shaders {
    /// A shader for wgpu, and the values of constants that are left to it: all.
    pub fn translated<'a>(
        &self,
        _label: &str,
        source: String,
        _entry_point: &str,
        constants: &'a [(&'a str, f64)],
    ) -> Result<(wgpu::ShaderSource<'static>, &'a [(&'a str, f64)])> {
        Ok((wgpu::ShaderSource::Wgsl(source.into()), constants))
    }
}
