// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames and rays on the GPU, from a scene to pixels.

mod bands;
pub(in crate::gpu) mod begun;
pub(in crate::gpu) mod beside;
pub(in crate::gpu) mod bloom;
pub(in crate::gpu) mod buffers;
pub(in crate::gpu) mod clouds;
pub(in crate::gpu) mod configure;
pub(in crate::gpu) mod export;
mod filaments;
pub(in crate::gpu) mod kernels;
pub(in crate::gpu) mod matter;
pub(in crate::gpu) mod occluder;
pub(in crate::gpu) mod outputs;
pub(in crate::gpu) mod rays;
pub(in crate::gpu) mod refine;
pub(in crate::gpu) mod render;
pub(in crate::gpu) mod rows;
pub(in crate::gpu) mod settings;
pub(in crate::gpu) mod setup;
pub(in crate::gpu) mod sky_maps;
pub(in crate::gpu) mod sky_target;
pub(in crate::gpu) mod stages;
pub(in crate::gpu) mod steps;
mod streaks;
pub(in crate::gpu) mod submission;
pub(in crate::gpu) mod tables;
pub(in crate::gpu) mod tiles;
pub(in crate::gpu) mod tracer;
pub(in crate::gpu) mod uniforms;
