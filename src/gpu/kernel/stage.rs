// SPDX-License-Identifier: MIT OR Apache-2.0
//! A kernel's pipeline, with and without what it binds, and the workgroups that it runs. Knows no keys.

use super::variant::GROUP;
use crate::error::{Error, Result};
use crate::gpu::device::wgpu_device::Device;

/// A pipeline and the layouts of its groups.
#[derive(Clone)]
pub struct Compiled {
    pub pipeline: wgpu::ComputePipeline,
    pub layouts: Vec<wgpu::BindGroupLayout>,
    /// Threads of a workgroup that goes over pixels.
    pub group: [u32; 2],
}

/// A pipeline with what it binds; its group 0 has one `UniformPart`.
pub struct Stage {
    pipeline: wgpu::ComputePipeline,
    groups: Vec<wgpu::BindGroup>,
    group: [u32; 2],
}

impl Compiled {
    /// The layout of group 2.
    pub fn target(&self) -> Result<&wgpu::BindGroupLayout> {
        self.layouts.get(2).ok_or_else(|| Error::internal("a kernel without a target"))
    }

    /// The pipeline with `groups`, the first of its groups: of each the resources in the order of its slots.
    pub fn stage(&self, device: &Device, groups: &[&[wgpu::BindingResource<'_>]]) -> Result<Stage> {
        let groups = groups.iter().zip(&self.layouts).map(|(resources, layout)| device.bind(layout, resources));
        let groups = groups.collect::<Result<Vec<_>>>()?;
        Ok(Stage { pipeline: self.pipeline.clone(), groups, group: self.group })
    }
}

impl Stage {
    /// Binds the stage and runs `groups` workgroups. `offset`: of the `UniformPart` of group 0; `None` if it has none.
    pub fn run(&self, pass: &mut wgpu::ComputePass<'_>, offset: Option<u32>, groups: [u32; 2]) {
        pass.set_pipeline(&self.pipeline);
        for (group, index) in self.groups.iter().zip(0..) {
            pass.set_bind_group(index, group, if index == 0 { offset.as_slice() } else { &[] });
        }
        pass.dispatch_workgroups(groups[0], groups[1], 1);
    }

    /// One thread for each pixel of a rectangle.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, offset: u32, size: [u32; 2]) {
        self.run(pass, Some(offset), groups_over(size, self.group));
    }
}

fn groups_over(size: [u32; 2], group: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|i| size[i].div_ceil(group[i]))
}

/// Workgroups over a rectangle of pixels.
pub fn pixel_groups(size: [u32; 2]) -> [u32; 2] {
    groups_over(size, GROUP)
}

/// Workgroups that share a list of a tile's pixels: enough for a large GPU's few thousand, and on a software driver,
/// where each costs its share of a loop's body however little there is to do, few.
const LIST_GROUPS: u32 = 2048;
const LIST_GROUPS_SOFTWARE: u32 = 16;

/// The workgroups that go over a list of pixels of a tile. `stepped`: where rays are integrated step by step, or matter
/// is summed along them, the pixels of the tile for each workgroup of a software driver.
///
/// Mesa's lavapipe leaves every loop of a thread once all of them together have run 65535 times
/// (LP_MAX_TGSI_LOOP_ITERATIONS); an integrated ray beside the shadow takes hundreds of iterations, and one through
/// matter thousands. With 16 workgroups the pixels at a list's end came out black.
pub fn list_groups(tile: [u32; 2], software: bool, stepped: Option<u32>) -> u32 {
    match (software, stepped) {
        (false, _) => LIST_GROUPS,
        (true, None) => LIST_GROUPS_SOFTWARE,
        (true, Some(pixels)) => (tile[0] * tile[1] / pixels).clamp(LIST_GROUPS_SOFTWARE, 1 << 15),
    }
}

/// Errors: INTERNAL if a count of workgroups exceeds what the device takes.
pub fn check_groups(device: &Device, groups: [u32; 2]) -> Result<()> {
    let limit = device.limits().max_compute_workgroups_per_dimension;
    if groups.iter().any(|&g| g > limit) {
        return Err(Error::internal(format!(
            "a dispatch of {groups:?} workgroups exceeds the device's limit of {limit}"
        )));
    }
    Ok(())
}
