// SPDX-License-Identifier: MIT OR Apache-2.0
//! A frame's way through the device: its steps as commands, sent and read. Knows no scene.

pub(in crate::gpu) mod delivery;
pub(in crate::gpu) mod handed;
pub(in crate::gpu) mod begun_frame;
pub(in crate::gpu) mod staged;
pub(in crate::gpu) mod step_uniforms;
pub(in crate::gpu) mod recorder;
pub(in crate::gpu) mod under_way;
pub(in crate::gpu) mod submit;
