// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where ray records come from on the GPU: traced pixel by pixel, or looked up in tables of a lens. Knows no light.

pub(in crate::gpu) mod kerr;
pub(in crate::gpu) mod pixel_list;
pub(in crate::gpu) mod schwarzschild;
pub(in crate::gpu) mod traced;
pub(in crate::gpu) mod half;
pub(in crate::gpu) mod records;
