// SPDX-License-Identifier: MIT OR Apache-2.0
//! The buffers and textures of frames, which grow and stay from frame to frame, and what is written to them. Knows no
//! order of kernels.

pub(in crate::gpu) mod binding_parts;
pub(in crate::gpu) mod cached_uniform;
pub(in crate::gpu) mod edge_list;
pub(in crate::gpu) mod staging_layout;
pub(in crate::gpu) mod filaments;
pub(in crate::gpu) mod baked;
pub(in crate::gpu) mod ray_buffers;
pub(in crate::gpu) mod sky_texture;
pub(in crate::gpu) mod streaks;
pub(in crate::gpu) mod ghost_buffers;
pub(in crate::gpu) mod spike_buffers;
pub(in crate::gpu) mod bloom_textures;
pub(in crate::gpu) mod meter_buffers;
pub(in crate::gpu) mod occluder;
pub(in crate::gpu) mod sky_target;
pub(in crate::gpu) mod frame_buffers;
pub(in crate::gpu) mod sky_maps;
pub(in crate::gpu) mod output_buffers;
pub(in crate::gpu) mod lut_texture;
pub(in crate::gpu) mod tables;
