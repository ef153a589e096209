// SPDX-License-Identifier: MIT OR Apache-2.0
//! The kernels of a frame with what they bind, and the order in which a tile goes through them. Knows no submissions.

pub(in crate::gpu) mod ghosts;
pub(in crate::gpu) mod spikes;
pub(in crate::gpu) mod bloom;
pub(in crate::gpu) mod metering;
pub(in crate::gpu) mod refine;
pub(in crate::gpu) mod picture;
pub(in crate::gpu) mod outputs_beside;
