// SPDX-License-Identifier: MIT OR Apache-2.0
//! A window's images, and what fills them. Knows no scene.

pub(in crate::gpu) mod present;
pub(in crate::gpu) mod swapchain;
