// SPDX-License-Identifier: MIT OR Apache-2.0
//! A level of the structure of matter with depth, as the kernel that makes it knows it: `BakeLevel` of emit/bake.wgsl.

use crate::emit::baking::BakeLevel;
use crate::emit::filaments::{FILAMENT_LEVELS, level_variances};
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct BakeUniform {
    columns: u32,
    rows: u32,
    layers: u32,
    level: f32,
    first_row: u32,
    first_motion: u32,
    heights: u32,
    begin: u32,
    row_words: u32,
    row_texels: f32,
    row_size: f32,
    layer_size: f32,
    variances: [Vec4; FILAMENT_LEVELS],
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(BakeUniform as "BakeLevel": columns, rows, layers, level, first_row,
        first_motion, heights, begin, row_words, row_texels, row_size, layer_size, variances)
}

impl BakeUniform {
    /// `begin`: the first word of the level; `row_words`: words from row to row.
    pub fn new(level: &BakeLevel, begin: u32, row_words: u32) -> Self {
        let [columns, rows, layers] = level.sides.map(|side| side as u32);
        Self {
            columns,
            rows,
            layers,
            level: level.level as f32,
            first_row: level.first_row as u32,
            first_motion: level.first_motion as u32,
            heights: level.heights as u32,
            begin,
            row_words,
            row_texels: level.row_texels,
            row_size: level.row_size,
            layer_size: level.layer_size,
            variances: level_variances().map(|[fine, coarse]| Vec4::new(fine as f32, coarse as f32, 0.0, 0.0)),
        }
    }
}
