// SPDX-License-Identifier: MIT OR Apache-2.0
//! The barriers before and after a frame that take a target over and give it back. They stand in command buffers of
//! their own: wgpu refuses encoders that hold its commands and raw ones. Its trackers do not learn of them, so that
//! what [`give`] does to a layout, [`take`] undoes before the next frame.

use super::parts::VulkanParts;
use crate::gpu::device::external::TargetShape;
use crate::gpu::device::target::{GpuTarget, TargetRead, TargetResource};
use ash::vk;
use ash::vk::Handle;
use wgpu::hal::api::Vulkan;

/// How kernels, or copies, reach a target's image, as wgpu believes it to be between frames.
fn written(resource: &TargetResource) -> (vk::ImageLayout, vk::PipelineStageFlags, vk::AccessFlags) {
    match resource {
        TargetResource::Copied(_) => {
            (vk::ImageLayout::TRANSFER_DST_OPTIMAL, vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE)
        }
        TargetResource::Written(..) | TargetResource::Buffer(_) => {
            (vk::ImageLayout::GENERAL, vk::PipelineStageFlags::COMPUTE_SHADER, vk::AccessFlags::SHADER_WRITE)
        }
    }
}

fn colour() -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default().aspect_mask(vk::ImageAspectFlags::COLOR).level_count(1).layer_count(1)
}

/// Before a frame: makes the target bhr's. The pixels that were there are lost, the bytes between a buffer's rows not.
pub(in crate::gpu) fn take(parts: &VulkanParts, encoder: &mut wgpu::CommandEncoder, target: &GpuTarget) {
    let (layout, stage, access) = written(&target.resource);
    let any = vk::PipelineStageFlags::ALL_COMMANDS;
    let families =
        if target.leaves { [vk::QUEUE_FAMILY_EXTERNAL, parts.family] } else { [vk::QUEUE_FAMILY_IGNORED; 2] };
    record(encoder, |commands| match &target.resource {
        TargetResource::Buffer(_) => {
            let barrier = vk::BufferMemoryBarrier::default()
                .buffer(vk::Buffer::from_raw(target.raw))
                .size(vk::WHOLE_SIZE)
                .dst_access_mask(access)
                .src_queue_family_index(families[0])
                .dst_queue_family_index(families[1]);
            // SAFETY: the buffer lives as long as the target; the command buffer is being recorded.
            unsafe {
                parts.device.cmd_pipeline_barrier(commands, any, stage, Default::default(), &[], &[barrier], &[]);
            }
        }
        TargetResource::Written(..) | TargetResource::Copied(_) => {
            // Pixels that are discarded need no owner before.
            let barrier = vk::ImageMemoryBarrier::default()
                .image(vk::Image::from_raw(target.raw))
                .subresource_range(colour())
                .old_layout(vk::ImageLayout::UNDEFINED)
                .new_layout(layout)
                .dst_access_mask(access)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED);
            // SAFETY: as above, of the image.
            unsafe {
                parts.device.cmd_pipeline_barrier(commands, any, stage, Default::default(), &[], &[], &[barrier]);
            }
        }
    });
}

/// After a frame: gives the target to whoever waits for the frame's signals, images in their layout.
pub(in crate::gpu) fn give(parts: &VulkanParts, encoder: &mut wgpu::CommandEncoder, target: &GpuTarget) {
    let (layout, stage, access) = written(&target.resource);
    // On the host's own device nobody else makes the writes visible but this barrier or the semaphore.
    let then = vk::PipelineStageFlags::ALL_COMMANDS;
    let reads = if target.leaves {
        vk::AccessFlags::empty()
    } else {
        vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE
    };
    let families =
        if target.leaves { [parts.family, vk::QUEUE_FAMILY_EXTERNAL] } else { [vk::QUEUE_FAMILY_IGNORED; 2] };
    record(encoder, |commands| match &target.resource {
        TargetResource::Buffer(_) => {
            let barrier = vk::BufferMemoryBarrier::default()
                .buffer(vk::Buffer::from_raw(target.raw))
                .size(vk::WHOLE_SIZE)
                .src_access_mask(access)
                .dst_access_mask(reads)
                .src_queue_family_index(families[0])
                .dst_queue_family_index(families[1]);
            // SAFETY: the buffer lives as long as the target; the command buffer is being recorded.
            unsafe {
                parts.device.cmd_pipeline_barrier(commands, stage, then, Default::default(), &[], &[barrier], &[]);
            }
        }
        TargetResource::Written(..) | TargetResource::Copied(_) => {
            let barrier = vk::ImageMemoryBarrier::default()
                .image(vk::Image::from_raw(target.raw))
                .subresource_range(colour())
                .old_layout(layout)
                .new_layout(vk::ImageLayout::from_raw(target.shape.layout))
                .src_access_mask(access)
                .dst_access_mask(reads)
                .src_queue_family_index(families[0])
                .dst_queue_family_index(families[1]);
            // SAFETY: as above, of the image.
            unsafe {
                parts.device.cmd_pipeline_barrier(commands, stage, then, Default::default(), &[], &[], &[barrier]);
            }
        }
    });
}

/// Before a frame reads a target: makes a buffer bhr's until [`has_read`]. The pixels of an image, which the host has
/// left in its layout, are copied into a buffer of bhr's, and the image is given back as it was. A buffer's rows are
/// copied where there is a buffer for them; else kernels and copies of wgpu's, which knows the target's buffer, read
/// them.
pub(in crate::gpu) fn read(parts: &VulkanParts, encoder: &mut wgpu::CommandEncoder, read: &TargetRead) {
    let TargetRead { target, staged } = read;
    let (any, copies) = (vk::PipelineStageFlags::ALL_COMMANDS, vk::PipelineStageFlags::TRANSFER);
    let (ignored, own) = (vk::QUEUE_FAMILY_IGNORED, parts.family);
    let [theirs, ours] = if target.leaves { [vk::QUEUE_FAMILY_EXTERNAL, own] } else { [ignored; 2] };
    let device = &parts.device;
    let none = vk::DependencyFlags::empty();
    // The frame to come reads what was copied. The frame before may still read the buffer: the barriers that make the
    // target bhr's wait for it, as they wait for everything.
    let filled = |staged: &GpuTarget| {
        vk::BufferMemoryBarrier::default()
            .buffer(vk::Buffer::from_raw(staged.raw))
            .size(vk::WHOLE_SIZE)
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ)
            .src_queue_family_index(ignored)
            .dst_queue_family_index(ignored)
    };
    record(encoder, |commands| match (&target.resource, staged) {
        (TargetResource::Buffer(_), staged) => {
            let raw = vk::Buffer::from_raw(target.raw);
            let acquired = vk::BufferMemoryBarrier::default()
                .buffer(raw)
                .size(vk::WHOLE_SIZE)
                .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
                .dst_access_mask(vk::AccessFlags::MEMORY_READ)
                .src_queue_family_index(theirs)
                .dst_queue_family_index(ours);
            // SAFETY: the buffer lives as long as its target; the commands are being recorded; both buffers hold the
            // rows.
            unsafe {
                device.cmd_pipeline_barrier(commands, any, any, none, &[], &[acquired], &[]);
                if let Some(staged) = staged {
                    let buffer = vk::Buffer::from_raw(staged.raw);
                    device.cmd_copy_buffer(commands, raw, buffer, &row_copies(&target.shape, &staged.shape));
                    device.cmd_pipeline_barrier(commands, copies, any, none, &[], &[filled(staged)], &[]);
                }
            }
        }
        (_, None) => {}
        (TargetResource::Written(..) | TargetResource::Copied(_), Some(staged)) => {
            let pixel_bytes = target.shape.format.bytes_per_pixel() as u64;
            let [width, height] = target.shape.size;
            let buffer = vk::Buffer::from_raw(staged.raw);
            let raw = vk::Image::from_raw(target.raw);
            let left = vk::ImageLayout::from_raw(target.shape.layout);
            let source = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
            let barrier = vk::ImageMemoryBarrier::default().image(raw).subresource_range(colour());
            let acquired = barrier
                .old_layout(left)
                .new_layout(source)
                .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
                .dst_access_mask(vk::AccessFlags::TRANSFER_READ)
                .src_queue_family_index(theirs)
                .dst_queue_family_index(ours);
            let released =
                barrier.old_layout(source).new_layout(left).src_queue_family_index(ours).dst_queue_family_index(theirs);
            let layers = vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1);
            let copy = vk::BufferImageCopy::default()
                .buffer_row_length((staged.shape.row_stride / pixel_bytes) as u32)
                .image_subresource(layers)
                .image_extent(vk::Extent3D { width, height, depth: 1 });
            // SAFETY: as above, of the image; the buffer holds its rows.
            unsafe {
                device.cmd_pipeline_barrier(commands, any, copies, none, &[], &[], &[acquired]);
                device.cmd_copy_image_to_buffer(commands, raw, source, buffer, &[copy]);
                device.cmd_pipeline_barrier(commands, copies, any, none, &[], &[filled(staged)], &[released]);
            }
        }
    });
}

/// The rows of one buffer into another, which may have others between; as one piece where both have the same.
fn row_copies(from: &TargetShape, to: &TargetShape) -> Vec<vk::BufferCopy> {
    if from.row_stride == to.row_stride {
        return vec![vk::BufferCopy::default().size(from.bytes())];
    }
    let copy = |y: u64| vk::BufferCopy {
        src_offset: y * from.row_stride,
        dst_offset: y * to.row_stride,
        size: from.row_bytes(),
    };
    (0..from.size[1].into()).map(copy).collect()
}

/// After a frame has read a buffer: gives it back.
pub(in crate::gpu) fn has_read(parts: &VulkanParts, encoder: &mut wgpu::CommandEncoder, target: &GpuTarget) {
    let any = vk::PipelineStageFlags::ALL_COMMANDS;
    let families =
        if target.leaves { [parts.family, vk::QUEUE_FAMILY_EXTERNAL] } else { [vk::QUEUE_FAMILY_IGNORED; 2] };
    record(encoder, |commands| {
        let released = vk::BufferMemoryBarrier::default()
            .buffer(vk::Buffer::from_raw(target.raw))
            .size(vk::WHOLE_SIZE)
            .src_queue_family_index(families[0])
            .dst_queue_family_index(families[1]);
        // SAFETY: the buffer lives as long as its target; the commands are being recorded.
        unsafe {
            parts.device.cmd_pipeline_barrier(commands, any, any, Default::default(), &[], &[released], &[]);
        }
    });
}

fn record(encoder: &mut wgpu::CommandEncoder, work: impl FnOnce(vk::CommandBuffer)) {
    // SAFETY: the command buffer is used within the call only, and holds no commands of wgpu's.
    unsafe {
        encoder.as_hal_mut::<Vulkan, _, _>(|hal| {
            if let Some(hal) = hal {
                work(hal.raw_handle());
            }
        });
    }
}
