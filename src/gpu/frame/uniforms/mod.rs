// SPDX-License-Identifier: MIT OR Apache-2.0
//! The numbers of a scene in the layout of the shaders' structs. Knows no device.

pub(in crate::gpu) mod matter;
pub(in crate::gpu) mod outputs;
pub(in crate::gpu) mod rays;
pub(in crate::gpu) mod band;
pub(in crate::gpu) mod frame;
pub(in crate::gpu) mod clouds;
pub(in crate::gpu) mod bake;
