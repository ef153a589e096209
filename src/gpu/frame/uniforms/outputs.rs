// SPDX-License-Identifier: MIT OR Apache-2.0
//! Outputs in the layout of the shaders' uniform: `Outputs` of shade/outputs.wgsl, field by field.

use crate::scene::output::MOST_OUTPUTS;
use crate::scene::{RayOutput, Scene};
use crate::tracer::Tile;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec4};

/// `Outputs` of shade/outputs.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct OutputsUniform {
    scene_x: Vec4,
    scene_y: Vec4,
    scene_z: Vec4,
    wanted: [[u32; 4]; MOST_OUTPUTS],
    /// They change from tile to tile.
    pub places: [[u32; 4]; MOST_OUTPUTS],
    count: u32,
    asks_sky: u32,
    crossings: u32,
    padding: u32,
}

#[cfg(test)]
pub(in crate::gpu) fn layout() -> crate::gpu::kernel::layout::Layout {
    crate::gpu::kernel::layout::layout!(OutputsUniform as "Outputs": scene_x, scene_y, scene_z, wanted, places,
        count, asks_sky, crossings, padding)
}

impl OutputsUniform {
    pub fn new(scene: &Scene, outputs: &[RayOutput]) -> Self {
        use crate::scene::RayOutputKind::{Deflection, Sky};
        let asked = outputs.iter().map(|output| output.crossings()).max().unwrap_or(0);
        let axes = scene.hole.scene_to_chart().transpose();
        let column = |v: DVec3, w: f64| v.as_vec3().extend(w as f32);
        let mut wanted = [[0; 4]; MOST_OUTPUTS];
        for (to, output) in wanted.iter_mut().zip(outputs) {
            *to = [output.kind as u32, output.index, output.words() as u32, 0];
        }
        Self {
            scene_x: column(axes.x_axis, scene.hole.mass),
            scene_y: column(axes.y_axis, 0.0),
            scene_z: column(axes.z_axis, 0.0),
            wanted,
            places: [[0; 4]; MOST_OUTPUTS],
            count: outputs.len().min(MOST_OUTPUTS) as u32,
            asks_sky: u32::from(outputs.iter().any(|output| matches!(output.kind, Sky | Deflection))),
            crossings: asked.min(scene.quality.max_disk_order + 1),
            padding: 0,
        }
    }

    /// The places of a tile's numbers in one buffer: all of the first output, then all of the second.
    pub fn packed(mut self, tile: Tile) -> Self {
        let mut first = 0;
        for (place, [_, _, words, _]) in self.places.iter_mut().zip(self.wanted) {
            *place = [first, words * tile.width, 0, 0];
            first += words * tile.width * tile.height;
        }
        self
    }
}
