// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a frame does, decided before anything of it is on the device: how records are made and light shaded, which
//! kernels run, in which tiles and steps, and where pixels go. Knows no buffers and no commands.

pub(in crate::gpu) mod f32_settings;
pub(in crate::gpu) mod target_rows;
pub(in crate::gpu) mod tiles;
pub(in crate::gpu) mod setup;
pub(in crate::gpu) mod steps;
pub(in crate::gpu) mod from_scene;
pub(in crate::gpu) mod kernel_list;
