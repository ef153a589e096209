//! A window's images, and what fills them. Knows no scene.

pub(in crate::gpu) mod present;
pub(in crate::gpu) mod swapchain;
