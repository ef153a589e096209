// SPDX-License-Identifier: MIT OR Apache-2.0
//! Frames and rays on the GPU, from a scene to pixels. Its folders, each above those before it: `uniforms` (numbers of
//! a scene in the layout of WGSL), `plan` (what a frame does, before anything of it is on the device), `resources`
//! (buffers and textures, which stay from frame to frame), `passes` (kernels with what they bind) and `submission`
//! (commands, sent and read). Above them the tracer, and what hosts ask it for: pictures, outputs, rays.

pub(in crate::gpu) mod uniforms;
pub(in crate::gpu) mod plan;
pub(in crate::gpu) mod resources;
pub(in crate::gpu) mod passes;
pub(in crate::gpu) mod tracer;
pub(in crate::gpu) mod anticipate;
pub(in crate::gpu) mod host_rays;
pub(in crate::gpu) mod ray_records;
pub(in crate::gpu) mod render_outputs;
pub(in crate::gpu) mod submission;
pub(in crate::gpu) mod render;
